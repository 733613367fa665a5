"""Run of a program under force control on the virtual machine, for the command ``control``."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from controller.cycle import LoopCycle
from controller.errors import MachineLost
from controller.guard import OverrideBand
from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.orders import Criterion, EventKind, LoopEvent
from controller.record import Recorder, RunRecord
from controller.signals.estimate import RatioEstimate
from controller.signals.source import DrivePower, Dynamometer, Source
from controller.states.equivalent_force import equivalent
from controller.states.loop_settings import LoopSettings
from optimiser.advice import Advice, Plan
from optimiser.modes import Mode
from service.control.disturbances import TimedOrder, disturbances
from service.control.expected_results import PlannedWorkingstep, planned_steps, with_hardest
from service.control.holding import HoldTallies, HoldTally
from service.control.loads import CutKey, Loads, key_of, read_loads
from service.control.setup import (
    advices_in_order,
    hardness_against,
    plan_as_it_is,
    planned_course,
    preview_of,
    require_teeth,
    steps_of,
)
from service.control.trace import COLUMNS, ControlTrace
from service.live.runner import Moment
from service.outputs.run_file import RunFile
from service.plots.buckets import BucketedRun
from service.programs.remarks import tell_remarks
from service.progress import Tell, Ticker, bar, silent
from service.requests.fields import require_bounds
from service.requests.runs import ControlRequest, SensorChoice, SimulationRequest
from service.simulation.drive import LoopMachine
from service.simulation.run import RunFiles, waiting_machine
from simulator.errors import MachineSilent
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation, TrueState
from simulator.plant.recorded_machine import RecordedMachine, RecordedSignals
from simulator.reading import Reading
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program

CHIP_FORCES = {
    SensorChoice.DYNAMOMETER: 10.0,
    SensorChoice.COMPONENTS: 10.0,
    SensorChoice.POWER: 60.0,
}
"""Force above which a sensor counts as cutting, in N: several times its noise."""


FEWEST_SAMPLES = 20
"""Fewest recorded samples of a cut from which k_c is learned: entry and exit blur some."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRun:
    """Result of a run under force control."""

    program: Program
    machine: Machine
    material: MaterialMatch
    law: LawName
    has_preview: bool
    criterion: Criterion
    plan: Plan
    """Plan of the unchanged program."""
    steps: tuple[tuple[Advice | None, RunRecord], ...]
    """Advice (None outside workingsteps) and record of each workingstep, in order."""
    planned: Mapping[int, PlannedWorkingstep]
    """Planned values by workingstep number."""
    events: tuple[LoopEvent, ...]
    findings: tuple[Finding, ...]
    time: float
    """Duration of the run, in s."""
    time_planned: float
    """Duration at an override of 1, in s."""
    is_stopped: bool
    """Whether the loop stopped the program, or lost the machine."""
    progress: float
    """Completed part of the program, as time at an override of 1, in s."""
    settings: LoopSettings
    """Settings of the loop at the end of the run."""
    held: Mapping[int, HoldTally]
    """Reasons that limited the override, by workingstep number."""
    disturbances: tuple[str, ...] = ()
    """Disturbance words as requested."""
    seed: int = 0
    samples: int = 0
    """Number of samples written."""
    trace: BucketedRun | None = None
    """Signals for a report, if one was requested."""
    faults: tuple[str, ...] = ()
    """Reasons why some workingsteps were left out, or not planned."""
    loads: Loads = field(default_factory=dict)
    """Reference loads of earlier runs."""
    recorded: str = ""
    """File of the recorded run that was evaluated; empty: it ran."""
    ran_on: str = "virtual machine"
    """Machine that ran the program."""


Watcher = Callable[[LoopCycle, TrueState], None]
"""Callback that receives every cycle in addition to the loop: a trace or a dashboard."""


def control(
    request: ControlRequest,
    files: RunFiles,
    *,
    knowledge: str = "",
    tell: Tell = silent,
    watchers: Sequence[Watcher] = (),
) -> ControlRun:
    """Run a program under force control, or evaluate a recorded run; return the result.

    Raises
    ------
    StepNcError
        When a file, a name, a number or an output is invalid.
    """
    session = prepare(request, files, knowledge=knowledge, tell=tell)
    trace = session.trace()
    looking: tuple[Watcher, ...] = (trace, *watchers)
    ticker = Ticker(tell)
    try:
        with trace:
            for cycle in session.cycles(looking):
                for event in cycle.events:
                    tell(_event_line(event))
                ticker(lambda: _progress(session))
            if session.is_lost:
                tell(_event_line(session.events[-1]))
    finally:
        if trace.file is not None and trace.file.place is not None:
            tell(f"written: {trace.file.place} ({counted(trace.rows, 'row')})")
    return session.result(trace)


