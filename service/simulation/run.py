"""Run of a program on the virtual machine, for the command ``simulate``.

Stock that a run leaves: whether a tool touched it, and the file that keeps it.
"""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from service.files import require_places, write_atomically
from service.inputs.numbers import numbers_in
from service.outputs.run_file import require_suffix
from service.plots.buckets import BucketedRun
from service.programs.machine_choice import require_axes
from service.programs.raw_stock import file_of_stock
from service.programs.remarks import tell_remarks
from service.progress import Tell, Ticker, bar, silent
from service.requests.fields import require_bounds
from service.requests.program_facts import KEPT_SUFFIX, RawPart
from service.requests.runs import ForceView, SimulationRequest
from service.simulation.code_simulation import CodeRequest, from_code
from service.simulation.placement import in_guessed_stock
from service.simulation.run_collector import (
    RunCollector,
    SampleWatcher,
    TimelineFile,
    TraceKeeper,
)
from service.simulation.setup import PreparedRun, from_program, prepared_program
from simulator.errors import SimulationError
from simulator.machine.deviation import SeededDeviation
from simulator.machine.disturbance import Disturbance
from simulator.machine.interpreter import interpret
from simulator.machine.tooth_loads import ToothOptions
from simulator.machine.totals import Total
from simulator.machine.transients import Response
from simulator.machine.travel import Zero, zero_of
from simulator.machine.virtual import LoadedTool, MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import ControlModel, axis_limits
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stock_file import stock_bytes
from simulator.spec import Machine, MaterialMatch
from simulator.tool_files.read import ToolLibrary
from stepnc_model.errors import Finding, SchemaError, Severity, StepNcError, WriteError
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program
from stepnc_model.units import mm_from_um

if TYPE_CHECKING:
    from service.simulation.drive import Drive

TRACE = 0.1
"""Volume that counts as none, mm³: edges of a stock that was cut before are known to a cell."""


def keep_stock(virtual: VirtualMachine, path: Path) -> None:
    """Write the stock that was clamped last, as it is now.

    Raises
    ------
    StepNcError
        When no stock was clamped, or the file cannot be written.
    """
    kept = [each for each in virtual.stocks if isinstance(each, MillingStock | TurningStock)]
    if not kept:
        raise StepNcError(f"{path}: no stock was clamped that could be kept")
    write_atomically(path, stock_bytes(kept[-1]))


def untouched(
    prepared: PreparedRun, virtual: VirtualMachine, run: RunCollector
) -> tuple[Finding, ...]:
    """Finding that no feed move of the run met the stock; none if one did."""
    raw, reach = prepared.raw, virtual.reach
    if raw is None or prepared.tools is None or reach is None:
        return ()
    if sum(total.volume for total in run.totals) > TRACE:
        return ()
    low, high = reach[0].tolist(), reach[1].tolist()
    is_apart = any(
        one > end or begin > other
        for begin, end, one, other in zip(raw.low, raw.high, low, high, strict=True)
    )
    text = (
        f"no tool touched the stock, which spans {_box(raw.low, raw.high)}; the feed moves "
        f"span {_box(low, high)}: "
        f"{'is it in coordinates of the program?' if is_apart else 'is it cut already?'}"
    )
    return (Finding(severity=Severity.WARNING, message=text),)


def _box(low: tuple[float, ...] | list[float], high: tuple[float, ...] | list[float]) -> str:
    """Span on each axis, for a message."""
    spans = zip("xyz", low, high, strict=True)
    return ", ".join(f"{axis} {one:g} to {other:g}" for axis, one, other in spans) + " mm"


