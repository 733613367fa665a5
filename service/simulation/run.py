"""The verb ``simulate``: a program on the virtual machine."""

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from service.buckets import Trace
from service.chosen import require_axes
from service.files import require_place
from service.numbers import numbers_in
from service.progress import Ticker, bar
from service.reading import Tell, one_of, silent
from service.run_file import require_suffix
from service.simulation.gathering import Gathering, Watcher
from service.simulation.setup import (
    CodeRequest,
    Prepared,
    from_code,
    from_program,
    prepared_program,
)
from service.simulation.timeline_file import TimelineFile
from service.simulation.trace import TraceKeeper
from simulator.errors import SimulationError
from simulator.machine.disturbance import Disturbance, NoiseKind
from simulator.machine.interpreter import interpret
from simulator.machine.tooth_loads import Teeth
from simulator.machine.totals import Total
from simulator.machine.transients import Response
from simulator.machine.travel import Zero, zero_of
from simulator.machine.virtual import LoadedTool, Setup, VirtualMachine
from simulator.motion.control import DEVIATION, Control, control_model
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.motion import ControlModel, axis_limits
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding, StepNcError, WriteError
from stepnc_model.program import Program
from stepnc_model.units import mm_from_um

MOST_FACTOR = 100.0
"""on k_c; more is a slip"""

MOST_RATE = 10_000.0
"""1/s"""

MOST_RUNOUT_UM = 500.0

MOST_DEVIATION = 10.0
"""mm, of the junctions"""

LEAST_FILTER, MOST_FILTER = 1e-6, 100.0
"""s"""


class ForceView(StrEnum):
    """How forces are shown."""

    MEAN = "mean"
    """over a revolution"""
    TOOTH = "tooth"
    """of the teeth that cut at each time"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRequest:
    """What the user asks of ``simulate``, in the user's units."""

    file: Path | None = None
    name: str = ""
    """what the program is called; as its file when empty"""
    code: CodeRequest | None = None
    machine: str = ""
    material: str = ""
    units: str = "iso"
    rate: float = 10.0
    control: str = Control.FIR.value
    filter_s: str = ""
    """times of the fixed-time filter, "T1,T2"; by the axes when empty"""
    deviation: float = DEVIATION
    """mm, of the junctions"""
    zero: str = ""
    noise: str = NoiseKind.NONE.value
    missing: float = 0.0
    has_lag: bool = False
    """the main drive answers late and too far"""
    has_wear: bool = False
    """tools wear while they cut"""
    force: str = ForceView.MEAN.value
    runout_um: float = 0.0
    kc_factor: float = 1.0
    """on the specific cutting force"""
    seed: int = 0
    output: Path | None = None
    report: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """What ``simulate`` found."""

    program: str
    machine: Machine
    control: Control
    material: MaterialMatch | None = None
    """None: not known"""
    totals: tuple[tuple[str, Total], ...]
    """by workingstep in the order of their beginning; the first is what comes before them"""
    findings: tuple[Finding, ...]
    samples: int = 0
    """that were written"""
    trace: Trace | None = None
    """for a report, when one was asked for"""

    @property
    def whole(self) -> Total:
        """Of the whole run."""
        total = Total()
        for _, part in self.totals:
            total = total.plus(part)
        return total


def simulate(
    request: SimulationRequest, *, tell: Tell = silent, watchers: Sequence[Watcher] = ()
) -> Simulation:
    """Run a program on the virtual machine.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names, numbers or output.
    """
    kind, disturbance = _control_kind(request), _disturbance(request)
    prepared, virtual = waiting_machine(request, tell=tell)
    disturbance = _of_machine(disturbance, virtual.machine)
    run = Gathering(virtual, disturbance, rate=request.rate, watchers=watchers)
    if request.report is not None:
        run.trace = TraceKeeper()
    if request.output is not None:
        run.file = TimelineFile(request.output, virtual.workingsteps, program=prepared.name)
    try:
        _run(prepared, virtual, run, tell=tell)
    finally:
        if run.file is not None and run.file.place is not None:
            tell(f"written: {run.file.place} ({run.file.rows} samples)")
    return Simulation(
        program=prepared.name,
        machine=virtual.machine,
        control=kind,
        material=prepared.material,
        totals=tuple(zip(("", *virtual.workingsteps), run.totals, strict=True)),
        findings=(*prepared.findings, *virtual.findings),
        samples=0 if run.file is None else run.file.rows,
        trace=None if run.trace is None else run.trace.trace(),
    )


