"""Figures of a running shop, gathered from its warm-up on. Running state.

Memory does not grow with parts. Times are those of ISO 22400-2, [1]_ of
:mod:`simulator.factory.measures`: *planned busy time* is all but off shift, *actual production
time* is part set-up, machining and part ejection, and the *planned run time* of a part is its
machining. So OEE is the machining time of good parts over the planned busy time.
"""

from collections import Counter
from dataclasses import dataclass, field
from math import nan

import numpy as np

from simulator.factory.floor import Floor
from simulator.factory.measures import Level, Measure, Quantity
from simulator.factory.power_series import PowerSeries
from simulator.factory.records import Listeners, PartMade, StateSpent
from simulator.factory.shop import Shop
from simulator.factory.states import MachineState
from simulator.factory.store import Batch
from stepnc_model.units import hours_from_seconds, kw_from_watts, kwh_from_joules

_S = MachineState

PRODUCTION = (_S.PART_SETUP, _S.MACHINING, _S.PART_EJECTION)
DOWN = (_S.FAILED, _S.REPAIR, _S.MAINTENANCE)


WAITING = 20_000
"""States that are counted together."""

CODE = {state: row for row, state in enumerate(MachineState)}
"""Numbers of the states."""

STATES = tuple(MachineState)


@dataclass(slots=True, eq=False)
class MachineTally:
    """Times and energies of one machine."""

    seconds: Counter[MachineState] = field(default_factory=Counter)
    joules: Counter[MachineState] = field(default_factory=Counter)
    peak: float = 0.0
    """Greatest mean power of a state, W."""


@dataclass(slots=True, eq=False)
class ProcessTally:
    """Counts of the machining of one step on one machine."""

    parts: int = 0
    good: int = 0
    time: float = 0.0
    """s"""
    energy: float = 0.0
    """J"""
    peak: float = 0.0
    """W"""


@dataclass(slots=True, eq=False)
class ProductTally:
    """Counts of one product."""

    good: int = 0
    lead: float = 0.0
    """Lead times of batches times their good parts, s."""


