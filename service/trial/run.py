"""Live trial cut: every input may change while it runs, as in [1]_, Fig. 9.

Effects of changes:

- depth and workpiece change only in the machine; the loop notices them by the force;
- mode, control on or off, motor power and efficiency are orders to the loop, which continues;
- the allowed depth only gives a warning: it protects from chatter, which the machine does not
  model, and the depth is set by the part;
- every other change starts a new setup: the cutter enters again, and the loop knows all inputs.

Running state; independent of wall-clock time. Units inside: s; the status uses the user's.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model", "Optimal results" and Fig. 9.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from controller.laws.choice import LawName
from controller.orders import EventKind, LoopEvent
from service.session.rows import CM3_MIN, LiveRows, RunUpdate, known
from service.session.status import SessionStatus, over_percent, over_seconds
from service.trial.cut import predicted, trial_cut
from service.trial.inputs import Inputs, change_words, changed, differing
from service.trial.setup import TrialSetup
from stepnc_model.units import kw_from_watts, mm_min_from_speed, watts_from_kw

SET_UP = frozenset({
    "milling_type",
    "tool_diameter_mm",
    "teeth",
    "cutting_edge_angle_deg",
    "radial_width_mm",
    "cutting_speed_m_min",
    "feed_per_tooth_mm",
})
"""Inputs that cannot change while the cutter is engaged."""


LONGEST = 4 * 3600.0
"""Longest duration of a trial, in s; a longer one was forgotten."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialStatus(SessionStatus):
    """Status snapshot of a trial, the output pane of [1]_, Fig. 9; closed-form predictions."""

    inputs: Inputs
    power_predicted_kw: float
    """Predicted motor power at the actual feed, in kW."""
    force_predicted: float
    """Predicted force at the actual feed, in N."""
    feed_per_tooth_mm: float
    """Actual feed per tooth, in mm."""
    specific_cutting_force: float | None
    """Predicted specific cutting force, in N/mm²; None at standstill."""
    chip_thickness_mm: float
    """Predicted mean chip thickness, in mm."""
    depth_warning: str
    """Warning if the depth exceeds the allowed one, else empty."""
    stopped_by: str
    """Why the loop has stopped the run; empty if it has not."""


