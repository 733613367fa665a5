"""Live controlled run: it is advanced step by step and can be changed while it runs.

Running state; independent of wall-clock time. Units inside: s; the status uses the user's.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from controller.guard import OverrideReason
from controller.orders import (
    CriterionTo,
    EventKind,
    FeedHoldTo,
    LoopEvent,
    MotorPowerTo,
    OverrideAtMost,
    SwitchTo,
)
from service.control.run import ControlRun, Session
from service.control.setup import hardness_against
from service.live.runner import (
    CM3_MIN,
    LiveRows,
    RunUpdate,
    SessionStatus,
    known,
    over_percent,
    over_seconds,
)
from service.requests.fields import loaded, require_bounds
from service.requests.runs import ControlChanges
from simulator.library import material_names
from simulator.physics.spindle import available_power
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity
from stepnc_model.errors import StepNcError
from stepnc_model.units import kw_from_watts, mm_min_from_speed

UNCHANGED = {"motor_power_percent": 100.0, "depth_percent": 100.0, "hardness_percent": 100.0}
"""Inputs of a run to which no changes were made yet."""


def require_changes(changes: ControlChanges) -> None:
    """Check that changes are within their bounds, and that the material is known.

    Raises
    ------
    StepNcError
        When a change is out of bounds or the material is unknown.
    """
    require_bounds(changes)
    if changes.material is not None and changes.material not in material_names():
        known_ones = ", ".join(material_names())
        raise StepNcError(f"unknown material '{changes.material}'; known: {known_ones}")


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlStatus(SessionStatus):
    """Status snapshot of a controlled run."""

    machine: str
    program: str
    progress: float
    """Completed share of the program, 0 to 1."""
    workingstep: str
    """Id of the current workingstep; empty: none."""
    force_expected: float | None
    """Force expected with the catalogue's k_c, in N; otherwise as the measured force."""
    axial_depth_mm: float
    """Actual axial depth of cut, in mm."""
    flank_wear_mm: float | None
    """Flank wear of the tool as estimated from the forces, in mm; None: not known."""
    flank_wear_deviation_mm: float | None
    """Standard deviation of that estimate, in mm."""
    remaining_s: float
    """Time that remains at the programmed feeds, in s."""
    override_ceiling_percent: float
    """Top of the override band, which the operator cannot raise, in per cent."""
    is_held: bool
    """Whether the operator holds the feed."""
    is_tool_change_due: bool
    """Whether the loop asks for a tool change."""
    is_done: bool
    """Whether the program has ended or was stopped."""


