"""Live trial cut: every input may change while it runs, as in [1]_, Fig. 9.

Effects of changes:

- depth and workpiece change only in the machine; the loop notices them by the force;
- mode, control on or off, motor power and efficiency are orders to the loop, which continues;
- the allowed depth only gives a warning: it protects from chatter, which the machine does not
  model, and the depth is set by the part;
- every other change starts a new setup: the cutter enters again, and the loop knows all inputs.

Running state; independent of wall-clock time. Units inside: s; the status uses the user's.

Setup of a trial cut: one engaged cutter, its virtual machine and the control loop.

Running state. The machine's clock restarts with each setup, and its motor power is that at the
tool; here both are converted to the time of the run and to the drive of the inputs, so that
time continues over all changes and the efficiency can change during the cut. Units s, N, W.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model", "Optimal results" and Fig. 9.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from controller.cycle import LoopCycle
from controller.guard import OverrideBand
from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.orders import (
    Criterion,
    CriterionTo,
    EventKind,
    LoopEvent,
    MotorPowerTo,
    SwitchTo,
)
from controller.signals.source import Dynamometer
from controller.states.loop_settings import LoopSettings
from controller.states.loop_state import STANDING
from optimiser.solver.problem import LimitName
from service.control.holding import NO_CHIPS, HoldTallies, OverrideLimits, reason
from service.control.trace import ControlTrace
from service.live.runner import (
    CM3_MIN,
    LiveRows,
    Moment,
    RunUpdate,
    SessionStatus,
    known,
    over_percent,
    over_seconds,
)
from service.trial.inputs import (
    NAME,
    Inputs,
    change_words,
    changed,
    course_of,
    differing,
    predicted,
    preview_of,
    step_of,
    trial_cut,
)
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation, TrueState
from simulator.plant.dynamometer import DYNAMOMETER
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading
from stepnc_model.units import kw_from_watts, mm_min_from_speed, watts_from_kw

BAND = OverrideBand(floor=0.05)
"""Override band; 100 % is the full chip load, far above what a weak motor allows."""

INSTRUMENT = replace(DYNAMOMETER, drift=0.0)
"""Dynamometer without drift, because an endless cut never allows it to be zeroed again."""


class TrialMachine:
    """Virtual machine as seen by the loop, in the time of the run. Running state.

    Parameters
    ----------
    machine : ControlledMachine
        Machine whose drive has no losses.
    begin : float
        Time in the run at which the machine's time begins, in s.
    efficiency : float
        Efficiency of the drive.
    """

    def __init__(self, machine: ControlledMachine, *, begin: float, efficiency: float) -> None:
        self.efficiency = efficiency
        self._machine, self._begin = machine, begin

    @property
    def time(self) -> float:
        """Time of the run, in seconds."""
        return self._begin + self._machine.time

    @property
    def truth(self) -> TrueState:
        """True state of the last period."""
        truth = self._machine.truth
        return truth._replace(power=truth.power / self.efficiency)

    def read(self) -> Reading | None:
        """Return the next reading (:class:`controller.signals.ports.Sensor`)."""
        raw = self._machine.read()
        if raw is None:
            return None
        return raw._replace(time=self._begin + raw.time, power=raw.power / self.efficiency)

    def set(self, override: float, /) -> None:
        """Command an override (:class:`controller.signals.ports.Override`)."""
        self._machine.set(override)


class TrialSetup:
    """Cutter that enters the workpiece and stays engaged. Running state.

    Parameters
    ----------
    inputs : Inputs
        Inputs that the plan is based on.
    begin : float
        Time in the run at the start of the setup, in s.
    seed : int
    sink : callable
        Callback that receives the rows.
    """

    def __init__(
        self,
        inputs: Inputs,
        *,
        begin: float,
        seed: int,
        law: LawName,
        sink: Callable[[Moment], None],
    ) -> None:
        trial = trial_cut(inputs)
        course = course_of(trial)
        self._planned = self._inputs = inputs
        self._step = step_of(trial, inputs)
        self._machine = ControlledMachine(
            course, HiddenTruth(), Instrumentation(dynamometer=INSTRUMENT, seed=seed)
        )
        self._drive = TrialMachine(self._machine, begin=begin, efficiency=inputs.efficiency)
        settings = LoopSettings(
            criterion=inputs.mode, is_on=inputs.is_on, band=BAND, look_ahead=0
        )
        self.loop = Loop(
            self._drive,
            self._drive,
            source=Dynamometer(settings.chips),
            law=lambda plant: law_named(law, plant, has_preview=False),
            steps=[self._step],
            preview=preview_of(course),
            settings=settings,
        )
        self._holdings = HoldTallies([])
        self.trace = ControlTrace(course, self._holdings, workingsteps=(NAME,), sink=sink)
        self._override = 1.0

    @property
    def time(self) -> float:
        """Time of the run, in seconds."""
        return self._drive.time

    @property
    def holdings(self) -> HoldTallies:
        """Reasons that limit the feed, and the level of the force."""
        return self._holdings

    @property
    def is_done(self) -> bool:
        """True if the loop has stopped the program and the axes stand still."""
        return self.loop.state.is_stopped and self._override < STANDING

    def cycle(self) -> LoopCycle:
        """Run one cycle of the loop."""
        cycle = self.loop.cycle()
        if cycle is None:
            raise RuntimeError("a trial cut has no end")
        # The run reports orders itself, with old and new values.
        events = tuple(each for each in cycle.events if each.kind is not EventKind.ORDER)
        if len(events) < len(cycle.events):
            cycle = cycle._replace(events=events)
        self._override = cycle.reading.override
        self._hold(cycle)
        self.trace(cycle, self._drive.truth)
        return cycle

    def change(self, inputs: Inputs) -> None:
        """Apply changes that need no new setup, from the next cycle on.

        Depth and workpiece change without notice to the loop, which still compares the force
        with that of the inputs with which it began.
        """
        before, self._inputs = self._inputs, inputs
        machine, planned = self._machine, self._planned
        if inputs.axial_depth_mm != before.axial_depth_mm:
            depth = inputs.axial_depth_mm / planned.axial_depth_mm
            machine.change(
                HiddenChange(time=machine.time, what=HiddenQuantity.DEPTH, value=depth)
            )
        if inputs.material != before.material:
            # The exponent differs as well, so a factor on k_c is not enough.
            real = replace(planned, material=inputs.material)
            machine.course = course_of(trial_cut(real))
        self._order(before, inputs)

    def _order(self, before: Inputs, inputs: Inputs) -> None:
        """Pass changes of mode, switch and motor power to the loop as orders."""
        if inputs.mode is not before.mode:
            self.loop.order(CriterionTo(criterion=inputs.mode))
        if inputs.is_on is not before.is_on:
            self.loop.order(SwitchTo(is_on=inputs.is_on))
        if _power(inputs) != _power(before):
            self.loop.order(MotorPowerTo(factor=_power(inputs) / _power(self._planned)))
        self._drive.efficiency = inputs.efficiency

    def _hold(self, cycle: LoopCycle) -> None:
        """Record the reason that limits the override."""
        settings, holdings = self.loop.state.settings, self._holdings
        holdings.add(cycle, settings)
        if cycle.revolution is not None and holdings.words != NO_CHIPS:
            holdings.words = reason(cycle, self._ends, settings)

    @property
    def _ends(self) -> OverrideLimits:
        """Override limits of the cut; in mode QC the mode itself sets the ceiling."""
        reference = self._step.reference
        is_quality = self.loop.state.settings.criterion is Criterion.QC
        return OverrideLimits(
            reference=reference,
            ceiling=(inf, "") if is_quality else (reference.ceiling, "chip load"),
            floor=(reference.floor, LimitName.CHIP_THICKNESS.words),
        )


def _power(inputs: Inputs) -> float:
    """Motor power at the tool, in kW."""
    return inputs.motor_power_kw * inputs.efficiency


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
    seed : int
        Seed of the instruments' noise.
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
        """True if the loop has stopped the run, which may then be restarted."""
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
