"""The verb ``control``: a program under the loop, on the virtual machine."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path

from controller.aims import Aims
from controller.cycle import Cycle
from controller.equivalent import equivalent
from controller.errors import MachineLost
from controller.guard import Band
from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.orders import Criterion, Event, EventKind
from controller.preview import LOOK_AHEAD
from controller.record import Record, Recorder
from controller.source import DrivePower, Dynamometer, Source
from optimiser.advice import Advice, Plan
from optimiser.modes import Mode
from service.buckets import Trace
from service.control.disturbances import TimedOrder, disturbances
from service.control.holding import Held, Holdings
from service.control.planned import Planned, planned_steps, with_hardest
from service.control.setup import (
    hardness_against,
    plan_as_it_is,
    planned_course,
    preview_of,
    require_teeth,
    steps_of,
)
from service.control.trace import ControlTrace, Moment, control_schema
from service.progress import Ticker, bar
from service.reading import Tell, one_of, silent
from service.run_file import RunFile
from service.simulation.run import SimulationRequest, waiting_machine
from simulator.errors import MachineSilent
from simulator.plant.controlled import ControlledMachine, Truth
from simulator.reading import Reading
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.program import Program

REVOLUTIONS = 50
"""greatest look-ahead"""

CHIP_FORCES = {"dynamometer": 10.0, "power": 60.0}
"""N above which there are chips: several times the noise of either"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRequest:
    """What the user asks of ``control``, in the user's units."""

    simulation: SimulationRequest
    """program, machine, material and how the control runs the path"""
    mode: str = Criterion.TC.value
    law: str = LawName.LOG_PI.value
    has_preview: bool = False
    look_ahead: int = LOOK_AHEAD
    disturbances: tuple[str, ...] = ()
    seed: int = 0
    set_point: float | None = None
    """N; None: the plan's bounds"""
    band: tuple[float, float] = (20.0, 120.0)
    """%, of the override"""
    sensor: str = "dynamometer"
    output: Path | None = None
    report: Path | None = None
    knowledge: str = ""
    """knowledge base: outcomes go there, accepted corrections come from there; that of the
    environment when empty, and where there is none neither happens"""
    recorded_by: str = ""
    """who; the login name when empty"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRun:
    """What ``control`` found."""

    program: Program
    machine: Machine
    material: MaterialMatch
    law: LawName
    has_preview: bool
    criterion: Criterion
    plan: Plan
    """the program as it is, without any change"""
    steps: tuple[tuple[Advice | None, Record], ...]
    """in the order of their beginning; None: what belongs to no workingstep"""
    planned: Mapping[int, Planned]
    """by the number of the workingstep"""
    events: tuple[Event, ...]
    findings: tuple[Finding, ...]
    time: float
    """s"""
    time_planned: float
    """s at an override of 1"""
    is_stopped: bool
    """whether the loop stopped the program, or lost the machine"""
    progress: float
    """s of the program at an override of 1 that are behind"""
    aims: Aims
    """at the end"""
    held: Mapping[int, Held]
    """what held the override, by the number of the workingstep"""
    disturbances: tuple[str, ...] = ()
    """as asked for"""
    seed: int = 0
    samples: int = 0
    """that were written"""
    trace: Trace | None = None
    """for a report, when one was asked for"""


Watcher = Callable[[Cycle, Truth], None]
"""who looks at the cycles besides the loop: a trace, a dashboard"""


def control(
    request: ControlRequest,
    *,
    tell: Tell = silent,
    watchers: Sequence[Watcher] = (),
) -> ControlRun:
    """Run a program under the loop.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names, numbers or output.
    """
    session = prepare(request, tell=tell)
    trace = session.trace()
    looking: tuple[Watcher, ...] = (trace, *watchers)
    ticker = Ticker(tell)
    try:
        with trace:
            for cycle in session.cycles(looking):
                for event in cycle.events:
                    tell(_told(event))
                ticker(lambda: _progress(session))
            if session.is_lost:
                tell(_told(session.events[-1]))
    finally:
        if trace.file is not None and trace.file.place is not None:
            tell(f"written: {trace.file.place} ({trace.rows} rows)")
    return session.result(trace)


def prepare(request: ControlRequest, *, tell: Tell = silent) -> "Session":
    """Everything plugged together, before the first cycle.

    Raises
    ------
    StepNcError
        As :func:`control`.
    """
    law = one_of(LawName, request.law, "law")
    criterion = one_of(Criterion, request.mode.upper(), "mode")
    aims = _aims(request, criterion)
    asked = replace(request.simulation, output=request.output, report=request.report)
    prepared, virtual = waiting_machine(asked, tell=tell)
    if prepared.material is None or prepared.program is None:
        raise StepNcError("control needs a STEP-NC program: it says what may be forced")
    found = disturbances(request.disturbances, hardness=hardness_against(prepared.material))
    plan = plan_as_it_is(
        prepared.program,
        virtual.machine,
        material=prepared.material,
        mode=Mode(criterion.value),
        knowledge=request.knowledge,
    )
    course = planned_course(prepared, virtual, tell)
    require_teeth(found.hidden, course)
    bench = replace(
        found.bench, efficiency=virtual.machine.spindle.efficiency, seed=request.seed
    )
    machine = ControlledMachine(course, found.hidden, bench)
    planned = planned_steps(course)
    by_id = {advice.workingstep.id: advice for advice in plan.advices}
    advices = tuple(by_id.get(name) for name in virtual.workingsteps)
    steps, preview = steps_of(planned, advices), preview_of(course)
    planned = with_hardest(planned, course, equivalent(preview, steps, aims).weight)
    loop = Loop(
        Line(machine),
        machine,
        source=_source(request.sensor, virtual.machine, aims.chips),
        law=lambda plant: law_named(law, plant, has_preview=request.has_preview),
        steps=steps,
        preview=preview,
        aims=aims,
    )
    return Session(
        loop=loop,
        machine=machine,
        recorder=Recorder(aims.chips),
        holdings=Holdings(advices),
        workingsteps=tuple(virtual.workingsteps),
        orders=list(found.orders),
        request=request,
        law=law,
        program=prepared.program,
        plan=plan,
        advices=advices,
        planned=planned,
        findings=(*prepared.findings, *virtual.findings, *plan.findings),
        virtual=virtual.machine,
    )


class Line:
    """The virtual machine as a sensor of the loop: its silence is the loop's loss."""

    def __init__(self, machine: ControlledMachine) -> None:
        self._machine = machine

    def read(self) -> Reading | None:
        """See :class:`controller.ports.Sensor`."""
        try:
            return self._machine.read()
        except MachineSilent as silent_:
            raise MachineLost(str(silent_)) from silent_


