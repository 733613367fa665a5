"""A shop that runs live: advanced step by step, watched, and ordered about while it runs.

Running state; independent of wall-clock time. Inside s, W and J; rows and status in the units
of their names. Figures begin anew at the end of the warm-up, as those of the result.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import Any

import numpy as np

from service.factory.live_status import ShopView, Stages, live_status
from service.factory.state_log import COLUMNS, STATES
from service.requests.factory import LONGEST_REPAIR, SHORTEST_REPAIR
from simulator.factory.floor import Floor
from simulator.factory.machining import MachiningPlan
from simulator.factory.records import Listeners
from simulator.factory.shop import Shop
from simulator.factory.states import MachineState
from simulator.factory.streams import Streams
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from stepnc_model.units import (
    kw_from_watts,
    kwh_from_joules,
    seconds_from_minutes,
)


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


TOLD = {
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
    """Shop that is advanced and ordered about. Running state.

    Parameters
    ----------
    shop : Shop
    plan : MachiningPlan
    seed : int
    programs : mapping
        Names of programs for display, by their path.
    listeners : Listeners
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
            (0.0, row, STATES.index(each.state)) for row, each in enumerate(self.floor.stations)
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
        """Whether the run waits for an order: never."""
        return False

    @property
    def is_done(self) -> bool:
        """Whether the run has ended."""
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
        state = station.state
        if not station.fail(seconds_from_minutes(minutes)):
            raise StepNcError(f"{name} cannot fail now: it is in the state '{state.value}'")
        text = f"{name} fails by order, repair {minutes:g} min"
        self._say(ShopEventKind.ORDER, text)

    def _row(self) -> list[float]:
        """Row whose powers are means since the last row, so that they add up to the energy."""
        before, since = self._told, self.time - self._told_at
        energies = self.view.energies()
        powers = [station.power for station in self.floor.stations]
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
        state, name = station.state, station.spec.name
        self._changes.append((self.time, index, STATES.index(state)))
        if self._before[index] is MachineState.REPAIR:
            self._say(ShopEventKind.REPAIRED, f"{name} is repaired: {state.value}")
        elif state in TOLD:
            kind, words = TOLD[state]
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
