"""Program prepared for verification: its moves by tool and workingstep, tools and stock."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from extras.verification.log import ProgramNames
from extras.verification.model.path import ProgrammedPath, ProgrammedRun, programmed_path
from extras.verification.requests import VerificationRequest
from service.inputs.part_file import PartMesh, read_part
from service.inputs.program_bodies import body_triangles
from service.programs.machine_choice import machine_for, material_for
from service.programs.raw_stock import placed_triangles, raw_triangles, user_stock
from service.programs.reading import read_completed, tool_library
from service.progress import Tell, silent
from service.simulation.setup import PreparedRun, prepared_program
from simulator.library import load_machine
from simulator.machine.acts import MoveStretch, ToolTo, WorkingstepTo
from simulator.machine.interpreter import interpret
from simulator.motion.segments import Floats
from simulator.removal.cutter import Cutter, Insert
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tool_files.read import read_tools
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.programs.program import Program, Stock
from stepnc_model.toolpath.frame import workpiece_frame
from stepnc_model.toolpath.task import finished_body
from stepnc_model.units import MM_PER_INCH

LIKE = 0.1
"""Relative difference of sizes that count as the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RequiredFile:
    """File of a required part, in coordinates of the setup."""

    path: Path
    """STL or STEP file."""
    solid: str = ""
    """Solid of a STEP file, by its name or its place; empty: the only one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepName:
    """Workingstep with the feature that it makes."""

    workingstep: str
    feature: str
    tool: int
    """Number of its tool; 0: unknown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedProgram:
    """Program whose log is verified."""

    program: Program
    name: str
    machine: Machine
    material: MaterialMatch
    stock: Stock
    raw: Floats | None = None
    """Triangles of a raw part that is a B-rep body, (T, 3, 3), mm; None: it fills the stock."""
    path: ProgrammedPath
    steps: tuple[StepName, ...]
    cutters: dict[int, Cutter | Insert | None]
    """Shapes of the tools by number."""
    required: Floats | None = None
    """Triangles of the required part, (T, 3, 3), mm; None: the nominal features count."""
    required_name: str = ""
    """File of the required part, for messages."""
    findings: tuple[Finding, ...] = ()
    """What is to be known of the required part in the program."""

    @property
    def is_turned(self) -> bool:
        """True if the part is turned."""
        return self.machine.kind is MachineKind.LATHE

    @property
    def names(self) -> ProgramNames:
        """Names that a log may use."""
        tool_of = {run.workingstep: run.tool for run in self.path.runs}
        return ProgramNames(
            workingsteps={each.workingstep: row for row, each in enumerate(self.steps)},
            tool_of=tool_of,
            tools=frozenset(tool_of.values()),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RequiredSetup:
    """Required part to compare a log with where there is no program."""

    name: str
    """Name of the file of the required part."""
    machine: Machine
    stock: Stock
    raw: Floats | None = None
    """Triangles of the raw part, (T, 3, 3), mm; None: it fills the stock."""
    cutters: dict[int, Cutter | Insert | None]
    """Shapes of the tools by number."""
    required: PartMesh

    @property
    def is_turned(self) -> bool:
        """True if the part is turned."""
        return self.machine.kind is MachineKind.LATHE


def prepared(
    program: Path,
    request: VerificationRequest,
    *,
    tools: Path | None = None,
    tell: Tell = silent,
) -> PreparedProgram:
    """Prepare a program for verification.

    Raises
    ------
    StepNcError
        When the program cannot be run, has several setups, or has no stock.
    """
    read = read_completed(program, request, tools=tool_library(tools), tell=tell).program
    match = material_for(request.material, read)
    tell(f"material: {match.reason}")
    run = prepared_program(read, machine_for(request.machine, read), match, tell=tell)
    if run.program is None or run.raw is None or run.material is None:
        raise StepNcError(f"{program}: the program has no stock: name one with --stock")
    if len({step.setup for step in run.program.workingsteps}) > 1:
        raise StepNcError(f"{program}: several setups: only one can be verified at a time")
    features = {step.id: _feature(run, step.features) for step in run.program.workingsteps}
    runs, names = _runs(run)
    used = {each.workingstep: each.tool for each in runs}
    return PreparedProgram(
        program=run.program,
        name=run.name,
        machine=run.machine,
        material=run.material,
        stock=run.raw,
        raw=raw_triangles(run.program, run.program.workingsteps[0].setup),
        path=programmed_path(runs),
        steps=tuple(
            StepName(workingstep=name, feature=features[name], tool=used.get(row, 0))
            for row, name in enumerate(names)
        ),
        cutters={number: _cutter(run, number) for number in run.tools or {}},
    )


def required_setup(
    request: VerificationRequest, tools: Path | None, required: RequiredFile | None
) -> RequiredSetup:
    """Prepare a verification without a program.

    Raises
    ------
    StepNcError
        When something is not given that a program would tell, or a file is invalid.
    """
    given = {
        "--required FILE": required,
        "--tools TABLE": tools,
        "--stock STOCK": request.stock,
        "--machine NAME": request.machine,
    }
    missing = [name for name, value in given.items() if not value]
    if missing or required is None or tools is None:
        raise StepNcError(
            f"without --program, a verification needs {', '.join(given)}; missing: "
            f"{', '.join(missing)}"
        )
    if request.has_deflection:
        raise StepNcError("--with-deflection needs a program (--program): it is simulated")
    machine = load_machine(request.machine)
    kind = Insert if machine.kind is MachineKind.LATHE else Cutter
    table = read_tools(tools).tools
    if not any(isinstance(tool.shape, kind) for tool in table):
        what = "turns" if kind is Insert else "rotates"
        raise StepNcError(f"{tools}: no tool {what}: {machine.name} needs one")
    raw = user_stock(request.stock)
    return RequiredSetup(
        name=required.path.name,
        machine=machine,
        stock=raw.bounds,
        raw=raw.triangles,
        cutters={tool.number: tool.shape for tool in table},
        required=required_mesh(required, raw.bounds, tolerance=request.tolerance_mm),
    )


def with_required(
    program: PreparedProgram, file: RequiredFile, *, tolerance: float
) -> PreparedProgram:
    """Compare the programmed part with an STL or STEP file in place of the features.

    Parameters
    ----------
    tolerance : float, mm
        Deviation that is an error.

    Raises
    ------
    StepNcError
        When the file is invalid, or has another part.
    """
    return replace(
        program,
        required=required_mesh(file, program.stock, tolerance=tolerance).triangles,
        required_name=str(file.path),
    )


def with_own_part(program: PreparedProgram, *, tolerance: float) -> PreparedProgram:
    """Compare the programmed part with the B-rep body of the finished part, if there is one.

    Where it cannot be read, the features count, which a finding says.

    Parameters
    ----------
    tolerance : float, mm
        Deviation that is an error.
    """
    source = program.program
    body = finished_body(source)
    if body is None:
        return program
    try:
        triangles = body_triangles(source.file, body, tolerance=tolerance)
    except StepNcError as error:
        text = f"the features are compared in place of this body: {error}"
        warning = source.finding(Severity.WARNING, text, body)
        return replace(program, findings=(*program.findings, warning))
    frame = workpiece_frame(source, source.workingsteps[0].setup)
    note = source.finding(Severity.NOTE, "is the required part, in place of the features", body)
    return replace(
        program,
        required=placed_triangles(triangles, frame),
        required_name=program.name,
        findings=(*program.findings, note),
    )


def required_mesh(file: RequiredFile, stock: Stock, *, tolerance: float) -> PartMesh:
    """Read a required part that lies in a stock.

    Parameters
    ----------
    tolerance : float, mm
        Deviation that is an error.

    Raises
    ------
    StepNcError
        When the file is invalid, or the part is in inches or lies elsewhere.
    """
    path = file.path
    mesh = read_part(path, solid=file.solid, tolerance=tolerance)
    corners = mesh.triangles.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    stock_low, stock_high = np.array(stock.low), np.array(stock.high)
    shown = f"{_box(low, high)}; the stock spans {_box(stock_low, stock_high)}"
    size, whole = high - low, stock_high - stock_low
    if (size * MM_PER_INCH <= (1.0 + LIKE) * whole).all():
        raise StepNcError(
            f"{path}: the part spans {shown}: it fits {MM_PER_INCH:g} times into it: is it in "
            "inches? Millimetres are expected"
        )
    within = np.minimum(high, stock_high) - np.maximum(low, stock_low)
    if (within <= 0.0).any():
        raise StepNcError(
            f"{path}: the part spans {shown}: they do not overlap: is it in coordinates of the "
            "setup?"
        )
    return mesh


def _box(low: Floats, high: Floats) -> str:
    pairs = zip("xyz", low.tolist(), high.tolist(), strict=True)
    return ", ".join(f"{axis} {one:.4g} to {other:.4g}" for axis, one, other in pairs) + " mm"


def with_tools(program: PreparedProgram, path: Path) -> PreparedProgram:
    """Replace tools by those of a tool table, which were measured, by their numbers.

    Raises
    ------
    StepNcError
        When the table is invalid, or has other tools.
    """
    found: dict[int, Cutter | Insert | None] = {}
    for tool in read_tools(path).tools:
        if tool.number not in program.cutters:
            known = ", ".join(f"T{number}" for number in sorted(program.cutters))
            raise StepNcError(
                f"{path}: T{tool.number} is not in the program, which has {known}"
            )
        if type(tool.shape) is not type(program.cutters[tool.number]):
            raise StepNcError(f"{path}: T{tool.number} is another kind of tool in the program")
        found[tool.number] = tool.shape
    return replace(program, cutters=program.cutters | found)


def _runs(run: PreparedRun) -> tuple[list[ProgrammedRun], list[str]]:
    """Moves of the program by tool and workingstep, and the ids of the workingsteps."""
    runs: list[ProgrammedRun] = []
    names: list[str] = []
    tool = 0
    for step in interpret(run.blocks, run.machine):
        match step.act:
            case WorkingstepTo(id=name):
                names.append(name)
            case ToolTo(number=number):
                tool = number
            case MoveStretch(segments=segments):
                runs.append(
                    ProgrammedRun(
                        cutter=_cutter(run, tool),
                        tool=tool,
                        workingstep=len(names) - 1,
                        segments=segments,
                    )
                )
    return runs, names


def _cutter(run: PreparedRun, number: int) -> Cutter | Insert | None:
    tool = (run.tools or {}).get(number)
    return None if tool is None else tool.shape


def _feature(run: PreparedRun, refs: tuple[object, ...]) -> str:
    """Name of the first feature of a workingstep."""
    if run.program is None or not refs:
        return ""
    return str(getattr(run.program.get(refs[0]), "its_id", ""))  # type: ignore[arg-type]