@dataclass(kw_only=True)
class Session:
    """A program under control. Running state."""

    loop: Loop
    machine: ControlledMachine
    recorder: Recorder
    holdings: Holdings
    workingsteps: tuple[str, ...]
    """ids by their number, from 1"""
    orders: list[TimedOrder]
    request: ControlRequest
    law: LawName
    program: Program
    plan: Plan
    advices: tuple[Advice | None, ...]
    planned: Mapping[int, Planned]
    findings: tuple[Finding, ...]
    virtual: Machine
    events: list[Event] = field(default_factory=list)
    is_lost: bool = False
    """whether the machine does not answer any more"""

    def cycles(self, watchers: Sequence[Watcher] = ()) -> Iterator[Cycle]:
        """Run on, cycle by cycle, to the end or until the loop stops the program."""
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
            self.holdings.add(cycle, self.loop.aims)
            self.events += cycle.events
            for watcher in watchers:
                watcher(cycle, self.machine.truth)
            yield cycle
            if self.loop.is_stopped:
                return

    def _lose(self, lost: MachineLost) -> None:
        """Nothing more can be done: what was commanded last is the safe override."""
        override = 100.0 * self.machine.commanded
        text = f"{lost}; override {override:.4g} % was commanded"
        self.events.append(Event(time=self.machine.time, kind=EventKind.LOST, text=text))
        self.is_lost = True

    def trace(self, sink: Callable[[Moment], None] | None = None) -> ControlTrace:
        """What writes the run to a file and keeps it for plots, as asked for.

        Parameters
        ----------
        sink : callable, optional
            Is given each row as well.
        """
        output = self.request.output
        return ControlTrace(
            self.machine.course,
            self.holdings,
            workingsteps=self.workingsteps,
            file=None if output is None else RunFile(output, control_schema()),
            has_trace=self.request.report is not None,
            sink=sink,
        )

    def result(self, trace: ControlTrace | None = None) -> ControlRun:
        """What was found so far, and what a trace has kept of it."""
        records = self.recorder.records
        return ControlRun(
            program=self.program,
            machine=self.virtual,
            material=self.plan.material,
            law=self.law,
            has_preview=self.request.has_preview,
            criterion=self.loop.aims.criterion,
            plan=self.plan,
            steps=tuple(
                (self.advices[number - 1] if number else None, record)
                for number, record in records.items()
            ),
            planned=self.planned,
            events=tuple(self.events),
            findings=self.findings,
            time=self.machine.time,
            time_planned=self.machine.course.duration,
            is_stopped=self.loop.is_stopped or self.is_lost,
            progress=self.machine.share * self.machine.course.duration,
            aims=self.loop.aims,
            held=self.holdings.steps,
            disturbances=self.request.disturbances,
            seed=self.request.seed,
            samples=0 if trace is None else trace.rows,
            trace=None if trace is None else trace.trace(),
        )


def _told(event: Event) -> str:
    return f"{event.time:9.2f} s  {event.kind.value}: {event.text}"


def _aims(request: ControlRequest, criterion: Criterion) -> Aims:
    floor, ceiling = request.band
    if not 0.0 < floor <= 100.0 <= ceiling <= 200.0:
        bound = "above 0 to 100, and 100 to 200"
        raise StepNcError(f"override band {floor:g} to {ceiling:g} %: it must be {bound}")
    if not 1 <= request.look_ahead <= REVOLUTIONS:
        bound = f"1 to {REVOLUTIONS} revolutions"
        raise StepNcError(f"look-ahead {request.look_ahead}: it must be {bound}")
    if request.sensor not in CHIP_FORCES:
        raise StepNcError(f"unknown sensor '{request.sensor}'; known: dynamometer, power")
    if request.seed < 0:
        raise StepNcError(f"seed {request.seed}: it must be at least 0")
    least = CHIP_FORCES[request.sensor]
    if request.set_point is not None and not least < request.set_point < inf:
        bound = f"above {least:g} N, which is noise of the {request.sensor}"
        raise StepNcError(f"force {request.set_point:g} N: it must be {bound}")
    return Aims(
        criterion=criterion,
        is_on=request.law != LawName.NONE,
        set_point=request.set_point,
        band=Band(floor=0.01 * floor, ceiling=0.01 * ceiling),
        look_ahead=request.look_ahead if request.has_preview else 0,
        chips=CHIP_FORCES[request.sensor],
    )


def _source(sensor: str, machine: Machine, chips: float) -> Source:
    if sensor == "power":
        return DrivePower(machine.spindle.efficiency, chips)
    return Dynamometer(chips)


def _progress(session: Session) -> str:
    machine, loop = session.machine, session.loop
    return (
        f"{bar(machine.share)}  {machine.time:.0f} s  override "
        f"{100.0 * loop.override:.0f} %  force {machine.truth.force:.0f} N"
    )
