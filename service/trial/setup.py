"""Setup of a trial cut: one engaged cutter, its virtual machine and the control loop.

Running state. The machine's clock restarts with each setup, and its motor power is that at the
tool; here both are converted to the time of the run and to the drive of the inputs, so that
time continues over all changes and the efficiency can change during the cut. Units s, N, W.
"""

from collections.abc import Callable
from dataclasses import replace
from math import inf

from controller.cycle import LoopCycle
from controller.guard import OverrideBand
from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.loop_settings import LoopSettings
from controller.loop_state import STANDING
from controller.orders import Criterion, CriterionTo, EventKind, MotorPowerTo, SwitchTo
from controller.source import Dynamometer
from optimiser.problem import LimitName
from service.control.holding import NO_CHIPS, HoldTallies, OverrideLimits, reason
from service.control.trace import ControlTrace
from service.session.rows import Moment
from service.trial.cut import NAME, course_of, preview_of, step_of, trial_cut
from service.trial.inputs import Inputs
from simulator.plant.controlled import ControlledMachine, Instrumentation, TrueState
from simulator.plant.dynamometer import DYNAMOMETER
from simulator.plant.hidden import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading

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
        """Return the next reading (:class:`controller.ports.Sensor`)."""
        raw = self._machine.read()
        if raw is None:
            return None
        return raw._replace(time=self._begin + raw.time, power=raw.power / self.efficiency)

    def set(self, override: float, /) -> None:
        """Command an override (:class:`controller.ports.Override`)."""
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
    law : LawName
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
        """Whether the loop has stopped the program and the axes stand still."""
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
