"""One function per verb. Packages meet here; the command line and REST are skins over it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from optimiser.advice import Plan, Status
from optimiser.formulate import Task
from optimiser.modes import Free, Mode
from optimiser.optimise import optimise as advise
from optimiser.safety import USUAL_QUANTILE, require_quantile
from optimiser.source import along_paths
from service.chosen import machine_for, material_for, require_axes, with_holding
from service.files import (
    beside,
    is_same,
    require_place,
    write_atomically,
    write_lines,
)
from service.knowledge.corrected import factors_for, finding_of, with_corrections
from service.knowledge.place import named_place, require_apart
from service.progress import Progress
from service.reading import Tell, one_of, read_program, silent
from service.records import changes_of
from simulator.spec import Certainty, Machine, MaterialMatch
from stepnc_model import writeback
from stepnc_model.errors import Finding, SchemaError, Severity, StepNcError, WriteError
from stepnc_model.part21.reader import Part21File
from stepnc_model.plausibility import refusal
from stepnc_model.program import Program, Workingstep
from stepnc_model.toolpath.job import stock_of
from stepnc_model.units import mm_from_um
from stepnc_model.writeback import Profile

if TYPE_CHECKING:
    from service.confirmation import Confirmation
    from simulator.tool_table import TableTool

NOTHING_WRITTEN = "nothing was written: no workingstep was advised"


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What the user asks of ``optimise``, in the user's units."""

    file: Path
    name: str = ""
    """what the program is called; as its file when empty"""
    mode: str = "TC"
    machine: str = ""
    material: str = ""
    units: str = "iso"
    roughness_um: float | None = None
    free: str = "feed,depth"
    profile: str = "optimisation"
    output: Path | None = None
    in_place: bool = False
    workingsteps: tuple[str, ...] = ()
    pareto: bool = False
    tool_change: float = 0.0
    dry_run: bool = False
    report: Path | None = None
    control: str = ""
    """for which NC code is written too; none when empty"""
    knowledge: str = ""
    """knowledge base with accepted corrections; that of the environment when empty"""
    confirm: bool = False
    """whether the virtual machine runs the advised program"""
    stock: str = ""
    """raw part of a file that draws none, in mm: ``x0,y0,z0,x1,y1,z1`` or ``diameter,z0,z1``"""
    holding: Path | None = None
    """how the workpiece is held, instead of what the machine's file says"""
    safety: float = USUAL_QUANTILE
    """quantile of k_c at which loads keep their bounds"""
    tools: Path | None = None
    """tool table that says which of the program's tools cut over centre or have wipers"""
    centre_cutting: Mapping[str, bool] = field(default_factory=dict, hash=False)
    """the same without a table; the table goes first"""
    allow_plunge: bool = False
    """whether tools that do not cut over centre may go straight down into the solid"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What ``optimise`` did."""

    plan: Plan
    written: Path | None
    """the STEP-NC file, or None when nothing was written"""
    confirmation: "Confirmation | None" = None
    """None: not asked for"""


