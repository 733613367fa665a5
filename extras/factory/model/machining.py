"""Machining of parts: time, energy and settings of one part after another.

Times of a program with fixed settings are those of the virtual machine; those of settings that
are drawn for each part are interpolated between its runs. A deviation of powers is drawn for
each movement of each part.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isnan
from typing import NamedTuple, TypeAlias

import numpy as np

from extras.factory.model.cycle import PartCycle, drawn_energies
from extras.factory.model.distribution import Floats
from extras.factory.model.interpolation import CycleTable
from extras.factory.model.shop import Shop
from extras.factory.model.streams import Streams
from simulator.spec import PowerDeviation
from stepnc_model.editing.cut_settings import CutSettings

AS_PROGRAMMED = CutSettings()

BLOCK = 64
"""Parts whose settings and deviations are drawn at a time; a seed gives others with another."""


class Machining(NamedTuple):
    """Machining of one part."""

    time: float
    """s"""
    energy: float
    """J"""
    peak_power: float
    """W"""
    settings: CutSettings = AS_PROGRAMMED

    @property
    def power(self) -> float:
        """Mean power, W."""
        return self.energy / self.time if self.time > 0.0 else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartSource:
    """Machining of one part after another, without end."""

    blocks: Iterator[Floats]
    """Time in s, energy in J and peak power in W of parts, (3, N); where settings are drawn,
    then feed in mm/s, spindle speed in rev/s and depth in mm of each, NaN: as programmed."""
    settings: CutSettings | None = AS_PROGRAMMED
    """Settings of all parts; None: they are drawn for each."""
    is_random: bool = False
    """Whether times are drawn."""

    def parts(self) -> Iterator[Machining]:
        """Machining of one part after another."""
        for block in self.blocks:
            yield from self.machined(block)

    def machined(self, block: Floats) -> Iterator[Machining]:
        """Machining of the parts of a block."""
        if self.settings is not None:
            settings, new = self.settings, tuple.__new__
            for time, energy, peak in block.T.tolist():
                # Half the time of the constructor of a named tuple.
                yield new(Machining, (time, energy, peak, settings))
            return
        for time, energy, peak, *drawn in block.T.tolist():
            feed, speed, depth = (None if isnan(each) else each for each in drawn)
            chosen = CutSettings(feed=feed, spindle_speed=speed, depth=depth)
            yield Machining(time, energy, peak, chosen)


Place: TypeAlias = tuple[int, int, int]
"""Indices of product, step and machine."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgramCycle:
    """Cycle of a program on a machine, with the settings as programmed."""

    cycle: PartCycle
    settings: CutSettings
    """Settings that all its cuts share; None where they differ."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MachiningPlan:
    """Cycles of all programs of a shop; steps without a program have times in the shop."""

    cycles: Mapping[Place, ProgramCycle] = field(default_factory=dict)
    tables: Mapping[Place, CycleTable] = field(default_factory=dict)
    """Cycles of programs whose settings are drawn for each part."""
    materials: Mapping[int, str] = field(default_factory=dict)
    """Work material of each product, by its index."""

    def parts(self, shop: Shop, place: Place, streams: Streams) -> PartSource:
        """Machining of one part after another, without end."""
        product, step, machine = place
        spec = shop.machines[machine]
        load = shop.products[product].steps[step].load
        purpose = purpose_of(shop, place)
        if load is not None:
            times = streams.blocks(load.time, spec.name, purpose)
            return PartSource(blocks=_timed(load.power, times), is_random=load.time.is_random)
        deviation = None if spec.machine is None else spec.machine.deviation
        draw = streams.generator(spec.name, purpose)
        if place in self.tables:
            blocks = _drawn(self.tables[place], deviation, draw)
            return PartSource(blocks=blocks, settings=None, is_random=True)
        found = self.cycles[place]
        return PartSource(
            blocks=_repeated(found.cycle, deviation, draw), settings=found.settings
        )


def purpose_of(shop: Shop, place: Place) -> str:
    """Purpose of the random numbers of the machining of a step."""
    product, step, _ = place
    return f"machining {shop.products[product].name} {step}"


def _timed(power: float, times: Iterator[Floats]) -> Iterator[Floats]:
    """Machining of which only time and power are known."""
    for time in times:
        yield np.array((time, power * time, np.full(len(time), power)))


def _repeated(
    cycle: PartCycle, deviation: PowerDeviation | None, draw: np.random.Generator
) -> Iterator[Floats]:
    """Parts with the settings as programmed, whose movements may deviate in power."""
    while True:
        block = np.empty((3, BLOCK))
        block[:] = np.array(((cycle.time,), (cycle.energy,), (cycle.peak_power,)))
        if deviation is not None:
            block[1] = drawn_energies(cycle, deviation, draw, BLOCK)
        yield block


def _drawn(
    table: CycleTable, deviation: PowerDeviation | None, draw: np.random.Generator
) -> Iterator[Floats]:
    """Parts whose settings are drawn uniformly from the ranges of a design."""
    design = table.design
    ranges = (design.feed, design.spindle_speed, design.depth)
    sense = -1.0 if design.is_clockwise else 1.0
    while True:
        feed, speed, depth = (
            np.full(BLOCK, np.nan) if each is None else draw.uniform(each.low, each.high, BLOCK)
            for each in ranges
        )
        found = table.values(feed, speed, depth)
        energy = found.energy
        if deviation is not None:
            energy = table.drawn_energies(feed, speed, depth, deviation=deviation, rng=draw)
        yield np.array((found.time, energy, found.peak_power, feed, sense * speed, depth))