def prepare(
    request: ControlRequest,
    files: RunFiles,
    *,
    knowledge: str = "",
    tell: Tell = silent,
) -> "Session":
    """Prepare machine, loop and plan of a run, before its first cycle.

    Parameters
    ----------
    files : RunFiles
        A recorded run among them stands for the machine; the loop commands nothing then.
    knowledge : str
        Location of the knowledge base whose corrections apply; empty: the usual one.

    Raises
    ------
    StepNcError
        As :func:`control`.
    """
    require_bounds(request)
    signals = None
    if files.recorded is not None:
        from service.recording.table import read_signals  # noqa: PLC0415 (an extra)

        signals = read_signals(files.recorded)
        request = _evaluating(request, signals)
    law, settings = request.law, _settings(request)
    prepared, virtual = waiting_machine(_plain_run(request), files, tell=tell)
    tell_remarks(prepared.remarks, tell)
    if prepared.material is None or prepared.program is None:
        raise StepNcError("control needs a STEP-NC program: NC code states no cutting limits")
    found = disturbances(request.disturbances, hardness=hardness_against(prepared.material))
    plan = plan_as_it_is(
        prepared.program,
        virtual.machine,
        material=prepared.material,
        mode=Mode(request.mode.value),
        knowledge=knowledge if request.has_corrections else None,
        left_out=prepared.left_out if request.keep_going else None,
    )
    for each in plan.refused:
        tell(f"left as programmed: '{each.id}' ({each.ref}): {each.reason}")
    course = planned_course(prepared, virtual, tell)
    require_teeth(found.hidden, course)
    machine: LoopMachine
    if signals is not None:
        machine = RecordedMachine(course, signals)
    elif files.drive is not None:
        if found.bench != Instrumentation():
            raise StepNcError("--disturb: a real control has its own instruments")
        machine = files.drive.connect(course, found.hidden, virtual.machine)
    else:
        bench = _bench(found.bench, virtual.machine, request)
        machine = ControlledMachine(course, found.hidden, bench)
    planned = planned_steps(course)
    advices = advices_in_order(virtual.workingsteps, plan.advices)
    loads = read_loads(files.loads)
    taught = [
        None if each is None else loads.get(_key(virtual.machine, prepared.material, each))
        for each in advices
    ]
    steps, preview = steps_of(planned, advices, taught), preview_of(course)
    planned = with_hardest(planned, course, equivalent(preview, steps, settings).weight)
    loop = Loop(
        VirtualSensor(machine),
        machine,
        source=_source(request.sensor, virtual.machine, settings.chips),
        law=lambda plant: law_named(law, plant, has_preview=request.has_preview),
        steps=steps,
        preview=preview,
        settings=settings,
    )
    return Session(
        loop=loop,
        machine=machine,
        recorder=Recorder(settings.chips),
        holdings=HoldTallies(advices),
        workingsteps=tuple(virtual.workingsteps),
        orders=list(found.orders),
        request=request,
        files=files,
        law=law,
        program=prepared.program,
        plan=plan,
        advices=advices,
        planned=planned,
        loads=loads,
        findings=(*prepared.findings, *virtual.findings, *plan.findings),
        faults=(
            *map(str, prepared.faults),
            *(f"'{each.id}' ({each.ref}): {each.reason}" for each in plan.refused),
        ),
        virtual=virtual.machine,
    )


def _bench(
    bench: Instrumentation, machine: Machine, request: ControlRequest
) -> Instrumentation:
    """Return the bench of the run: the drive of its machine, its sensor and its seed."""
    return replace(
        bench,
        efficiency=machine.spindle.efficiency,
        has_normal=request.sensor is SensorChoice.COMPONENTS,
        seed=request.seed,
    )


def _evaluating(request: ControlRequest, signals: RecordedSignals) -> ControlRequest:
    """Return the request for a recorded run: no law, and a sensor that was recorded.

    Raises
    ------
    StepNcError
        When disturbances are requested.
    """
    if request.disturbances:
        raise StepNcError("--disturb: a recorded run is over; it cannot be disturbed")
    has_force = bool(np.isfinite(signals.force).any())
    sensor = request.sensor if has_force else SensorChoice.POWER
    return replace(request, law=LawName.NONE, sensor=sensor)


class VirtualSensor:
    """Machine as a sensor of the loop; a silent one counts as lost."""

    def __init__(self, machine: LoopMachine) -> None:
        self._machine = machine

    def read(self) -> Reading | None:
        """Return the next reading (:class:`controller.signals.ports.Sensor`)."""
        try:
            return self._machine.read()
        except MachineSilent as silent_:
            raise MachineLost(str(silent_)) from silent_