@dataclass(slots=True, eq=False)
class Tally:
    """Counts of a shop."""

    shop: Shop
    machines: list[MachineTally] = field(default_factory=list)
    products: list[ProductTally] = field(default_factory=list)
    processes: dict[tuple[int, int, int], ProcessTally] = field(default_factory=dict)
    power: PowerSeries = field(init=False)
    inside: int = 0
    """Parts in the shop."""
    area: float = 0.0
    """Parts in the shop times time, s."""
    since: float = 0.0
    _states: list[StateSpent] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.machines += [MachineTally() for _ in self.shop.machines]
        self.products += [ProductTally() for _ in self.shop.products]
        self.power = PowerSeries(self.shop.warm_up, self.shop.duration)

    @property
    def listeners(self) -> Listeners:
        """Functions that count."""
        return Listeners(
            part=(self.part,), state=(self.state,), entered=(self.entered,), left=(self.left,)
        )

    def part(self, part: PartMade) -> None:
        """Count a part that left a machine."""
        machine, product, step, _, _, end, _, _, time, _, _, energy, peak, _, is_good = part
        if end < self.shop.warm_up:
            return
        process = self.processes.get((product, step, machine))
        if process is None:
            process = self.processes.setdefault((product, step, machine), ProcessTally())
        process.parts += 1
        process.good += is_good
        process.time += time
        process.energy += energy
        process.peak = max(process.peak, peak)

    def state(self, spent: StateSpent) -> None:
        """Count the time in a state."""
        self._states.append(spent)
        if len(self._states) >= WAITING:
            self.flush()

    def flush(self) -> None:
        """Count the states that wait."""
        if not self._states:
            return
        columns = list(zip(*self._states, strict=True))
        self._states.clear()
        machine = np.array(columns[0])
        state = np.array([CODE[each] for each in columns[1]])
        begin, end, energy = (np.array(each) for each in columns[2:])
        # What lies before the warm-up does not count.
        late = np.clip(begin, self.shop.warm_up, np.maximum(end, self.shop.warm_up))
        energy = energy * (end - late) / (end - begin)
        counts = end > late
        cell = (machine * len(CODE) + state)[counts]
        begin, end, energy = late[counts], end[counts], energy[counts]
        seconds = np.bincount(cell, end - begin)
        joules = np.bincount(cell, energy)
        for row in np.flatnonzero(seconds).tolist():
            tally = self.machines[row // len(CODE)]
            of = STATES[row % len(CODE)]
            tally.seconds[of] += seconds[row]
            tally.joules[of] += joules[row]
        power, at = energy / (end - begin), machine[counts]
        for row in np.unique(at).tolist():
            tally = self.machines[row]
            tally.peak = max(tally.peak, float(power[at == row].max()))
        self.power.add(begin, end, energy)

    def entered(self, batch: Batch) -> None:
        """Count the parts of a batch in the shop."""
        self._wip(batch.released)
        self.inside += self.shop.products[batch.product].batch

    def left(self, batch: Batch, time: float) -> None:
        """Count the good parts of a batch."""
        self._wip(time)
        self.inside -= self.shop.products[batch.product].batch
        if time >= self.shop.warm_up:
            product = self.products[batch.product]
            product.good += len(batch.parts)
            product.lead += len(batch.parts) * (time - batch.released)

    def _wip(self, now: float) -> None:
        warm_up = self.shop.warm_up
        self.area += self.inside * max(0.0, now - max(self.since, warm_up))
        self.since = now

    def measures(self, floor: Floor) -> tuple[Measure, ...]:
        """Figures of the run, which has ended."""
        floor.close()
        self.flush()
        now = floor.env.now
        self._wip(now)
        span = now - self.shop.warm_up
        if span <= 0.0:
            return ()
        return (
            *self._line(floor, span),
            *(each for row in range(len(self.products)) for each in self._product(row, span)),
            *(each for row in range(len(self.machines)) for each in self._machine(row, span)),
            *(each for key in sorted(self.processes) for each in self._process(key)),
            *(
                Measure(
                    level=Level.BUFFER,
                    name=buffer.name,
                    quantity=Quantity.LEVEL,
                    value=buffer.area / span,
                )
                for buffer in floor.buffers.values()
            ),
        )

    def _line(self, floor: Floor, span: float) -> list[Measure]:
        good = sum(each.good for each in self.products)
        lost = sum(each.parts - each.good for each in self.processes.values())
        lead = sum(each.lead for each in self.products)
        energy = sum(sum(each.joules.values()) for each in self.machines)
        self.power.end = min(self.power.end, floor.env.now)
        values = {
            Quantity.GOOD: good,
            Quantity.THROUGHPUT: good / hours_from_seconds(span),
            Quantity.SCRAP: _share(lost, good + lost),
            Quantity.LEAD_TIME: hours_from_seconds(_ratio(lead, good)),
            Quantity.WIP: self.area / span,
            Quantity.ENERGY: kwh_from_joules(energy),
            Quantity.ENERGY_PER_PART: kwh_from_joules(_ratio(energy, good)),
            Quantity.MEAN_POWER: kw_from_watts(energy / span),
            Quantity.DEMAND: kw_from_watts(self.power.demand()),
            Quantity.PEAK_POWER: kw_from_watts(floor.meter.peak),
        }
        return _measures(Level.LINE, "", values)

    def _product(self, row: int, span: float) -> list[Measure]:
        found = self.products[row]
        own = [each for key, each in self.processes.items() if key[0] == row]
        lost = sum(each.parts - each.good for each in own)
        values = {
            Quantity.GOOD: found.good,
            Quantity.THROUGHPUT: found.good / hours_from_seconds(span),
            Quantity.SCRAP: _share(lost, found.good + lost),
            Quantity.LEAD_TIME: hours_from_seconds(_ratio(found.lead, found.good)),
        }
        return _measures(Level.PRODUCT, self.shop.products[row].name, values)

    def _machine(self, row: int, span: float) -> list[Measure]:
        found = self.machines[row]
        seconds = found.seconds
        planned = sum(seconds.values()) - seconds[_S.OFF]
        production = sum(seconds[each] for each in PRODUCTION)
        joules = sum(found.joules.values())
        own = [each for key, each in self.processes.items() if key[2] == row]
        parts, machined = sum(each.parts for each in own), sum(each.time for each in own)
        quality = _ratio(sum(each.good for each in own), parts)
        peak = max([found.peak, *(each.peak for each in own)])
        values = {
            Quantity.PARTS: parts,
            Quantity.UTILISATION: _share(seconds[_S.MACHINING], planned),
            Quantity.STARVED: _share(seconds[_S.STARVED], planned),
            Quantity.BLOCKED: _share(seconds[_S.BLOCKED], planned),
            Quantity.DOWN: _share(sum(seconds[each] for each in DOWN), planned),
            Quantity.AVAILABILITY: _share(production, planned),
            Quantity.EFFECTIVENESS: _share(machined, production),
            Quantity.QUALITY: 100.0 * quality,
            Quantity.OEE: _share(machined * quality, planned),
            Quantity.ENERGY: kwh_from_joules(joules),
            Quantity.MEAN_POWER: kw_from_watts(joules / span),
            Quantity.PEAK_POWER: kw_from_watts(peak),
        }
        return _measures(Level.MACHINE, self.shop.machines[row].name, values)

    def _process(self, key: tuple[int, int, int]) -> list[Measure]:
        product, step, machine = key
        found = self.processes[key]
        name = (
            f"{self.shop.products[product].name} step {step + 1} on "
            f"{self.shop.machines[machine].name}"
        )
        values = {
            Quantity.PARTS: found.parts,
            Quantity.TIME: found.time / found.parts,
            Quantity.PART_ENERGY: found.energy / found.parts / 1000.0,
            Quantity.MEAN_POWER: kw_from_watts(_ratio(found.energy, found.time)),
            Quantity.PEAK_POWER: kw_from_watts(found.peak),
        }
        return _measures(Level.PROCESS, name, values)


def _measures(level: Level, name: str, values: dict[Quantity, float]) -> list[Measure]:
    return [
        Measure(level=level, name=name, quantity=quantity, value=float(value))
        for quantity, value in values.items()
    ]


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole else nan


def _share(part: float, whole: float) -> float:
    """Share in per cent."""
    return 100.0 * _ratio(part, whole)
