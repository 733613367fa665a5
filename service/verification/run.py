"""Verification of logged positions, for the command ``verify``."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from service.numbers import numbers_in
from service.reading import Tell, silent
from service.requests.fields import require_bounds
from service.requests.verification import VerificationRequest
from service.simulation.setup import PreparedRun, from_program
from service.verification.log import LogFile, ProgramNames, thinned
from simulator.machine.acts import MoveStretch, ToolTo, WorkingstepTo
from simulator.machine.interpreter import interpret
from simulator.motion.segments import Floats
from simulator.removal.cutter import Cutter, Insert
from simulator.spec import Machine, MachineKind
from simulator.tool_table import read_tool_table
from simulator.verification.deviation import (
    ComparedVolumes,
    SurfacePlaces,
    compared_volumes,
    surface_places,
)
from simulator.verification.logged import LogFacts, LoggedPart, NearestSamples
from simulator.verification.path import ProgrammedPath, ProgrammedRun, programmed_path
from simulator.verification.surface import programmed_part
from simulator.verification.turned import (
    LoggedBar,
    turned_part,
    turned_places,
    turned_volumes,
)
from simulator.verification.zero import distance_from, fitted_zero
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.program import Stock

FAR = 5.0
"""Distance from the programmed path at which a position is not of this program, mm."""

MOST_FAR = 0.2
"""Share of such positions in a log that is refused."""

SURVEYED = 4096
"""Most positions of a log that are compared with the path before it is verified."""

MM_PER_INCH = 25.4

LIKE = 0.1
"""Relative difference of sizes that count as the same."""

FIT = "fit"


@dataclass(frozen=True, slots=True, kw_only=True)
class StepName:
    """Workingstep with the feature that it makes."""

    workingstep: str
    feature: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verification:
    """Result of ``verify``."""

    program: str
    machine: Machine
    log: str
    facts: LogFacts
    step: float
    """Way of the tool between samples where it made the surface, mm; 95 % are shorter."""
    steps: tuple[StepName, ...]
    """Workingsteps in order of execution."""
    path: ProgrammedPath
    places: SurfacePlaces
    volumes: ComparedVolumes
    cell: float
    """Size of the cells of the height map or of the bar, mm."""
    is_turned: bool
    """Whether the part is turned: positions are radius, 0 and z."""
    zero: tuple[float, float, float]
    """Position of the program's zero on the axes, mm."""
    tolerance: float
    """Deviation that is an error, mm."""
    findings: tuple[Finding, ...]

    @property
    def has_errors(self) -> bool:
        """Whether a deviation exceeds both its uncertainty and the tolerance."""
        size = np.abs(self.places.deviation)
        return bool((self.places.is_beyond & (size >= self.tolerance - 1e-9)).any())


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedProgram:
    """Program whose log is verified."""

    name: str
    machine: Machine
    stock: Stock
    path: ProgrammedPath
    steps: tuple[StepName, ...]
    cutters: dict[int, Cutter | Insert | None]
    """Shapes of the tools by number."""

    @property
    def is_turned(self) -> bool:
        """Whether the part is turned."""
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


def verify(
    log: Path,
    program: Path,
    request: VerificationRequest,
    *,
    tools: Path | None = None,
    tell: Tell = silent,
) -> Verification:
    """Compare the part that logged positions leave with the programmed one.

    Raises
    ------
    StepNcError
        When a file, a name or a number is invalid, or the log is not of this program.
    """
    require_bounds(request)
    ready = prepared(program, request, tell=tell)
    if tools is not None:
        ready = replace(ready, cutters=ready.cutters | _measured_tools(tools, ready))
    return verified(log, ready, request, tell=tell)


def prepared(
    program: Path, request: VerificationRequest, *, tell: Tell = silent
) -> PreparedProgram:
    """Prepare a program for verification.

    Raises
    ------
    StepNcError
        When the program cannot be run, has several setups, or has no stock.
    """
    run = from_program(
        program, units=request.units, machine=request.machine, material=request.material,
        tell=tell,
    )  # fmt: skip
    if run.program is None or run.raw is None:
        raise StepNcError(f"{program}: the program has no stock")
    if len({step.setup for step in run.program.workingsteps}) > 1:
        raise StepNcError(f"{program}: several setups: only one can be verified at a time")
    features = {step.id: _feature(run, step.features) for step in run.program.workingsteps}
    runs, names = _runs(run)
    return PreparedProgram(
        name=run.name,
        machine=run.machine,
        stock=run.raw,
        path=programmed_path(runs),
        steps=tuple(StepName(workingstep=name, feature=features[name]) for name in names),
        cutters={number: _cutter(run, number) for number in run.tools or {}},
    )


def verified(
    log: Path,
    program: PreparedProgram,
    request: VerificationRequest,
    *,
    tell: Tell = silent,
) -> Verification:
    """Verify a log against a prepared program.

    Raises
    ------
    StepNcError
        When the log cannot be read, or is not of this program.
    """
    file = LogFile(path=log, names=program.names)
    file.zero, findings = _zero(request.zero, file, program)
    compared = _turned if program.is_turned else _milled
    found = compared(program, file, request.cell_mm, tell)
    return Verification(
        program=program.name,
        machine=program.machine,
        log=log.name,
        facts=found.facts,
        step=found.step,
        steps=program.steps,
        path=program.path,
        places=found.places,
        volumes=found.volumes,
        cell=found.cell,
        is_turned=program.is_turned,
        zero=file.zero,
        tolerance=request.tolerance_mm,
        findings=(*findings, *_findings(file, found.facts, program)),
    )