class LiveControl:
    """Controlled run that is advanced in small pieces. Running state.

    Parameters
    ----------
    session : Session
        Session made by :func:`service.control.run.prepare`, before its first cycle.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self._live_rows = LiveRows(self._motor_power)
        self._trace = session.trace(self._live_rows)
        self._cycles = session.cycles([self._trace])
        self._told = 0
        """Number of the session's events already added to the live rows."""
        self._asked: dict[str, Any] = {}
        """Changes that the run has accepted."""
        self._hardness = self._material = 1.0
        """Factors on k_c, of hardness and of material."""
        self._is_done = False

    @property
    def time(self) -> float:
        """Machine time, in seconds."""
        return self.session.machine.time

    def advance(self, until: float) -> bool:
        """Run until a time, in s; return False when the program has ended or was stopped."""
        while not self._is_done and self.time < until:
            self._is_done = next(self._cycles, None) is None
        return not self._is_done

    def taken(self) -> RunUpdate:
        """Return rows and events since the last call."""
        events = self.session.events
        for event in events[self._told :]:
            self._live_rows.note(event)
        self._told = len(events)
        return self._live_rows.taken()

    def change(self, changes: ControlChanges) -> None:
        """Apply the requested changes from the next cycle on.

        Raises
        ------
        StepNcError
            When a change is not possible; nothing has changed then.
        """
        require_changes(changes)
        mode = changes.mode
        hardness = hardness_against(self.session.plan.material)
        material = None if changes.material is None else hardness(changes.material)
        loop = self.session.loop
        self._require_most(changes.override_most_percent)
        if changes.is_held is not None:
            loop.order(FeedHoldTo(is_held=changes.is_held))
        if changes.override_most_percent is not None:
            loop.order(OverrideAtMost(most=0.01 * changes.override_most_percent))
        if mode is not None:
            loop.order(CriterionTo(criterion=mode))
        if changes.is_on is not None:
            loop.order(SwitchTo(is_on=changes.is_on))
        if changes.motor_power_percent is not None:
            loop.order(MotorPowerTo(factor=0.01 * changes.motor_power_percent))
        if changes.depth_percent is not None:
            self._hide(HiddenQuantity.DEPTH, 0.01 * changes.depth_percent)
            self._say(f"depth {changes.depth_percent:g} % of the programmed depth")
        if changes.hardness_percent is not None:
            self._hardness = 0.01 * changes.hardness_percent
            self._say(f"hardness {changes.hardness_percent:g} %")
        if material is not None:
            self._material = material
            self._say(f"workpiece material {changes.material}: k_c {100.0 * material:.3g} %")
        if material is not None or changes.hardness_percent is not None:
            self._hide(HiddenQuantity.HARDNESS, self._hardness * self._material)

    def _holding(self) -> str:
        """Return what limits the feed now; empty after the end."""
        if self._is_done:
            return ""
        is_held = self.session.loop.state.settings.is_held
        return OverrideReason.OPERATOR_HOLD.value if is_held else self.session.holdings.words

    def _require_most(self, percent: float | None) -> None:
        """Refuse a bound of the override above the band of the guard."""
        band = self.session.loop.state.settings.band
        if percent is not None and percent > 100.0 * band.ceiling:
            raise StepNcError(
                f"override_most_percent {percent:g} %: the guard allows at most "
                f"{100.0 * band.ceiling:g} %"
            )

    def status(self) -> ControlStatus:
        """Return the status snapshot of the run."""
        session, last = self.session, self._live_rows.last
        # After the end nothing moves, whatever the last row says.
        row = None if self._is_done else last
        monitor = session.loop.state.monitor
        life = monitor.life
        loop, machine, settings = session.loop, session.machine, session.loop.state.settings
        power = self._motor_power()
        programmed = 0.0 if row is None else row.feed_programmed
        return ControlStatus(
            time=machine.time,
            machine=session.virtual.name,
            program=session.program.name,
            progress=machine.share,
            workingstep="" if last is None else last.workingstep,
            feed_programmed_mm_min=mm_min_from_speed(programmed),
            feed_advised_mm_min=mm_min_from_speed(loop.state.override * programmed),
            feed_actual_mm_min=0.0 if row is None else mm_min_from_speed(row.feed_actual),
            override_percent=100.0 * loop.state.override,
            force_measured=None if row is None else known(row.force_measured),
            set_point=None if row is None else known(row.set_point),
            force_expected=None if row is None else known(row.force_expected),
            power_kw=0.0 if row is None else kw_from_watts(row.spindle_power_true),
            motor_power_kw=kw_from_watts(power) if isfinite(power) else None,
            removal_rate_cm3_min=0.0 if row is None else CM3_MIN * row.removal_rate,
            axial_depth_mm=0.0 if row is None else row.axial_depth,
            is_overloaded=not self._is_done and self._live_rows.is_overloaded(machine.time),
            over_set_point_percent=None if self._is_done else over_percent(monitor),
            over_set_point_s=0.0 if self._is_done else over_seconds(monitor),
            is_override_followed=not loop.state.following.is_astray,
            flank_wear_mm=None if life is None else life.flank_wear,
            flank_wear_deviation_mm=None if life is None else life.uncertainty,
            remaining_s=(1.0 - machine.share) * machine.course.duration,
            override_ceiling_percent=100.0 * settings.band.ceiling,
            is_held=settings.is_held and not self._is_done,
            is_tool_change_due=monitor.tool in monitor.worn
            or (loop.state.is_stopped and monitor.is_worn),
            holding=self._holding(),
            level=session.holdings.level.value,
            criterion=settings.criterion,
            is_on=settings.is_on,
            is_stopped=loop.state.is_stopped or session.is_lost,
            is_done=self._is_done,
        )

    @property
    def is_waiting(self) -> bool:
        """True while the operator holds the feed (see ``session.runner.LiveSession``)."""
        return self.session.loop.state.settings.is_held and not self._is_done

    def obey(self, order: Mapping[str, Any]) -> None:
        """Apply the changes of an order (:class:`service.live.runner.LiveSession`)."""
        if order:
            self.change(loaded(ControlChanges, order))
            self._asked |= order

    def snapshot(self) -> dict[str, Any]:
        """Return the status with the requested inputs; the machine's true state may differ."""
        status, session = self.status(), self.session
        most = min(100.0 * session.loop.state.settings.most, status.override_ceiling_percent)
        held = {
            "mode": status.criterion.value,
            "is_on": status.is_on,
            "is_held": status.is_held,
            "override_most_percent": most,
        }
        usual = {**UNCHANGED, "material": session.plan.material.material.name}
        tools = {each.workingstep.id: each.tool.id for each in session.advices if each}
        return {
            **status.as_json(),
            "tool": tools.get(status.workingstep, ""),
            "inputs": {**usual, **self._asked, **held},
        }

    def finish(self) -> ControlRun:
        """Close the output files and return the result, as ``control`` does; call it once.

        The file of an unfinished run is left as a partial file.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        self._trace.close(is_whole=self._is_done)
        return self.session.result(self._trace)

    def _hide(self, what: HiddenQuantity, factor: float) -> None:
        """Change the machine without telling the loop."""
        machine = self.session.machine
        machine.change(HiddenChange(time=machine.time, what=what, value=factor))

    def _say(self, text: str) -> None:
        event = LoopEvent(time=self.time, kind=EventKind.ORDER, text=text)
        self.session.events.append(event)
        self._trace.note(event)

    def _motor_power(self) -> float:
        """Power available from the motor at this speed, in W; infinite at standstill."""
        session = self.session
        machine = session.machine
        speed = float(machine.course.spindle_speed[machine.truth.cell])
        if not speed > 0.0:
            return inf
        factor = session.loop.state.settings.power_factor
        return factor * available_power(session.virtual.spindle, speed)