class TrialRun:
    """Trial cut in progress. Running state.

    Parameters
    ----------
    inputs : Inputs
    seed : int
        Seed of the instruments' noise.
    law : LawName
    """

    def __init__(self, inputs: Inputs, *, seed: int = 0, law: LawName = LawName.LOG_PI) -> None:
        self._seed, self._law = seed, law
        self._inputs, self._cut = inputs, trial_cut(inputs)
        self._live_rows = LiveRows(lambda: watts_from_kw(self._inputs.motor_power_kw))
        self._stopped_by = ""
        self._is_ended = False
        self._set_ups = 0
        self._set_up = self._begun(0.0)
        self._warn_of_depth()

    @property
    def time(self) -> float:
        """Time of the run, in s, continuous over all changes."""
        return self._set_up.time

    @property
    def inputs(self) -> Inputs:
        """Current inputs."""
        return self._inputs

    def advance(self, until: float) -> bool:
        """Run until a time, in s; return False when the run has ended or was stopped."""
        if self._is_ended or self.time > LONGEST:
            return False
        set_up = self._set_up
        while not set_up.is_done and set_up.time < until:
            for event in set_up.cycle().events:
                self._live_rows.note(event)
                if event.kind is EventKind.STOP:
                    self._stopped_by = event.text
        if set_up.is_done:
            set_up.trace.end()
        return not set_up.is_done

    def taken(self) -> RunUpdate:
        """Return rows and events since the last call."""
        return self._live_rows.taken()

    def change(self, inputs: Inputs) -> None:
        """Apply new inputs from the next cycle on; if stopped, from the restart."""
        before, names = self._inputs, differing(self._inputs, inputs)
        if not names:
            return
        self._inputs, self._cut = inputs, trial_cut(inputs)
        is_new = not SET_UP.isdisjoint(names)
        if self._set_up.loop.state.is_stopped:
            is_new = False
        elif is_new:
            self._renew()
        else:
            self._set_up.change(inputs)
        for name in names:
            self._say(EventKind.ORDER, change_words(before, inputs, name))
        if is_new:
            self._say(EventKind.ORDER, "new setup: the cutter enters the workpiece again")
        if not {"axial_depth_mm", "axial_depth_max_mm"}.isdisjoint(names):
            self._warn_of_depth()

    def restart(self) -> None:
        """Continue with a new cutter, which enters the workpiece again."""
        self._renew()
        self._say(EventKind.RESUME, "a new cutter enters the workpiece")

    @property
    def is_waiting(self) -> bool:
        """Whether the loop has stopped the run, which may then be restarted."""
        return self._set_up.loop.state.is_stopped and not self._is_ended

    def obey(self, order: Mapping[str, Any]) -> None:
        """Apply an order: changed inputs, ``restart`` or ``end``."""
        if order.get("end"):
            self._is_ended = True
        elif order.get("restart"):
            self.restart()
        elif order:
            self.change(changed(self._inputs, **order))

    def snapshot(self) -> dict[str, Any]:
        """Return the status snapshot as JSON."""
        return self.status().as_json()

    def status(self) -> TrialStatus:
        """Return the status snapshot of the trial."""
        inputs, cut, set_up = self._inputs, self._cut, self._set_up
        row = None if set_up.is_done else self._live_rows.last
        feed = 0.0 if row is None else row.feed_actual
        override = set_up.loop.state.override
        per_tooth = feed / (cut.cut.teeth * cut.spindle_speed)
        now = predicted(cut, per_tooth)
        monitor = set_up.loop.state.monitor
        return TrialStatus(
            inputs=inputs,
            time=self.time,
            power_predicted_kw=kw_from_watts(now.power),
            power_kw=0.0 if row is None else kw_from_watts(row.spindle_power_true),
            motor_power_kw=inputs.motor_power_kw,
            force_predicted=now.force,
            force_measured=None if row is None else known(row.force_measured),
            set_point=None if row is None else known(row.set_point),
            feed_per_tooth_mm=per_tooth,
            feed_programmed_mm_min=mm_min_from_speed(cut.feed),
            feed_advised_mm_min=mm_min_from_speed(override * cut.feed),
            feed_actual_mm_min=mm_min_from_speed(feed),
            override_percent=100.0 * override,
            removal_rate_cm3_min=0.0 if row is None else CM3_MIN * row.removal_rate,
            specific_cutting_force=now.specific_cutting_force,
            chip_thickness_mm=now.chip_thickness,
            is_overloaded=not set_up.is_done and self._live_rows.is_overloaded(self.time),
            depth_warning=self._depth_warning,
            over_set_point_percent=None if set_up.is_done else over_percent(monitor),
            over_set_point_s=0.0 if set_up.is_done else over_seconds(monitor),
            is_override_followed=not set_up.loop.state.following.is_astray,
            holding=set_up.holdings.words,
            level=set_up.holdings.level.value,
            is_stopped=set_up.loop.state.is_stopped,
            stopped_by=self._stopped_by,
            criterion=inputs.mode,
            is_on=inputs.is_on,
        )

    @property
    def _depth_warning(self) -> str:
        depth, allowed = self._inputs.axial_depth_mm, self._inputs.axial_depth_max_mm
        return f"depth {depth:g} mm exceeds allowed {allowed:g} mm" if depth > allowed else ""

    def _warn_of_depth(self) -> None:
        if self._depth_warning:
            self._say(EventKind.WARNING, self._depth_warning)

    def _renew(self) -> None:
        """Start a new setup at the present time, with the current inputs."""
        self._set_up.trace.end()
        self._set_up = self._begun(self.time)
        self._live_rows.last, self._stopped_by = None, ""

    def _begun(self, time: float) -> TrialSetup:
        self._set_ups += 1
        return TrialSetup(
            self._inputs,
            begin=time,
            seed=self._seed + self._set_ups,
            law=self._law,
            sink=self._live_rows,
        )

    def _say(self, kind: EventKind, text: str) -> None:
        event = LoopEvent(time=self.time, kind=kind, text=text)
        self._live_rows.note(event)
        self._set_up.trace.note(event)
