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

from simulator.factory.cycle import PartCycle, drawn_energies
from simulator.factory.interpolated import CycleTable
from simulator.factory.shop import Shop, StateLoad
from simulator.factory.streams import BLOCK, Streams
from simulator.spec import PowerDeviation
from stepnc_model.cut_settings import CutSettings

AS_PROGRAMMED = CutSettings()


class Machining(NamedTuple):
    """Machining of one part."""

    time: float
    """s"""
    energy: float
    """J"""
    peak_power: float
    """W"""
    settings: CutSettings = AS_PROGRAMMED


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

    def parts(self, shop: Shop, place: Place, streams: Streams) -> Iterator[Machining]:
        """Machining of one part after another, without end."""
        product, step, machine = place
        spec = shop.machines[machine]
        load = shop.products[product].steps[step].load
        purpose = purpose_of(shop, place)
        if load is not None:
            return _timed(load, streams, spec.name, purpose)
        deviation = None if spec.machine is None else spec.machine.deviation
        draw = streams.generator(spec.name, purpose)
        if place in self.tables:
            return _drawn(self.tables[place], deviation, draw)
        found = self.cycles[place]
        return _repeated(found) if deviation is None else _deviating(found, deviation, draw)


def purpose_of(shop: Shop, place: Place) -> str:
    """Purpose of the random numbers of the machining of a step."""
    product, step, _ = place
    return f"machining {shop.products[product].name} {step}"


def _timed(load: StateLoad, streams: Streams, owner: str, purpose: str) -> Iterator[Machining]:
    """Machining of which only time and power are known."""
    power, new = load.power, tuple.__new__
    for time in streams.numbers(load.time, owner, purpose):
        # Half the time of the constructor of a named tuple.
        yield new(Machining, (time, power * time, power, AS_PROGRAMMED))


def _repeated(found: ProgramCycle) -> Iterator[Machining]:
    cycle = found.cycle
    machining = Machining(cycle.time, cycle.energy, cycle.peak_power, found.settings)
    while True:
        yield machining


def _deviating(
    found: ProgramCycle, deviation: PowerDeviation, draw: np.random.Generator
) -> Iterator[Machining]:
    """Parts whose movements deviate in power."""
    cycle = found.cycle
    while True:
        for energy in drawn_energies(cycle, deviation, draw, BLOCK).tolist():
            yield Machining(cycle.time, energy, cycle.peak_power, found.settings)


def _drawn(
    table: CycleTable, deviation: PowerDeviation | None, draw: np.random.Generator
) -> Iterator[Machining]:
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
        rows = zip(
            *(each.tolist() for each in (found.time, energy, found.peak_power)),
            *(each.tolist() for each in (feed, sense * speed, depth)),
            strict=True,
        )
        for time, joules, peak, *settings in rows:
            one, two, three = (None if isnan(each) else each for each in settings)
            chosen = CutSettings(feed=one, spindle_speed=two, depth=three)
            yield Machining(time, joules, peak, chosen)
