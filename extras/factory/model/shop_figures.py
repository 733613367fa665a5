"""Figures of a shop from its counts.

Times are those of ISO 22400-2, [1]_ of :mod:`extras.factory.model.measures`: *planned busy
time* is all but off shift, *actual production time* is part set-up, machining and part
ejection, and the *planned run time* of a part is its machining. So OEE is the machining time of
good parts over the planned busy time.
"""

from collections.abc import Iterable
from math import nan

from extras.factory.model.floor import Floor
from extras.factory.model.measures import Level, Measure, Quantity
from extras.factory.model.states import HANDLING, MachineState
from extras.factory.model.tally import ProcessTally
from stepnc_model.units import (
    hours_from_seconds,
    kj_from_joules,
    kw_from_watts,
    kwh_from_joules,
)

_S = MachineState

PRODUCTION = (_S.PART_SETUP, _S.MACHINING, _S.PART_EJECTION)
DOWN = (_S.FAILED, _S.REPAIR, _S.MAINTENANCE)


def measures_of(floor: Floor) -> tuple[Measure, ...]:
    """Figures of a run so far, without its warm-up; none before it is over."""
    floor.close()
    span = floor.env.now - floor.shop.warm_up
    if span <= 0.0:
        return ()
    return (
        *_line(floor, span),
        *(
            each
            for row in range(len(floor.shop.products))
            for each in _product(floor, row, span)
        ),
        *(
            each
            for row in range(len(floor.shop.machines))
            for each in _machine(floor, row, span)
        ),
        *_processes(floor),
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


def _line(floor: Floor, span: float) -> list[Measure]:
    tally = floor.tally
    good = sum(each.good for each in tally.products)
    lost = _lost(each for machine in tally.machines for each in machine.processes.values())
    lead = sum(each.lead for each in tally.products)
    energy = sum(sum(each.joules.values()) for each in tally.machines)
    values = {
        Quantity.GOOD: good,
        Quantity.THROUGHPUT: good / hours_from_seconds(span),
        Quantity.SCRAP: _share(lost, good + lost),
        Quantity.LEAD_TIME: hours_from_seconds(_ratio(lead, good)),
        Quantity.WIP: tally.area / span,
        Quantity.ENERGY: kwh_from_joules(energy),
        Quantity.ENERGY_PER_PART: kwh_from_joules(_ratio(energy, good)),
        Quantity.MEAN_POWER: kw_from_watts(energy / span),
        Quantity.DEMAND: kw_from_watts(tally.power.demand(floor.env.now)),
        Quantity.MINUTE_PEAK: kw_from_watts(tally.power.peak(floor.env.now)),
    }
    return _measures(Level.LINE, "", values)


def _product(floor: Floor, row: int, span: float) -> list[Measure]:
    found = floor.tally.products[row]
    lost = _lost(
        each
        for machine in floor.tally.machines
        for (product, _), each in machine.processes.items()
        if product == row
    )
    values = {
        Quantity.GOOD: found.good,
        Quantity.THROUGHPUT: found.good / hours_from_seconds(span),
        Quantity.SCRAP: _share(lost, found.good + lost),
        Quantity.LEAD_TIME: hours_from_seconds(_ratio(found.lead, found.good)),
    }
    return _measures(Level.PRODUCT, floor.shop.products[row].name, values)


def _machine(floor: Floor, row: int, span: float) -> list[Measure]:
    found, spec = floor.tally.machines[row], floor.shop.machines[row]
    seconds, processes = found.seconds, found.processes.values()
    planned = sum(seconds.values()) - seconds[_S.OFF]
    production = sum(seconds[each] for each in PRODUCTION)
    joules = sum(found.joules.values())
    parts, machined = (
        sum(each.parts for each in processes),
        sum(each.time for each in processes),
    )
    quality = _ratio(sum(each.good for each in processes), parts)
    peak = max(
        spec.idle_power,
        *(spec.handling[state].power for state in HANDLING if seconds[state]),
        *(each.peak for each in processes),
        0.0,
    )
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
    return _measures(Level.MACHINE, spec.name, values)


def _processes(floor: Floor) -> Iterable[Measure]:
    """Figures of each step on each machine that has made parts."""
    shop = floor.shop
    rows = sorted(
        (product, step, machine)
        for machine, tally in enumerate(floor.tally.machines)
        for product, step in tally.processes
    )
    for product, step, machine in rows:
        found = floor.tally.machines[machine].processes[product, step]
        name = f"{shop.products[product].name} step {step + 1} on {shop.machines[machine].name}"
        values = {
            Quantity.PARTS: found.parts,
            Quantity.TIME: _ratio(found.time, found.parts),
            Quantity.PART_ENERGY: kj_from_joules(_ratio(found.energy, found.parts)),
            Quantity.MEAN_POWER: kw_from_watts(_ratio(found.energy, found.time)),
            Quantity.PEAK_POWER: kw_from_watts(found.peak),
        }
        yield from _measures(Level.PROCESS, name, values)


def _measures(level: Level, name: str, values: dict[Quantity, float]) -> list[Measure]:
    return [
        Measure(level=level, name=name, quantity=quantity, value=float(value))
        for quantity, value in values.items()
    ]


def _lost(processes: Iterable[ProcessTally]) -> int:
    """Scrapped parts."""
    return sum(each.parts - each.good for each in processes)


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole else nan


def _share(part: float, whole: float) -> float:
    """Share in per cent."""
    return 100.0 * _ratio(part, whole)