@dataclass(kw_only=True)
class Session:
    """Controlled run in progress: loop, machine, plan and records. Running state."""

    loop: Loop
    machine: LoopMachine
    recorder: Recorder
    holdings: HoldTallies
    workingsteps: tuple[str, ...]
    """Workingstep ids; the first has number 1."""
    orders: list[TimedOrder]
    request: ControlRequest
    files: RunFiles
    law: LawName
    program: Program
    plan: Plan
    advices: tuple[Advice | None, ...]
    planned: Mapping[int, PlannedWorkingstep]
    loads: Loads
    findings: tuple[Finding, ...]
    faults: tuple[str, ...]
    virtual: Machine
    events: list[LoopEvent] = field(default_factory=list)
    is_lost: bool = False
    """Whether the machine no longer answers."""

    def cycles(self, watchers: Sequence[Watcher] = ()) -> Iterator[LoopCycle]:
        """Run cycle by cycle, to the end or until the loop stops the program."""
        while True:
            while self.orders and self.orders[0].time <= self.machine.time:
                self.loop.order(self.orders.pop(0).order)
            try:
                cycle = self.loop.cycle()
            except MachineLost as lost:
                self._lose(lost)
                return
            if cycle is None:
                return
            self.recorder.add(cycle)
            self.holdings.add(cycle, self.loop.state.settings)
            self.events += cycle.events
            for watcher in watchers:
                watcher(cycle, self.machine.truth)
            yield cycle
            if self.loop.state.is_stopped and self.files.recorded is None:
                return

    def _lose(self, lost: MachineLost) -> None:
        """Record that the machine is lost; the last commanded override is the safe one."""
        override = 100.0 * self.machine.commanded
        text = f"{lost}; the last commanded override is {override:.4g} %"
        self.events.append(LoopEvent(time=self.machine.time, kind=EventKind.LOST, text=text))
        self.is_lost = True

    def trace(self, sink: Callable[[Moment], None] | None = None) -> ControlTrace:
        """Create the sink that writes the run to a file and keeps it for plots, as requested.

        Parameters
        ----------
        sink : callable, optional
            Callback that also receives each row.
        """
        output = self.files.output
        return ControlTrace(
            self.machine.course,
            self.holdings,
            workingsteps=self.workingsteps,
            file=None if output is None else RunFile(output, COLUMNS),
            has_trace=self.files.report is not None,
            sink=sink,
        )

    def result(self, trace: ControlTrace | None = None) -> ControlRun:
        """Return the result so far, including what a trace has kept."""
        records = self.recorder.records
        if isinstance(self.machine, RecordedMachine):
            least = FEWEST_SAMPLES * self.machine.interval
            for record in records.values():
                if record.cutting_time < least:
                    record.ratio = RatioEstimate()
        return ControlRun(
            program=self.program,
            machine=self.virtual,
            material=self.plan.material,
            law=self.law,
            has_preview=self.request.has_preview,
            criterion=self.loop.state.settings.criterion,
            plan=self.plan,
            steps=tuple(
                (self.advices[number - 1] if number else None, record)
                for number, record in records.items()
            ),
            planned=self.planned,
            loads=self.loads,
            events=tuple(self.events),
            findings=self.findings,
            faults=self.faults,
            time=self.machine.time,
            time_planned=self.machine.course.duration,
            is_stopped=(self.loop.state.is_stopped and self.files.recorded is None)
            or self.is_lost,
            progress=self.machine.share * self.machine.course.duration,
            settings=self.loop.state.settings,
            held=self.holdings.steps,
            disturbances=self.request.disturbances,
            seed=self.request.seed,
            samples=0 if trace is None else trace.rows,
            trace=None if trace is None else trace.trace(),
            ran_on="virtual machine" if self.files.drive is None else self.files.drive.name,
            recorded="" if self.files.recorded is None else self.files.recorded.name,
        )


def _key(machine: Machine, match: MaterialMatch, advice: Advice) -> CutKey:
    return key_of(machine.name, match.material.name, advice)


def _event_line(event: LoopEvent) -> str:
    return f"{event.time:9.2f} s  {event.kind.value}: {event.text}"


def _plain_run(request: ControlRequest) -> SimulationRequest:
    """Return a simulation request for the same program on the same machine."""
    return SimulationRequest(
        machine=request.machine,
        material=request.material,
        units=request.units,
        stock=request.stock,
        given=request.given,
        teeth=request.teeth,
        feed=request.feed,
        keep_going=request.keep_going,
        control=request.control,
        filter_s=request.filter_s,
        deviation_mm=request.deviation_mm,
    )


def _settings(request: ControlRequest) -> LoopSettings:
    least, set_point = CHIP_FORCES[request.sensor], request.force_set_point_n
    if set_point is not None and not set_point > least:
        bound = f"above {least:g} N, the noise of the {request.sensor}"
        raise StepNcError(f"force set point {set_point:g} N: it must be {bound}")
    return LoopSettings(
        criterion=request.mode,
        is_on=request.law is not LawName.NONE,
        set_point=set_point,
        band=OverrideBand(
            floor=0.01 * request.override_low_percent,
            ceiling=0.01 * request.override_high_percent,
        ),
        look_ahead=request.look_ahead if request.has_preview else 0,
        chips=least,
    )


def _source(sensor: SensorChoice, machine: Machine, chips: float) -> Source:
    if sensor is SensorChoice.POWER:
        return DrivePower(machine.spindle.efficiency, chips)
    return Dynamometer(chips)


def _progress(session: Session) -> str:
    machine, loop = session.machine, session.loop
    return (
        f"{bar(machine.share)}  {machine.time:.0f} s  override "
        f"{100.0 * loop.state.override:.0f} %  force {machine.truth.force:.0f} N"
    )
