"""The trial cut as it runs: every input may change while it goes on, as in [1]_, Fig. 9.

What a change is:

- depth and workpiece change in the machine only; the loop finds out by the force;
- mode, ON/OFF, motor power and efficiency are told to the loop, which goes on;
- the allowed depth only warns: what it protects from, chatter, the machine does not model, and
  the depth is where the part is;
- all else is another set-up: the cutter enters anew, and the loop knows the inputs as they are.

Running state; no wall time. Units s at the inside, the user's units in the status.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model", "Optimal results" and Fig. 9.
"""

from dataclasses import dataclass

from controller.laws.choice import LawName
from controller.orders import Criterion, Event, EventKind
from controller.threshold import Level
from service.control.live_run import Taken
from service.control.tape import CM3_MIN, Tape, known
from service.trial.cut import predicted, trial_cut
from service.trial.inputs import Inputs, change_words, differing
from service.trial.setup import SetUp
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
"""inputs that cannot change while the cutter is in the work"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """How a trial is: the output pane of [1]_, Fig. 9. Predicted: by the closed form."""

    inputs: Inputs
    time: float
    """s"""
    power_predicted_kw: float
    """of the motor, at the feed that runs"""
    power_kw: float
    """that the drive really draws"""
    motor_power_kw: float
    force_predicted: float
    """N, at the feed that runs"""
    force_measured: float | None
    """N, mean of the last revolution; None: there was none"""
    set_point: float | None
    """N; None: not known yet"""
    feed_per_tooth_mm: float
    """that runs"""
    feed_programmed_mm_min: float
    """at the chip load"""
    feed_advised_mm_min: float
    """that the loop commands"""
    feed_actual_mm_min: float
    override_percent: float
    """commanded"""
    removal_rate_cm3_min: float
    """that really is removed"""
    specific_cutting_force: float | None
    """N/mm², predicted; None: the feed stands"""
    chip_thickness_mm: float
    """mean, predicted"""
    is_over: bool
    """power limit warning: the drive draws more than the motor has, or did a second ago"""
    depth_warning: str
    """empty: the machine allows the depth"""
    holding: str
    """what holds the feed now"""
    level: Level
    """of the force, as the loop sees it"""
    is_stopped: bool
    """by the loop; see :meth:`TrialRun.restart`"""
    stopped_by: str
    """why; empty: it is not"""
    criterion: Criterion
    is_on: bool


class TrialRun:
    """A trial cut. Running state.

    Parameters
    ----------
    inputs : Inputs
    seed : int
        Of the instruments' noise.
    law : LawName
    """

    def __init__(self, inputs: Inputs, *, seed: int = 0, law: LawName = LawName.LOG_PI) -> None:
        self._seed, self._law = seed, law
        self._inputs, self._cut = inputs, trial_cut(inputs)
        self._tape = Tape(lambda: watts_from_kw(self._inputs.motor_power_kw))
        self._stopped_by = ""
        self._set_ups = 0
        self._set_up = self._begun(0.0)
        self._warn_of_depth()

    @property
    def time(self) -> float:
        """S, continuous over all changes."""
        return self._set_up.time

    @property
    def inputs(self) -> Inputs:
        """As they are now."""
        return self._inputs

    def advance(self, until: float) -> bool:
        """Run until a time, s; False: the loop has stopped the program, and the axes stand."""
        set_up = self._set_up
        while not set_up.is_done and set_up.time < until:
            for event in set_up.cycle().events:
                self._tape.note(event)
                if event.kind is EventKind.STOP:
                    self._stopped_by = event.text
        if set_up.is_done:
            set_up.trace.end()
        return not set_up.is_done

    def taken(self) -> Taken:
        """Rows and events since it was asked last."""
        return self._tape.taken()

    def change(self, inputs: Inputs) -> None:
        """Let the inputs be otherwise from the next cycle on; if stopped, from the restart."""
        before, names = self._inputs, differing(self._inputs, inputs)
        if not names:
            return
        self._inputs, self._cut = inputs, trial_cut(inputs)
        is_new = not SET_UP.isdisjoint(names)
        if self._set_up.loop.is_stopped:
            is_new = False
        elif is_new:
            self._renew()
        else:
            self._set_up.change(inputs)
        for name in names:
            self._say(EventKind.ORDER, change_words(before, inputs, name))
        if is_new:
            self._say(EventKind.ORDER, "another set-up: the cutter enters the work anew")
        if not {"axial_depth_mm", "axial_depth_max_mm"}.isdisjoint(names):
            self._warn_of_depth()

    def restart(self) -> None:
        """Go on with a new cutter, which enters the work anew."""
        self._renew()
        self._say(EventKind.RESUME, "a new cutter enters the work")

    def status(self) -> Status:
        """How the trial is now."""
        inputs, cut, set_up = self._inputs, self._cut, self._set_up
        row = None if set_up.is_done else self._tape.last
        feed = 0.0 if row is None else row.feed_actual
        override = set_up.loop.override
        per_tooth = feed / (cut.cut.teeth * cut.spindle_speed)
        now = predicted(cut, per_tooth)
        return Status(
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
            is_over=not set_up.is_done and self._tape.is_over(self.time),
            depth_warning=self._depth_warning,
            holding=set_up.holdings.words,
            level=set_up.holdings.level,
            is_stopped=set_up.loop.is_stopped,
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
        """Another set-up at the present time, with the inputs as they are."""
        self._set_up.trace.end()
        self._set_up = self._begun(self.time)
        self._tape.last, self._stopped_by = None, ""

    def _begun(self, time: float) -> SetUp:
        self._set_ups += 1
        return SetUp(
            self._inputs,
            begin=time,
            seed=self._seed + self._set_ups,
            law=self._law,
            sink=self._tape,
        )

    def _say(self, kind: EventKind, text: str) -> None:
        event = Event(time=self.time, kind=kind, text=text)
        self._tape.note(event)
        self._set_up.trace.note(event)
