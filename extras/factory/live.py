"""A live shop: it runs step by step, reports its states, and takes orders while it runs.

Running state; independent of wall-clock time. Inside s, W and J; rows and status in the units
of their names. Figures begin anew at the end of the warm-up, as those of the result.

Its status is JSON: line, machines, buffers, products and processes. It is made several times a
second, so that it holds only numbers that change; its size is that of the shop.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from extras.factory.model.floor import Floor
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Product, Shop
from extras.factory.model.states import MachineState
from extras.factory.model.station import Station
from extras.factory.model.streams import Streams
from extras.factory.model.tally import MachineTally
from extras.factory.requests import LONGEST_REPAIR, SHORTEST_REPAIR
from extras.factory.state_log import COLUMNS, STATES
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from stepnc_model.units import (
    hours_from_seconds,
    kj_from_joules,
    kw_from_watts,
    kwh_from_joules,
    seconds_from_minutes,
)


class Stages:
    """Places of machines and buffers in the flow of parts, from 0."""

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
            sum(tally.joules.values()) + station.book.power * (self.time - station.book.since)
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
    power = sum(station.book.power for station in view.floor.stations)
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
    seconds[station.book.state] += view.time - station.book.since
    is_cut = work is not None and work.time > 0.0
    return {
        "name": station.spec.name,
        "stage": view.stages.machines.get(station.spec.name),
        "state": station.book.state.value,
        "since_s": station.book.since,
        "product": None if made is None else made[0].name,
        "step": None if made is None else made[1] + 1,
        "batch": None if batch is None else batch.number,
        "part": station.part,
        "program": view.program_of(station) or None,
        "progress": min(1.0, station.book.elapsed(view.time) / work.time)
        if is_cut and work
        else None,
        "parts": parts_of(tally),
        "good": sum(each.good for each in tally.processes.values()),
        "power_kw": kw_from_watts(station.book.power),
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
            station.book.state is MachineState.MACHINING
            and held is not None
            and (held.product, held.step) == (product, step)
        )
        found.append({
            "product": view.shop.products[product].name,
            "step": step + 1,
            "machine": station.spec.name,
            "parts": tally.parts,
            "machining_s": tally.time / tally.parts,
            "energy_kj": kj_from_joules(tally.energy / tally.parts),
            "mean_kw": kw_from_watts(tally.energy / tally.time) if tally.time else None,
            "peak_kw": kw_from_watts(tally.peak),
            "now_kw": kw_from_watts(station.book.power) if is_now else 0.0,
        })
    return found


def parts_of(tally: MachineTally) -> int:
    """Parts that a machine has made."""
    return sum(each.parts for each in tally.processes.values())


class ShopEventKind(StrEnum):
    """Kind of an event of a live shop."""

    FAILED = "failed"
    REPAIR = "repair"
    REPAIRED = "repaired"
    MAINTENANCE = "maintenance"
    OFF = "off"
    ORDER = "order"
    """An order of a user was carried out."""
    OVER = "over"


EVENT_OF_STATE = {
    MachineState.FAILED: (ShopEventKind.FAILED, "failed"),
    MachineState.REPAIR: (ShopEventKind.REPAIR, "is being repaired"),
    MachineState.MAINTENANCE: (ShopEventKind.MAINTENANCE, "is being maintained"),
    MachineState.OFF: (ShopEventKind.OFF, "is off shift"),
}
"""States whose begin is an event, and what its text says."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShopEvent:
    """Event of a live shop."""

    time: float
    kind: ShopEventKind
    text: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShopUpdate:
    """Rows and events of a live shop since the last call."""

    rows: Floats
    events: tuple[ShopEvent, ...]