def _measured_tools(path: Path, program: PreparedProgram) -> dict[int, Cutter | Insert | None]:
    """Read the tools that were really used from a tool table, by their numbers."""
    found: dict[int, Cutter | Insert | None] = {}
    for tool in read_tool_table(path):
        if tool.number not in program.cutters:
            known = ", ".join(f"T{number}" for number in sorted(program.cutters))
            raise StepNcError(
                f"{path}: T{tool.number} is not in the program, which has {known}"
            )
        if type(tool.shape) is not type(program.cutters[tool.number]):
            raise StepNcError(f"{path}: T{tool.number} is another kind of tool in the program")
        found[tool.number] = tool.shape
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedParts:
    """Comparison of two parts."""

    places: SurfacePlaces
    volumes: ComparedVolumes
    facts: LogFacts
    step: float
    cell: float


def _milled(
    program: PreparedProgram, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    """Compare milled parts."""
    part = programmed_part(program.path, program.stock, cell=cell)
    cutters = {
        number: shape if isinstance(shape, Cutter) else None
        for number, shape in program.cutters.items()
    }
    left = LoggedPart(part, program.stock, cutters)
    for piece in file.pieces():
        left.add(piece)
        tell(f"{left.facts.samples} samples, {left.facts.end:.0f} s of the log")
    return ComparedParts(
        places=surface_places(part, left),
        volumes=compared_volumes(part, left),
        facts=left.facts,
        step=_usual(left.walls, left.floors),
        cell=part.map.cell,
    )


def _turned(
    program: PreparedProgram, file: LogFile, cell: float | None, tell: Tell
) -> ComparedParts:
    """Compare turned parts."""
    part = turned_part(program.path, program.stock, cell=cell)
    left = LoggedBar(part, program.stock, program.cutters)
    for piece in file.pieces():
        left.add(piece)
        tell(f"{left.facts.samples} samples, {left.facts.end:.0f} s of the log")
    return ComparedParts(
        places=turned_places(part, left),
        volumes=turned_volumes(part, left, program.stock),
        facts=left.facts,
        step=_usual(left.nearest),
        cell=part.bar.cell,
    )


def _usual(*places: NearestSamples) -> float:
    """Way between samples that 95 % of the samples at a surface do not exceed, mm."""
    steps = np.concatenate([each.step[np.isfinite(each.time)] for each in places])
    return float(np.quantile(steps, 0.95)) if len(steps) else 0.0


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


def _zero(
    text: str, file: LogFile, program: PreparedProgram
) -> tuple[tuple[float, float, float], list[Finding]]:
    """Find where the program's zero is, and check that the log is of this program."""
    findings: list[Finding] = []
    if text and text != FIT:
        x, y, z = numbers_in(text, "zero", counts=(3,))
        file.zero = (x, y, z)
    survey = np.concatenate(thinned(file.pieces(), most=SURVEYED))
    points = np.concatenate(program.path.chords)
    _require_millimetres(file, survey, points)
    if text == FIT:
        fitted, rest = fitted_zero(survey, program.path)
        shown = ", ".join(f"{each:g}" for each in fitted)
        beside = ", ".join(f"{each:.4f}" for each in rest)
        message = (
            f"zero fitted to whole millimetres: ({shown}) mm; the positions lie "
            f"({beside}) mm from it in the median, which the fit leaves in the deviations"
        )
        findings.append(Finding(severity=Severity.NOTE, message=message))
        file.zero = fitted
        survey = survey - np.array(fitted)
    far = distance_from(survey, program.path) > FAR
    if far.mean() > MOST_FAR:
        raise StepNcError(
            f"{file.path}: {far.mean():.0%} of the positions are more than {FAR:g} mm from the "
            f"path of {program.name}: is it a run of this program? Where is its zero (--zero)?"
        )
    return file.zero, findings


def _require_millimetres(file: LogFile, survey: Floats, points: Floats) -> None:
    """Refuse positions whose extent is that of the program in inches."""
    logged, programmed = np.ptp(survey, axis=0), np.ptp(points, axis=0)
    has_extent = programmed > 1.0
    ratio = logged[has_extent] * MM_PER_INCH / programmed[has_extent]
    if len(ratio) and (np.abs(ratio - 1.0) < LIKE).all():
        shown = " × ".join(f"{each:.3g}" for each in logged)
        raise StepNcError(
            f"{file.path}: positions span {shown}, {MM_PER_INCH:g} times less than the "
            "program: they are in inches; millimetres are expected"
        )


def _findings(file: LogFile, facts: LogFacts, program: PreparedProgram) -> list[Finding]:
    """Say what the log lacks."""
    found = []
    if file.equal_times:
        found.append(f"{file.equal_times} rows have the time of the row before")
    if file.unknown:
        found.append(f"{file.unknown} rows lack a position: interpolated over time")
    if facts.gaps:
        found.append(
            f"{facts.gaps} gaps of up to {facts.longest_gap:.3g} s in which the tool moved: "
            "what it did there is not known"
        )
    seen = {run.tool for run in program.path.runs}
    missing = sorted(seen - facts.tools)
    if missing:
        tools = ", ".join(f"T{each}" for each in missing)
        found.append(
            f"the log never shows {tools}: its tool changes or workingsteps are missing"
        )
    return [Finding(severity=Severity.WARNING, message=text) for text in found]