def optimise(request: Request, *, tell: Tell = silent) -> Outcome:
    """Read, optimise, write back.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names, limits or output; nothing is written.
    """
    task = _task(request)
    profile = one_of(Profile, request.profile, "profile")
    output = _output(request)
    nc_place = _nc_place(request, output)
    require_apart(named_place(request.knowledge), output, request.report, nc_place)
    program = read_program(
        request.file, units=request.units, name=request.name, stock=request.stock
    )
    chosen = _selected(program, request.workingsteps)
    findings = program.file.findings + program.model.findings()
    _require_usable(program, chosen, findings)
    machine = with_holding(machine_for(request.machine, program), request.holding)
    if request.confirm:
        _require_run(program, chosen, machine)
    match = material_for(request.material, program)
    tell(f"material: {match.reason}")
    known, safety = request.knowledge, request.safety
    factors = factors_for(
        known, program, chosen, machine=machine, material=match, safety=safety
    )
    notes = tuple(finding_of(each, safety=safety) for each in factors)
    for note in notes:
        tell(note.message)
    wanted = {int(step.ref) for step in chosen}
    plan = advise(
        program,
        machine=machine,
        material=match,
        task=replace(
            task,
            force_factors={each.tool: each.centre for each in factors},
            learned_safety_factors={each.tool: each.factor / each.centre for each in factors},
        ),
        selected=lambda step: int(step.ref) in wanted,
        progress=Progress(tell, total=len(chosen)),
    )
    plan = _with_file_findings(plan, (*findings, *notes), match)
    changes = changes_of(plan)
    data = writeback.write(program, changes, profile) if changes else program.file.data
    if changes and factors and profile is Profile.OPTIMISATION:
        data = with_corrections(_read_again(program, data), factors)
    confirmation = None
    if request.confirm:
        from service.confirm import confirm  # noqa: PLC0415 (numba takes a second)

        confirmation = confirm(plan, _read_again(program, data), tell=tell)
    if nc_place is not None:
        # NC code first: where it cannot be made, nothing is written.
        code = _nc_code(program, data, request.control, tell)
        if not request.dry_run:
            tell(f"NC code: {nc_place} ({write_lines(nc_place, code)} lines)")
    written = None
    if changes and not request.dry_run:
        write_atomically(output, data)
        written = output
    if not request.dry_run:
        tell(f"written: {output}" if changes else NOTHING_WRITTEN)
    if request.report is not None:
        from service.report import report_page  # noqa: PLC0415 (plotly takes a second)

        write_atomically(request.report, report_page(plan).encode())
        tell(f"report: {request.report}")
    _tell_conflicts(plan, tell)
    return Outcome(plan=plan, written=written, confirmation=confirmation)


def _require_run(program: Program, chosen: tuple[Workingstep, ...], machine: Machine) -> None:
    """Refuse to confirm what cannot be run: before all, not after the plan."""
    require_axes(machine)
    for step in chosen:
        if stock_of(program, step.setup) is None:
            text = f"'{step.id}' cannot be confirmed: the file draws no raw part"
            raise StepNcError(f"{text}; name one with --stock")


def _tell_conflicts(plan: Plan, tell: Tell) -> None:
    conflicts = [each for each in plan.advices if each.status is Status.INFEASIBLE]
    if conflicts:
        names = ", ".join(f"'{each.workingstep.id}'" for each in conflicts)
        tell(f"infeasible, left as programmed: {names}")


def convert(path: Path, *, profile: str, output: Path) -> None:
    """Move the optimisation records of a file into another profile."""
    wanted = one_of(Profile, profile, "profile")
    require_place(output, apart_from=path)
    program = read_program(path, units="iso")
    write_atomically(output, writeback.convert(program, wanted))


def _require_positive(value: float | None, what: str, unit: str) -> None:
    """A number that is given must be positive and finite."""
    if value is not None and not 0.0 < value < float("inf"):
        raise StepNcError(f"{what} {value:g} {unit}: it must be positive")


def _output(request: Request) -> Path:
    """Where the optimised program goes: never over the input unless asked."""
    if request.in_place:
        if request.output is not None:
            raise StepNcError("--in-place and --output exclude each other")
        output = request.file
    else:
        output = request.output or beside(request.file, ".optimised.stpnc")
        if is_same(request.file, output):
            message = "is the input file; use --in-place to overwrite it"
            raise WriteError(message, path=str(output))
        if not request.dry_run:
            require_place(output, apart_from=request.file)
    if request.report is not None:
        require_place(request.report, apart_from=request.file)
        require_place(request.report, apart_from=output)
    return output