def run_of_program(
    program: Program, machine: Machine, material: MaterialMatch, *, tell: Tell = silent
) -> tuple[tuple[str, Total], ...]:
    """Totals of a program that was read, by workingstep in the order of their beginning.

    Raises
    ------
    StepNcError
        When the machine cannot run it.
    """
    prepared = prepared_program(program, machine, material, tell=tell)
    virtual = _machine(SimulationRequest(), prepared, teeth=None)
    run = Gathering(virtual, Disturbance(), rate=1.0, watchers=())
    _run(prepared, virtual, run, tell=tell)
    return tuple(zip(virtual.workingsteps, run.totals[1:], strict=True))


def waiting_machine(
    request: SimulationRequest, *, tell: Tell = silent
) -> tuple[Prepared, VirtualMachine]:
    """A program and the machine that waits for it.

    Raises
    ------
    StepNcError
        As :func:`simulate`.
    """
    _require(request)
    teeth = _teeth(request)
    prepared = _prepared(request, tell)
    return prepared, _machine(request, prepared, teeth=teeth)


def _run(prepared: Prepared, virtual: VirtualMachine, run: Gathering, *, tell: Tell) -> None:
    """Run to the end, told of where it is."""
    ticker = Ticker(tell)
    try:
        with run.file or nullcontext():
            for episode in virtual.run(interpret(prepared.blocks, virtual.machine)):
                run.add(
                    episode, ticked=lambda: ticker(lambda: _progress(prepared, virtual, run))
                )
    except SimulationError as error:
        raise SimulationError(f"{place_in(prepared, virtual)}: {error}") from error


def _progress(prepared: Prepared, virtual: VirtualMachine, run: Gathering) -> str:
    """Of what was read the part that has run: a whole stretch is read before it runs."""
    at = virtual.workingsteps[-1:]
    share = prepared.done() * min(run.block / max(prepared.read(), 1), 1.0)
    # How much there is to read is an estimate: no way back when there is more.
    run.share = max(run.share, share)
    return ", ".join((f"{bar(run.share)}  {virtual.now:.0f} s of machining", *at))


def place_in(prepared: Prepared, virtual: VirtualMachine) -> str:
    """Where a fault lies: the lines of NC code are known to the user, those of blocks not."""
    at = virtual.workingsteps[-1:]
    return ": ".join((prepared.name, *(f"workingstep '{name}'" for name in at)))


def _prepared(request: SimulationRequest, tell: Tell) -> Prepared:
    if request.code is not None:
        return from_code(
            request.code,
            program=request.file,
            units=request.units,
            machine=request.machine,
            material=request.material,
        )
    if request.file is None:
        raise StepNcError("name a STEP-NC program, or NC code with --nc")
    return from_program(
        request.file,
        name=request.name,
        units=request.units,
        machine=request.machine,
        material=request.material,
        tell=tell,
    )


def _machine(
    request: SimulationRequest, prepared: Prepared, *, teeth: Teeth | None
) -> VirtualMachine:
    """The machine as it waits for the program."""
    require_axes(prepared.machine)
    return VirtualMachine(
        Setup(
            machine=prepared.machine,
            control=_control(request, prepared.machine),
            tools=_tools(request, prepared),
            stock=prepared.stock,
            teeth=teeth,
            zero=_zero(request.zero, prepared),
        )
    )


def _require(request: SimulationRequest) -> None:
    """Refuse what cannot be, before anything is read."""
    if not 1.0 <= request.rate <= MOST_RATE:
        raise StepNcError(f"rate {request.rate:g} Hz: it must be 1 to {MOST_RATE:g} Hz")
    code = request.code
    if code is not None and request.file is not None and (code.tools or code.stock):
        raise StepNcError("tools and stock are those of the program: name no others")
    if request.output is not None:
        require_suffix(request.output)
    inputs = [request.file, *((code.code, code.tools) if code else ())]
    outputs = [request.output, request.report]
    for row, place in enumerate(outputs):
        if place is None:
            continue
        for other in (*inputs, *outputs[:row]):
            if other is not None:
                require_place(place, apart_from=other)
        if place.exists() and not place.is_file():
            raise WriteError("is no regular file", path=str(place))