class LiveShop:
    """Shop that runs step by step and takes orders. Running state.

    Parameters
    ----------
    seed : int
    programs : mapping
        Names of programs for display, by their path.
    """

    def __init__(
        self,
        shop: Shop,
        plan: MachiningPlan,
        *,
        seed: int,
        programs: Mapping[str, str],
        listeners: Listeners | None = None,
    ) -> None:
        self.shop = shop
        told = Listeners(began=(self._began,)).plus(listeners or Listeners())
        self._events: list[ShopEvent] = []
        self._rows: list[list[float]] = []
        self._changes: list[tuple[float, int, int]] = []
        self._before = [MachineState.IDLING] * len(shop.machines)
        self._is_ended = False
        self._numbers = {machine.name: at for at, machine in enumerate(shop.machines)}
        self.floor = Floor(shop, plan, Streams(seed=seed), told)
        self.view = ShopView(
            shop=shop,
            floor=self.floor,
            programs=programs,
            stages=Stages(shop),
        )
        self._told_at, self._told = 0.0, self.view.energies()
        self._rows.append(self._row())
        self._changes += [
            (0.0, row, STATES.index(each.book.state))
            for row, each in enumerate(self.floor.stations)
        ]

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the rows."""
        own = (f"power_w:{machine.name}" for machine in self.shop.machines)
        return ("time_s", "power_kw", "energy_kwh", "wip_parts", "good_parts", *own)

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self.floor.env.now)

    @property
    def is_waiting(self) -> bool:
        """True if the run waits for an order: never."""
        return False

    @property
    def is_done(self) -> bool:
        """True if the run has ended."""
        return not self._goes_on()

    def advance(self, until: float) -> bool:
        """Advance to a time, in s; return False when the run has ended.

        Raises
        ------
        Deadlock
            When machines wait for each other.
        """
        if self.is_done:
            return False
        self.floor.run(min(until, self.shop.duration))
        self._rows.append(self._row())
        goes_on = self._goes_on()
        if not goes_on:
            self._say(ShopEventKind.OVER, self._why_over())
        return goes_on

    def taken(self) -> ShopUpdate:
        """Return rows and events since the last call."""
        width = len(self.columns)
        rows = np.array(self._rows, dtype=np.float64).reshape(-1, width)
        update = ShopUpdate(rows=rows, events=tuple(self._events))
        self._rows.clear()
        self._events.clear()
        return update

    def changes(self) -> Floats:
        """Return changes of state since the last call, (N, 3), as :data:`COLUMNS`."""
        changes = np.array(self._changes, dtype=np.float64).reshape(-1, len(COLUMNS))
        self._changes.clear()
        return changes

    def obey(self, order: Mapping[str, Any]) -> None:
        """Let a machine fail, or end the run.

        Raises
        ------
        StepNcError
            When the machine is unknown, off or already down, or the repair time is not allowed.
        """
        if "machine" in order:
            self._fail(str(order["machine"]), float(order["repair_min"]))
        if order.get("end"):
            self._is_ended = True
            self._say(ShopEventKind.OVER, "ended by order")

    def snapshot(self) -> dict[str, Any]:
        """Return the status as JSON."""
        return live_status(self.view, is_done=self.is_done)

    def _goes_on(self) -> bool:
        is_over = self.time >= self.shop.duration or self.floor.is_finished
        return not (self._is_ended or is_over)

    def _fail(self, name: str, minutes: float) -> None:
        require_failure(self._numbers, name, minutes)
        station = self.floor.stations[self._numbers[name]]
        state = station.book.state
        if not station.fail(seconds_from_minutes(minutes)):
            raise StepNcError(f"{name} cannot fail now: it is in the state '{state.value}'")
        text = f"{name} fails by order, repair {minutes:g} min"
        self._say(ShopEventKind.ORDER, text)

    def _row(self) -> list[float]:
        """Row whose powers are means since the last row, so that they add up to the energy."""
        before, since = self._told, self.time - self._told_at
        energies = self.view.energies()
        powers = [station.book.power for station in self.floor.stations]
        # At the end of the warm-up energies begin anew.
        if since > 0.0 and all(now >= own for now, own in zip(energies, before, strict=True)):
            powers = [(now - own) / since for now, own in zip(energies, before, strict=True)]
        self._told_at, self._told = self.time, energies
        return [
            self.time,
            kw_from_watts(sum(powers)),
            kwh_from_joules(sum(energies)),
            float(self.floor.tally.inside),
            float(sum(each.good for each in self.floor.tally.products)),
            *powers,
        ]

    def _began(self, index: int) -> None:
        """Note a change of state."""
        station = self.floor.stations[index]
        state, name = station.book.state, station.spec.name
        self._changes.append((self.time, index, STATES.index(state)))
        if self._before[index] is MachineState.REPAIR:
            self._say(ShopEventKind.REPAIRED, f"{name} is repaired: {state.value}")
        elif state in EVENT_OF_STATE:
            kind, words = EVENT_OF_STATE[state]
            self._say(kind, f"{name} {words}")
        self._before[index] = state

    def _say(self, kind: ShopEventKind, text: str) -> None:
        self._events.append(ShopEvent(time=self.time, kind=kind, text=text))

    def _why_over(self) -> str:
        if self.floor.is_finished:
            return "all orders are finished"
        return "the simulated time is over"


def require_failure(known: Collection[str], name: str, minutes: float) -> None:
    """Check the machine and the repair time of an ordered failure.

    Raises
    ------
    StepNcError
        When the machine is unknown, or the repair time is out of bounds.
    """
    if name not in known:
        raise StepNcError(f"unknown machine '{name[:80]}'; known: {', '.join(known)}")
    if not (isfinite(minutes) and SHORTEST_REPAIR < minutes <= LONGEST_REPAIR):
        bounds = f"above {SHORTEST_REPAIR:g} to {LONGEST_REPAIR:g} min"
        raise StepNcError(f"repair {minutes:g} min: it must be {bounds}")