LEAST_FILTER, MOST_FILTER = 1e-6, 100.0
"""Bounds of the filter times, in s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunFiles:
    """Files that a run on the virtual machine reads and writes."""

    file: Path | None = None
    name: str = ""
    """Name of the program; empty: the name of its file."""
    tools: ToolLibrary | None = None
    """Tools of which the program may have nothing but the name."""
    code: CodeRequest | None = None
    """NC code to run instead of the program's own paths."""
    output: Path | None = None
    report: Path | None = None
    kept: Path | None = None
    """File for the stock that the run leaves, which a later run can take."""
    recorded: Path | None = None
    """Recorded run of the program that ``control`` evaluates instead of running it."""
    drive: "Drive | None" = None
    """Control that runs the program under ``control`` in place of the virtual machine."""
    loads: Path | None = None
    """File of reference loads, which ``control`` reads and adds to."""
    is_teaching: bool = False
    """Whether the run teaches loads that the file has already."""
    cut_log: Path | None = None
    """File for the log of the cuts of ``control``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """Result of ``simulate``."""

    program: str
    machine: Machine
    control: ControlModelName
    material: MaterialMatch | None = None
    """Matched workpiece material; None if it is unknown."""
    totals: tuple[tuple[str, Total], ...]
    """Totals by workingstep in order of execution; the first is for the time before them."""
    findings: tuple[Finding, ...]
    reported: tuple[Finding, ...] = ()
    """Those of the findings that were told while it ran."""
    collisions: tuple[Finding, ...] = ()
    """Those of the findings that tell of rapids through material."""
    samples: int = 0
    """Number of samples written."""
    tools: Mapping[int, LoadedTool] = field(default_factory=dict)
    """Tools by number."""
    trace: BucketedRun | None = None
    """Signals for a report, if one was requested."""
    deviation: SeededDeviation | None = None
    """Random deviation of motor powers, if one was requested."""
    faults: tuple[SchemaError, ...] = ()
    """Reasons why some workingsteps were left out."""

    @property
    def whole(self) -> Total:
        """Totals of the whole run."""
        total = Total()
        for _, part in self.totals:
            total = total.plus(part)
        return total


def simulate(
    request: SimulationRequest,
    files: RunFiles,
    *,
    tell: Tell = silent,
    watchers: Sequence[SampleWatcher] = (),
) -> Simulation:
    """Simulate a program on the virtual machine and return its totals.

    Raises
    ------
    StepNcError
        When a file, a name, a number or an output is invalid.
    """
    prepared, virtual = waiting_machine(request, files, tell=tell)
    tell_remarks(prepared.remarks, tell)
    if files.kept is not None and prepared.raw is None:
        raise StepNcError(
            f"{files.kept}: no stock is known that could be kept: name one with --stock"
        )
    disturbance = _disturbance(request, virtual.machine)
    run = RunCollector(virtual, disturbance, rate=request.rate_hz, watchers=watchers)
    if files.report is not None:
        run.trace = TraceKeeper()
    if files.output is not None:
        run.file = TimelineFile(files.output, virtual.workingsteps, program=prepared.name)
    try:
        _run(prepared, virtual, run, tell=tell)
    finally:
        if run.file is not None and run.file.place is not None:
            tell(f"written: {run.file.place} ({counted(run.file.rows, 'sample')})")
    if files.kept is not None:
        keep_stock(virtual, files.kept)
        tell(f"written: {files.kept} (remaining stock, in coordinates of its setup)")
    met = tuple(virtual.findings)
    if prepared.is_stock_guessed:
        faults = [each for each in met if each.severity is Severity.ERROR]
        met = (*(each for each in met if each not in faults), *in_guessed_stock(faults))
    return Simulation(
        program=prepared.name,
        machine=virtual.machine,
        control=request.control,
        material=prepared.material,
        totals=tuple(zip(("", *virtual.workingsteps), run.totals, strict=True)),
        findings=(
            *prepared.findings,
            *(each for each in prepared.remarks if each not in prepared.findings),
            *met,
            *untouched(prepared, virtual, run),
        ),
        reported=prepared.remarks,
        collisions=tuple(each for each in met if each.severity is Severity.ERROR),
        tools=virtual.setup.tools or {},
        samples=0 if run.file is None else run.file.rows,
        trace=None if run.trace is None else run.trace.trace(),
        deviation=_deviation(request, virtual.machine),
        faults=prepared.faults,
    )


def run_of_program(
    program: Program, machine: Machine, material: MaterialMatch, *, tell: Tell = silent
) -> tuple[tuple[str, Total], ...]:
    """Return the totals of a program that was read, by workingstep in order of execution.

    Raises
    ------
    StepNcError
        When the machine cannot run the program.
    """
    prepared = prepared_program(program, machine, material, tell=tell)
    virtual = machine_of(SimulationRequest(), prepared)
    run = RunCollector(virtual, Disturbance(), rate=1.0, watchers=())
    _run(prepared, virtual, run, tell=tell)
    return tuple(zip(virtual.workingsteps, run.totals[1:], strict=True))


def waiting_machine(
    request: SimulationRequest, files: RunFiles, *, tell: Tell = silent
) -> tuple[PreparedRun, VirtualMachine]:
    """Prepare a program, and the machine that will run it.

    Raises
    ------
    StepNcError
        When :func:`simulate` would raise it.
    """
    require_bounds(request)
    _require_files(files, request.stock)
    teeth = _teeth(request)
    prepared = _prepared(request, files, tell)
    return prepared, machine_of(request, prepared, teeth=teeth)


def _run(
    prepared: PreparedRun, virtual: VirtualMachine, run: RunCollector, *, tell: Tell
) -> None:
    """Run the program to its end, and report progress."""
    ticker = Ticker(tell)
    try:
        with run.file or nullcontext():
            for episode in virtual.run(interpret(prepared.blocks, virtual.machine)):
                run.add(
                    episode, ticked=lambda: ticker(lambda: _progress(prepared, virtual, run))
                )
    except SimulationError as error:
        raise SimulationError(f"{place_in(prepared, virtual)}: {error}") from error


def _progress(prepared: PreparedRun, virtual: VirtualMachine, run: RunCollector) -> str:
    """Return a progress message with the share of the program that has been run."""
    at = virtual.workingsteps[-1:]
    share = prepared.done() * min(run.block / max(prepared.read(), 1), 1.0)
    # The amount left to read is an estimate: the share must never decrease.
    run.share = max(run.share, share)
    return ", ".join((f"{bar(run.share)}  {virtual.now:.0f} s of machining", *at))


def place_in(prepared: PreparedRun, virtual: VirtualMachine) -> str:
    """Return the place of a fault; only lines of NC code are known to the user."""
    at = virtual.workingsteps[-1:]
    return ": ".join((prepared.name, *(f"workingstep '{name}'" for name in at)))


def _prepared(request: SimulationRequest, files: RunFiles, tell: Tell) -> PreparedRun:
    if files.code is not None:
        return from_code(files.code, request, program=files.file, keep_going=request.keep_going)
    if files.file is None:
        raise StepNcError("name a STEP-NC program, or NC code with --nc")
    return from_program(
        files.file,
        request,
        name=files.name,
        tools=files.tools,
        keep_going=request.keep_going,
        tell=tell,
    )


def machine_of(
    request: SimulationRequest, prepared: PreparedRun, *, teeth: ToothOptions | None = None
) -> VirtualMachine:
    """Build the machine of a prepared program, ready to run it.

    Raises
    ------
    StepNcError
        When axes, control or zero are unknown or invalid.
    """
    require_axes(prepared.machine)
    return VirtualMachine(
        MachineSetup(
            machine=prepared.machine,
            control=_control(request, prepared.machine),
            tools=_tools(request, prepared),
            stock=prepared.stock,
            teeth=teeth,
            zero=_zero(request.zero, prepared),
            deviation=_deviation(request, prepared.machine),
        )
    )


def _require_files(files: RunFiles, stock: RawPart) -> None:
    """Refuse invalid combinations of files before anything is read."""
    code = files.code
    if code is not None and files.file is not None and (code.tools or code.stock):
        raise StepNcError("the program defines tools and stock; omit --tools and --stock")
    if files.output is not None:
        require_suffix(files.output)
    inputs = [files.file]
    if code is not None:
        inputs += [code.code, code.tools, file_of_stock(code.stock)]
    if stock:
        inputs.append(file_of_stock(stock))
    if files.kept is not None and files.kept.suffix.lower() != KEPT_SUFFIX:
        raise WriteError(f"must end with {KEPT_SUFFIX}", path=str(files.kept))
    outputs = [files.output, files.report, files.kept]
    require_places(outputs, apart_from=inputs)
    for place in outputs:
        if place is not None and place.exists() and not place.is_file():
            raise WriteError("is not a regular file", path=str(place))


def _control(request: SimulationRequest, machine: Machine) -> ControlModel:
    """Return the requested control model, with its parameters."""
    kind = request.control
    if not request.filter_s:
        return _by_axes(kind, machine, deviation=request.deviation_mm)
    if kind is not ControlModelName.FIR:
        raise StepNcError(f"control {kind.value}: filter times are only for the control fir")
    first, second = numbers_in(request.filter_s, "filter times", counts=(2,))
    if not LEAST_FILTER <= second <= first <= MOST_FILTER:
        bound = f"{LEAST_FILTER:g} to {MOST_FILTER:g} s, the longer one first"
        raise StepNcError(f"filter times {first:g} and {second:g} s: must be {bound}")
    return FixedTimeFilter(first=first, second=second)


def _by_axes(kind: ControlModelName, machine: Machine, *, deviation: float) -> ControlModel:
    """Return a control model with parameters from the limits of the axes."""
    try:
        return control_model(
            kind, axis_limits(machine), deviation=deviation, planner=machine.planner
        )
    except ValueError as error:
        raise StepNcError(f"machine '{machine.name}', control {kind.value}: {error}") from error


def _tools(request: SimulationRequest, prepared: PreparedRun) -> dict[int, LoadedTool] | None:
    """Return the tools with the requested wear and k_c factor."""
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


def _teeth(request: SimulationRequest) -> ToothOptions | None:
    if request.force is ForceView.MEAN:
        if request.runout_um:
            raise StepNcError("runout needs forces of each tooth: add --force tooth")
        return None
    return ToothOptions(eccentricity=mm_from_um(request.runout_um))


def _disturbance(request: SimulationRequest, machine: Machine) -> Disturbance:
    """Return the disturbance of the readings, with the delay of the main drive if known."""
    delay = machine.spindle.delay
    response = Response() if delay is None else Response(delay=delay)
    return Disturbance(
        noise=request.noise,
        missing=request.missing,
        response=response if request.has_lag else None,
        seed=request.seed,
    )


def _deviation(request: SimulationRequest, machine: Machine) -> SeededDeviation | None:
    """Return the deviation of motor powers, if requested."""
    if not request.has_power_deviation:
        return None
    if machine.deviation is None:
        raise StepNcError(
            f"machine '{machine.name}' states no power deviation: omit --power-deviation, or "
            "add a [deviation] table to its file"
        )
    return SeededDeviation(deviation=machine.deviation, seed=request.seed)


def _zero(text: str, prepared: PreparedRun) -> Zero | None:
    """Return the position of the program's zero: as requested, or by the stock."""
    if not text:
        return None if prepared.raw is None else zero_of(prepared.machine, prepared.raw)
    x, y, z = numbers_in(text, "zero", counts=(3,))
    return x, y, z