def _task(request: Request) -> Task:
    """What is asked, in the units inside."""
    mode = one_of(Mode, request.mode.upper(), "mode")
    free = frozenset(one_of(Free, word.strip(), "free") for word in request.free.split(","))
    _require_positive(request.roughness_um, "roughness", "µm")
    if request.tool_change:
        _require_positive(request.tool_change, "tool change", "s")
    roughness = request.roughness_um
    try:
        require_quantile(request.safety)
    except ValueError as error:
        raise StepNcError(str(error)) from error
    table = _table(request.tools)
    return Task(
        mode=mode,
        free=free,
        roughness=None if roughness is None else mm_from_um(roughness),
        tool_change=request.tool_change,
        wipers=frozenset(tool.id for tool in table if tool.has_wiper),
        front=request.pareto,
        safety=request.safety,
        centre_cutting={**request.centre_cutting, **_centre_cutting(table)},
        allow_plunge=request.allow_plunge,
        source=partial(along_paths, is_run=request.confirm),
    )


def _centre_cutting(tools: tuple["TableTool", ...]) -> dict[str, bool]:
    """Which tools of a table cut over centre, by their ids; none where there is no table."""
    said = {tool.id: tool.centre_cutting for tool in tools}
    return {name: does for name, does in said.items() if does is not None}


def _table(tools: Path | None) -> tuple["TableTool", ...]:
    """Tools of a table; none where there is no table."""
    if tools is None:
        return ()
    from simulator.tool_table import read_tool_table  # noqa: PLC0415 (numpy)

    return read_tool_table(tools)


def _nc_place(request: Request, output: Path) -> Path | None:
    """Where NC code goes: beside the optimised program."""
    if not request.control:
        return None
    from stepnc_model.post.controls import Control  # noqa: PLC0415 (all dialects)

    control = one_of(Control, request.control.lower(), "control")
    place = beside(output, control.suffix)
    for other in (request.file, output, request.report):
        if other is not None:
            require_place(place, apart_from=other)
    return place


def _nc_code(program: Program, data: bytes, control: str, tell: Tell) -> Iterator[str]:
    """NC code of the program as it is after optimisation."""
    from service.paths.toolpaths import nc_lines, paths_of, with_feeds  # noqa: PLC0415 (numpy, shapely)
    from stepnc_model.post.controls import Control  # noqa: PLC0415 (all dialects)

    paths = with_feeds(paths_of(_read_again(program, data), tell=tell), keep_going=False)
    return nc_lines(paths, Control(control.lower()))


def _read_again(program: Program, data: bytes) -> Program:
    """A program as its file says it now."""
    file = Part21File.from_bytes(data, name=program.name)
    return Program(file, units=program.units, name=program.name, stock=program.stock)


def _selected(program: Program, wanted: tuple[str, ...]) -> tuple[Workingstep, ...]:
    """Workingsteps by id or #instance; all when none is named."""
    if not wanted:
        return program.workingsteps
    found = tuple(
        step for step in program.workingsteps if step.id in wanted or str(step.ref) in wanted
    )
    names = {step.id for step in found} | {str(step.ref) for step in found}
    missing = [name for name in wanted if name not in names]
    if missing:
        known = ", ".join(f"'{step.id}' ({step.ref})" for step in program.workingsteps)
        raise StepNcError(f"no workingstep '{missing[0]}'; known: {known}")
    return found


def _require_usable(
    program: Program, chosen: tuple[Workingstep, ...], findings: tuple[Finding, ...]
) -> None:
    """Refuse a program with errors, or with numbers that are in other units.

    Broken workingsteps do not matter when others are asked for by name.
    """
    if program.faults and len(chosen) == len(program.workingsteps):
        raise program.faults[0]
    if not chosen:
        raise SchemaError("the program has no machining workingstep")
    for finding in findings:
        if finding.severity is Severity.ERROR:
            raise SchemaError(
                finding.message,
                entity=finding.entity,
                attribute=finding.attribute,
                line=finding.line,
            )
    error = refusal(program, chosen)
    if error is not None:
        raise error


def _with_file_findings(
    plan: Plan, findings: tuple[Finding, ...], match: MaterialMatch
) -> Plan:
    """The plan with what was noticed while reading, and how the material was found."""
    guess = match.certainty is Certainty.GUESS
    said = Finding(severity=Severity.WARNING if guess else Severity.NOTE, message=match.reason)
    return replace(plan, findings=(*findings, said, *plan.findings))
