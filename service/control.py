"""The verb ``control``: a program under the loop, on the virtual machine."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path

import numpy as np

from controller.aims import Aims, Step
from controller.cycle import Cycle
from controller.guard import Band
from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.orders import Criterion, Event
from controller.preview import LOOK_AHEAD, Preview
from controller.record import Record, Recorder
from controller.reference import Reference, reference_of
from controller.source import DrivePower, Dynamometer, Source
from optimiser.advice import Advice, Plan
from optimiser.formulate import Task
from optimiser.modes import Mode
from optimiser.optimise import optimise as advise
from optimiser.source import from_features
from service.disturbances import TimedOrder, disturbances
from service.progress import Patience, Ticker, bar
from service.reading import Tell, one_of, silent
from service.simulation import COMPILES, SimulationRequest, waiting_machine
from service.usecases import load_material_named
from simulator.machine.interpreter import interpret
from simulator.plant.controlled import ControlledMachine, Truth
from simulator.plant.course import NominalCourse, course_of
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.program import Program

REVOLUTIONS = 50
"""greatest look-ahead"""

CHIP = 0.1
"""mm, thickness of the chip for which materials are compared"""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlRun:
    """What ``control`` found."""

    program: str
    machine: Machine
    material: MaterialMatch
    law: LawName
    has_preview: bool
    criterion: Criterion
    plan: Plan
    """the program as it is, without any change"""
    steps: tuple[tuple[Advice | None, Record], ...]
    """in the order of their beginning; None: what belongs to no workingstep"""
    events: tuple[Event, ...]
    findings: tuple[Finding, ...]
    time: float
    """s"""
    time_planned: float
    """s at an override of 1"""
    is_stopped: bool
    """whether the loop stopped the program"""


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
    ticker = Ticker(tell)
    for cycle in session.cycles():
        for watcher in watchers:
            watcher(cycle, session.machine.truth)
        for event in cycle.events:
            tell(f"{event.time:9.2f} s  {event.kind.value}: {event.text}")
        ticker(lambda: _progress(session))
    return session.result()


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
    prepared, virtual = waiting_machine(request.simulation, tell=tell)
    if prepared.material is None or prepared.program is None:
        raise StepNcError("control needs a STEP-NC program: it says what may be forced")
    found = disturbances(request.disturbances, hardness=_hardness_against(prepared.material))
    plan = _plan(prepared.program, virtual.machine, prepared.material, criterion)
    with Patience(tell, COMPILES):
        course = course_of(
            virtual.run(interpret(prepared.blocks, virtual.machine)), virtual.machine
        )
    bench = replace(
        found.bench, efficiency=virtual.machine.spindle.efficiency, seed=request.seed
    )
    machine = ControlledMachine(course, found.hidden, bench)
    by_id = {advice.workingstep.id: advice for advice in plan.advices}
    advices = tuple(by_id.get(name) for name in virtual.workingsteps)
    loop = Loop(
        machine,
        machine,
        source=_source(request.sensor, virtual.machine),
        law=lambda plant: law_named(law, plant, has_preview=request.has_preview),
        steps=_steps(course, advices),
        preview=preview_of(course),
        aims=aims,
    )
    return Session(
        loop=loop,
        machine=machine,
        recorder=Recorder(aims.chips),
        orders=list(found.orders),
        request=request,
        law=law,
        plan=plan,
        advices=advices,
        findings=(*prepared.findings, *virtual.findings, *plan.findings),
        virtual=virtual.machine,
    )


@dataclass(kw_only=True)
class Session:
    """A program under control. Running state."""

    loop: Loop
    machine: ControlledMachine
    recorder: Recorder
    orders: list[TimedOrder]
    request: ControlRequest
    law: LawName
    plan: Plan
    advices: tuple[Advice | None, ...]
    findings: tuple[Finding, ...]
    virtual: Machine
    events: list[Event] = field(default_factory=list)

    def cycles(self) -> Iterator[Cycle]:
        """Run on, cycle by cycle, to the end or until the loop stops the program."""
        while True:
            while self.orders and self.orders[0].time <= self.machine.time:
                self.loop.order(self.orders.pop(0).order)
            cycle = self.loop.cycle()
            if cycle is None:
                return
            self.recorder.add(cycle)
            self.events += cycle.events
            yield cycle
            if self.loop.is_stopped:
                return

    def result(self) -> ControlRun:
        """What was found so far."""
        records = self.recorder.records
        return ControlRun(
            program=self.plan.program,
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
            events=tuple(self.events),
            findings=self.findings,
            time=self.machine.time,
            time_planned=self.machine.course.duration,
            is_stopped=self.loop.is_stopped,
        )


def preview_of(course: NominalCourse) -> Preview:
    """What the program expects: the force where the override acts."""
    force = np.where(course.can_override, course.force, np.float32(0.0))
    return Preview(until=course.until, force=force)


def _aims(request: ControlRequest, criterion: Criterion) -> Aims:
    floor, ceiling = request.band
    if not 0.0 < floor <= 100.0 <= ceiling <= 200.0:
        bound = "above 0 to 100, and 100 to 200"
        raise StepNcError(f"override band {floor:g} to {ceiling:g} %: it must be {bound}")
    if request.set_point is not None and not 0.0 < request.set_point < inf:
        raise StepNcError(f"force {request.set_point:g} N: it must be positive")
    if not 1 <= request.look_ahead <= REVOLUTIONS:
        bound = f"1 to {REVOLUTIONS} revolutions"
        raise StepNcError(f"look-ahead {request.look_ahead}: it must be {bound}")
    if request.sensor not in CHIP_FORCES:
        raise StepNcError(f"unknown sensor '{request.sensor}'; known: dynamometer, power")
    if request.seed < 0:
        raise StepNcError(f"seed {request.seed}: it must be at least 0")
    return Aims(
        criterion=criterion,
        is_on=request.law != LawName.NONE,
        set_point=request.set_point,
        band=Band(floor=0.01 * floor, ceiling=0.01 * ceiling),
        look_ahead=request.look_ahead if request.has_preview else 0,
        chips=CHIP_FORCES[request.sensor],
    )


def _hardness_against(match: MaterialMatch) -> Callable[[str], float]:
    """k_c of another material over that of the one that is cut, at a chip of 0.1 mm."""
    cut = match.material.kienzle

    def ratio(name: str) -> float:
        other = load_material_named(name).material.kienzle
        return float(other.k_c11 / cut.k_c11 * CHIP ** (cut.m_c - other.m_c))

    return ratio


def _plan(
    program: Program, machine: Machine, material: MaterialMatch, criterion: Criterion
) -> Plan:
    """What the limits say of the program as it is."""
    task = Task(mode=Mode(criterion.value), free=frozenset(), source=from_features)
    return advise(program, machine=machine, material=material, task=task)


def _source(sensor: str, machine: Machine) -> Source:
    return DrivePower(machine.spindle.efficiency) if sensor == "power" else Dynamometer()


def _steps(course: NominalCourse, advices: Sequence[Advice | None]) -> list[Step]:
    """Workingsteps with what the course knows of their cuts."""
    steps = []
    cuts = course.can_override & (course.force > 0.0)
    for number, advice in enumerate(advices, 1):
        if advice is None:
            reference = Reference(workingstep="", inhibition="nothing is known of it")
            steps.append(Step(reference=reference))
            continue
        rows = np.flatnonzero(cuts & (course.workingstep == number))
        reference = reference_of(advice)
        if not len(rows):
            steps.append(Step(reference=reference))
            continue
        steps.append(
            Step(
                reference=reference,
                tool=advice.tool.id,
                exponent=float(np.median(course.exponent[rows])),
                diameter=float(np.median(course.diameter[rows])),
            )
        )
    return steps


def _progress(session: Session) -> str:
    machine, loop = session.machine, session.loop
    return (
        f"{bar(machine.share)}  {machine.time:.0f} s  override "
        f"{100.0 * loop.override:.0f} %  force {machine.truth.force:.0f} N"
    )
