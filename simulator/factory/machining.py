"""Machining of parts: time, energy and settings of one part after another.

Times of a program with fixed settings are exact, and so are energies without deviation; the
deviation is drawn for each movement of each part.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from simulator.factory.cycle import PartCycle, drawn_energies
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MachiningPlan:
    """Cycles of all programs of a shop; steps without a program have times in the shop."""

    cycles: Mapping[Place, ProgramCycle] = field(default_factory=dict)

    def parts(self, shop: Shop, place: Place, streams: Streams) -> Iterator[Machining]:
        """Machining of one part after another, without end."""
        product, step, machine = place
        spec = shop.machines[machine]
        load = shop.products[product].steps[step].load
        purpose = f"machining {shop.products[product].name} {step}"
        if load is not None:
            return _timed(load, streams, spec.name, purpose)
        found = self.cycles[place]
        deviation = None if spec.machine is None else spec.machine.deviation
        if deviation is None:
            return _repeated(found)
        return _deviating(found, deviation, streams, spec.name, purpose)


def _timed(load: StateLoad, streams: Streams, owner: str, purpose: str) -> Iterator[Machining]:
    """Machining of which only time and power are known."""
    for time in streams.numbers(load.time, owner, purpose):
        yield Machining(time, load.power * time, load.power)


def _repeated(found: ProgramCycle) -> Iterator[Machining]:
    cycle = found.cycle
    machining = Machining(cycle.time, cycle.energy, cycle.peak_power, found.settings)
    while True:
        yield machining


def _deviating(
    found: ProgramCycle,
    deviation: PowerDeviation,
    streams: Streams,
    owner: str,
    purpose: str,
) -> Iterator[Machining]:
    """Parts whose movements deviate in power."""
    cycle, generator = found.cycle, streams.generator(owner, purpose)
    while True:
        for energy in drawn_energies(cycle, deviation, generator, BLOCK).tolist():
            yield Machining(cycle.time, energy, cycle.peak_power, found.settings)
