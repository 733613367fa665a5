"""Status of a live shop as JSON: line, machines, buffers, products and processes.

A status is made several times a second, so it holds numbers only that change; its size is that
of the shop.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from simulator.factory.floor import Floor
from simulator.factory.shop import Product, Shop
from simulator.factory.states import MachineState
from simulator.factory.station import Station
from simulator.factory.tally import MachineTally
from stepnc_model.units import hours_from_seconds, kw_from_watts, kwh_from_joules


class Stages:
    """Places of machines and buffers in the flow of parts, from 0.

    Parameters
    ----------
    shop : Shop
    """

    def __init__(self, shop: Shop) -> None:
        self.machines: dict[str, int] = {}
        """First step of a route that a machine makes."""
        self.buffers: dict[str, int] = {}
        """First step behind which a buffer lies."""
        for product in shop.products:
            for at, step in enumerate(product.steps):
                for name in step.machines:
                    self.machines[name] = min(at, self.machines.get(name, at))
                if step.into:
                    self.buffers[step.into] = min(at, self.buffers.get(step.into, at))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShopView:
    """A running shop with what is counted of it."""

    shop: Shop
    floor: Floor
    programs: Mapping[str, str]
    """Names of programs for display, by their path."""
    stages: Stages

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self.floor.env.now)

    def energies(self) -> list[float]:
        """Energy of each machine so far, J."""
        machines = self.floor.tally.machines
        return [
            sum(tally.joules.values()) + station.power * (self.time - station.since)
            for tally, station in zip(machines, self.floor.stations, strict=True)
        ]

    def lost(self, product: int) -> int:
        """Scrapped parts of a product."""
        return sum(
            process.parts - process.good
            for machine in self.floor.tally.machines
            for (row, _), process in machine.processes.items()
            if row == product
        )

    def product_of(self, station: Station) -> tuple[Product, int] | None:
        """Product on a machine, and the index of the step that the machine makes."""
        batch = station.held
        if batch is None:
            return None
        # A batch that waits for room has its next step already.
        is_made = station.holding_for is not None
        return self.shop.products[batch.product], batch.step - int(is_made)

    def program_of(self, station: Station) -> str:
        """Name of the program of the part on a machine; empty: none."""
        found = self.product_of(station)
        path = "" if found is None else found[0].steps[found[1]].program
        return self.programs.get(path, Path(path).name) if path else ""


def live_status(view: ShopView, *, is_done: bool) -> dict[str, Any]:
    """Return the status of a running shop."""
    shop, floor = view.shop, view.floor
    energies = view.energies()
    return {
        "title": shop.title,
        "time_s": view.time,
        "start_s": shop.start,
        "hours": hours_from_seconds(shop.duration),
        "is_done": is_done,
        "line": _line(view, sum(energies)),
        "machines": [
            _machine(view, station, energy)
            for station, energy in zip(floor.stations, energies, strict=True)
        ],
        "buffers": [
            {
                "name": buffer.name,
                "stage": view.stages.buffers.get(buffer.name),
                "level": buffer.level,
                "offered": len(buffer.items) - buffer.level,
                "capacity": buffer.capacity if isfinite(buffer.capacity) else None,
            }
            for buffer in floor.buffers.values()
        ],
        "products": [
            {
                "name": product.name,
                "good": tally.good,
                "lost": view.lost(row),
                "waiting": None if raw.is_endless else len(raw.buffer.items),
                "lead_time_h": _hours(tally.lead, tally.good),
            }
            for row, (product, tally, raw) in enumerate(
                zip(shop.products, floor.tally.products, floor.raw, strict=True)
            )
        ],
        "processes": _processes(view),
    }


def _hours(lead: float, good: int) -> float | None:
    return hours_from_seconds(lead / good) if good else None


def _line(view: ShopView, energy: float) -> dict[str, Any]:
    tally = view.floor.tally
    power = sum(station.power for station in view.floor.stations)
    warm_up = view.shop.warm_up
    span = view.time - (warm_up if view.time >= warm_up else 0.0)
    good = sum(each.good for each in tally.products)
    return {
        "good": good,
        "lost": sum(view.lost(row) for row in range(len(tally.products))),
        "wip_parts": tally.inside,
        "throughput_h": good / hours_from_seconds(span) if span > 0.0 else None,
        "lead_time_h": _hours(sum(each.lead for each in tally.products), good),
        "power_kw": kw_from_watts(power),
        "peak_kw": kw_from_watts(tally.power.peak(view.time)),
        "energy_kwh": kwh_from_joules(energy),
        "energy_per_part_kwh": kwh_from_joules(energy / good) if good else None,
    }


def _machine(view: ShopView, station: Station, energy: float) -> dict[str, Any]:
    tally = view.floor.tally.machines[station.index]
    batch, work, made = station.held, station.work, view.product_of(station)
    seconds: dict[MachineState, float] = dict(tally.seconds)
    seconds[station.state] += view.time - station.since
    is_cut = work is not None and work.time > 0.0
    return {
        "name": station.spec.name,
        "stage": view.stages.machines.get(station.spec.name),
        "state": station.state.value,
        "since_s": station.since,
        "product": None if made is None else made[0].name,
        "step": None if made is None else made[1] + 1,
        "batch": None if batch is None else batch.number,
        "part": station.part,
        "program": view.program_of(station) or None,
        "progress": min(1.0, station.elapsed / work.time) if is_cut and work else None,
        "parts": parts_of(tally),
        "good": sum(each.good for each in tally.processes.values()),
        "power_kw": kw_from_watts(station.power),
        "energy_kwh": kwh_from_joules(energy),
        "seconds": {state.value: found for state, found in seconds.items() if found > 0.0},
    }


def _processes(view: ShopView) -> list[dict[str, Any]]:
    """Machining of each step on each machine so far, and its power now."""
    found = []
    rows = [
        (*key, station, process)
        for station, machine in zip(view.floor.stations, view.floor.tally.machines, strict=True)
        for key, process in machine.processes.items()
        if process.parts
    ]
    for product, step, station, tally in sorted(rows, key=lambda row: (*row[:2], row[2].index)):
        held = station.held
        is_now = (
            station.state is MachineState.MACHINING
            and held is not None
            and (held.product, held.step) == (product, step)
        )
        found.append({
            "product": view.shop.products[product].name,
            "step": step + 1,
            "machine": station.spec.name,
            "parts": tally.parts,
            "machining_s": tally.time / tally.parts,
            "energy_kj": tally.energy / tally.parts / 1000.0,
            "mean_kw": kw_from_watts(tally.energy / tally.time) if tally.time else None,
            "peak_kw": kw_from_watts(tally.peak),
            "now_kw": kw_from_watts(station.power) if is_now else 0.0,
        })
    return found


def parts_of(tally: MachineTally) -> int:
    """Parts that a machine has made."""
    return sum(each.parts for each in tally.processes.values())