def _control_kind(request: SimulationRequest) -> Control:
    return one_of(Control, request.control, "control")


def _control(request: SimulationRequest, machine: Machine) -> ControlModel:
    """How the control runs the path."""
    kind = _control_kind(request)
    if not 0.0 < request.deviation <= MOST_DEVIATION:
        bound = f"it must be above 0, at most {MOST_DEVIATION:g} mm"
        raise StepNcError(f"deviation {request.deviation:g} mm: {bound}")
    if not request.filter_s:
        return _by_axes(kind, machine, deviation=request.deviation)
    if kind is not Control.FIR:
        raise StepNcError(f"control {kind.value}: filter times are for the control fir")
    first, second = numbers_in(request.filter_s, "filter times", counts=(2,))
    if not LEAST_FILTER <= second <= first <= MOST_FILTER:
        bound = f"{LEAST_FILTER:g} to {MOST_FILTER:g} s, the longer first"
        raise StepNcError(f"filter times {first:g} and {second:g} s: {bound}")
    return FixedTimeFilter(first=first, second=second)


def _by_axes(kind: Control, machine: Machine, *, deviation: float) -> ControlModel:
    """The control that suits the axes."""
    try:
        return control_model(kind, axis_limits(machine), deviation=deviation)
    except ValueError as error:
        raise StepNcError(f"machine '{machine.name}', control {kind.value}: {error}") from error


def _tools(request: SimulationRequest, prepared: Prepared) -> dict[int, LoadedTool] | None:
    """The tools as asked for: they wear or not, the material is harder or not."""
    if not 0.0 < request.kc_factor <= MOST_FACTOR:
        bound = f"it must be positive, {MOST_FACTOR:g} at most"
        raise StepNcError(f"factor on k_c {request.kc_factor:g}: {bound}")
    if prepared.tools is None:
        return None
    return {
        number: replace(
            tool,
            taylor=tool.taylor if request.has_wear else None,
            edge=replace(tool.edge, factor=request.kc_factor * tool.edge.factor),
        )
        for number, tool in prepared.tools.items()
    }


def _teeth(request: SimulationRequest) -> Teeth | None:
    view = one_of(ForceView, request.force, "force")
    if not 0.0 <= request.runout_um <= MOST_RUNOUT_UM:
        bound = f"0 to {MOST_RUNOUT_UM:g} µm"
        raise StepNcError(f"runout {request.runout_um:g} µm: it must be {bound}")
    if view is ForceView.MEAN:
        if request.runout_um:
            raise StepNcError("runout shows in forces tooth by tooth: --force tooth")
        return None
    return Teeth(eccentricity=mm_from_um(request.runout_um))


def _disturbance(request: SimulationRequest) -> Disturbance:
    if not 0.0 <= request.missing < 1.0:
        raise StepNcError(f"missing {request.missing:g}: it must be at least 0 and below 1")
    if request.seed < 0:
        raise StepNcError(f"seed {request.seed}: it must be at least 0")
    return Disturbance(
        noise=one_of(NoiseKind, request.noise, "noise"),
        missing=request.missing,
        response=Response() if request.has_lag else None,
        seed=request.seed,
    )


def _of_machine(disturbance: Disturbance, machine: Machine) -> Disturbance:
    """The disturbance with the delay of a machine's own drive, where it is known."""
    delay = machine.spindle.delay
    if disturbance.response is None or delay is None:
        return disturbance
    return replace(disturbance, response=Response(delay=delay))


def _zero(text: str, prepared: Prepared) -> Zero | None:
    """Place of the program's zero: as the user says, or by the stock."""
    if not text:
        return None if prepared.raw is None else zero_of(prepared.machine, prepared.raw)
    x, y, z = numbers_in(text, "zero", counts=(3,))
    return x, y, z
