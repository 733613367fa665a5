"""Verification of logged positions against the programmed or the required part."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from extras.verification.comparison import compared_with_program, compared_with_required
from extras.verification.log import LogFile, LogSteps, thinned
from extras.verification.model.deviation import ComparedVolumes, SurfacePlaces
from extras.verification.model.logged_part import LogFacts
from extras.verification.model.path import ProgrammedPath, distance_from, fitted_zero
from extras.verification.preparation import (
    LIKE,
    PreparedProgram,
    RequiredFile,
    RequiredSetup,
    StepName,
    prepared,
    required_setup,
    with_own_part,
    with_required,
    with_tools,
)
from extras.verification.requests import VerificationRequest
from service.inputs.numbers import numbers_in
from service.progress import Tell, silent
from service.recording.run import record_kept
from service.requests.fields import require_bounds
from service.simulation.run import run_of_program
from simulator.motion.segments import Floats
from simulator.spec import Machine
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.plurals import counted
from stepnc_model.units import MM_PER_INCH

FAR = 5.0
"""Distance from the programmed path at which a position is not of this program, mm."""

MOST_FAR = 0.2
"""Share of such positions in a log that is refused."""

SURVEYED = 4096
"""Most positions of a log that are compared with the path before it is verified."""

FIT = "fit"

MOST_SHOWN = 8
"""Most names in a message."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verification:
    """Comparison of logged positions with a part."""

    program: str
    """Name of the program; of the required part without a program."""
    machine: Machine
    log: str
    facts: LogFacts
    step: float
    """Way of the tool between samples where it made the surface, mm; 95 % are shorter."""
    steps: tuple[StepName, ...]
    """Workingsteps in order of execution; without a program, those or the tools of the log."""
    path: ProgrammedPath | None
    """None without a program."""
    places: SurfacePlaces
    nominal: Floats
    """Deviation of the programmed surface from the nominal features at each place, (N,), mm:
    excess positive; NaN where there is no feature."""
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
    bent: Mapping[str, float] = field(default_factory=dict)
    """Predicted greatest deflection of the tool as it makes a wall, by workingstep, mm; empty
    if it was not requested."""

    @property
    def has_errors(self) -> bool:
        """True if a deviation exceeds both its uncertainty and the tolerance."""
        size = np.abs(self.places.deviation)
        return bool((self.places.is_beyond & (size >= self.tolerance - 1e-9)).any())


@dataclass(frozen=True, slots=True, kw_only=True)
class VerificationInputs:
    """Files besides log and program."""

    tools: Path | None = None
    """Tool table with measured tools."""
    required: Path | None = None
    """STL or STEP file of the required part, in the coordinates of the setup."""
    solid: str = ""
    """Solid of a STEP file, by its name or its place; empty: the only one."""

    @property
    def part(self) -> RequiredFile | None:
        """Required part; None: none is given."""
        if self.required is None:
            return None
        return RequiredFile(path=self.required, solid=self.solid)


def verify(
    log: Path | str,
    program: Path | None,
    request: VerificationRequest,
    *,
    inputs: VerificationInputs | None = None,
    tell: Tell = silent,
) -> Verification:
    """Compare the part that logged positions leave with the programmed or the required one.

    Parameters
    ----------
    log : Path or str
        Parquet or CSV file, MTConnect document, SHDR log, or address of an agent, all of whose
        kept observations are read.
    program : Path or None
        STEP-NC program; without one, the inputs name tools and required part, and the request
        machine and stock.
    tell : callable
        Takes messages on the progress.

    Raises
    ------
    StepNcError
        When a file, a name or a number is invalid, or the log is not of this program.
    """
    require_bounds(request)
    given = inputs or VerificationInputs()
    if program is None:
        setup = required_setup(request, given.tools, given.part)
        with log_file(log, tell=tell) as (path, name):
            return verified_without_program(path, setup, request, name=name, tell=tell)
    ready = prepared(program, request, tools=given.tools, tell=tell)
    if given.tools is not None:
        ready = with_tools(ready, given.tools)
    if given.part is not None:
        ready = with_required(ready, given.part, tolerance=request.tolerance_mm)
    else:
        ready = with_own_part(ready, tolerance=request.tolerance_mm)
    with log_file(log, tell=tell) as (path, name):
        return verified(path, ready, request, name=name, tell=tell)


@contextmanager
def log_file(log: Path | str, *, tell: Tell) -> Iterator[tuple[Path, str]]:
    """File of a log while it is needed, with its name; what an agent keeps is recorded."""
    if "://" not in str(log):
        yield Path(log), ""
        return
    with TemporaryDirectory() as folder:
        kept = Path(folder) / "log.parquet"
        record_kept(str(log), kept, tell=tell)
        yield kept, str(log)


def verified(
    log: Path,
    program: PreparedProgram,
    request: VerificationRequest,
    *,
    name: str = "",
    tell: Tell = silent,
) -> Verification:
    """Verify a log against a prepared program.

    Parameters
    ----------
    name : str
        Name of the log in messages; empty: its path.
    tell : callable
        Takes messages on the progress.

    Raises
    ------
    StepNcError
        When the log cannot be read, or is not of this program.
    """
    file = LogFile(
        path=log, name=name, names=program.names, machine=program.machine,
        is_zero_stated=bool(request.zero),
    )  # fmt: skip
    file.zero, findings = _zero(request.zero, file, program)
    try:
        found = compared_with_program(program, file, request.cell_mm, tell)
    except ValueError as error:
        raise StepNcError(f"{program.name}: {error}") from error
    bent: dict[str, float] = {}
    if request.has_deflection:
        totals = run_of_program(program.program, program.machine, program.material, tell=tell)
        bent = {name: total.deflection.value for name, total in totals}
    tools = {run.tool for run in program.path.runs}
    return Verification(
        program=program.name,
        machine=program.machine,
        log=name or log.name,
        facts=found.facts,
        step=found.step,
        steps=program.steps,
        path=program.path,
        places=found.places,
        nominal=found.nominal,
        volumes=found.volumes,
        cell=found.cell,
        is_turned=program.is_turned,
        zero=file.zero,
        tolerance=request.tolerance_mm,
        bent=bent,
        findings=(
            *findings,
            *program.findings,
            *(Finding(severity=Severity.NOTE, message=text) for text in found.notes),
            *_findings(file, found.facts, tools),
        ),
    )


def verified_without_program(
    log: Path,
    setup: RequiredSetup,
    request: VerificationRequest,
    *,
    name: str = "",
    tell: Tell = silent,
) -> Verification:
    """Verify a log against a required part.

    Parameters
    ----------
    name : str
        Name of the log in messages; empty: its path.
    tell : callable
        Takes messages on the progress.

    Raises
    ------
    StepNcError
        When the log cannot be read, or its positions do not enter the stock.
    """
    if request.zero == FIT:
        raise StepNcError("--zero fit needs a program (--program): the zero is fitted to it")
    steps = LogSteps(tools=frozenset(setup.cutters))
    file = LogFile(
        path=log, name=name, names=steps, machine=setup.machine,
        is_zero_stated=bool(request.zero),
    )  # fmt: skip
    if request.zero:
        file.zero = _zero_in(request.zero)
    try:
        found = compared_with_required(setup, file, request.cell_mm, tell)
    except ValueError as error:
        raise StepNcError(f"{setup.name}: {error}") from error
    return Verification(
        program=setup.name,
        machine=setup.machine,
        log=name or log.name,
        facts=found.facts,
        step=found.step,
        steps=tuple(
            StepName(workingstep=word or f"T{tool}", feature="", tool=tool)
            for word, tool in steps.index_of
        ),
        path=None,
        places=found.places,
        nominal=found.nominal,
        volumes=found.volumes,
        cell=found.cell,
        is_turned=setup.is_turned,
        zero=file.zero,
        tolerance=request.tolerance_mm,
        findings=(
            *(Finding(severity=Severity.NOTE, message=text) for text in found.notes),
            *_findings(file, found.facts, set()),
        ),
    )


def _zero_in(text: str) -> tuple[float, float, float]:
    x, y, z = numbers_in(text, "zero", counts=(3,))
    return x, y, z


def _zero(
    text: str, file: LogFile, program: PreparedProgram
) -> tuple[tuple[float, float, float], list[Finding]]:
    """Find where the program's zero is, and check that the log is of this program."""
    findings: list[Finding] = []
    if text and text != FIT:
        file.zero = _zero_in(text)
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
            f"{file.name}: {far.mean():.0%} of the positions are more than {FAR:g} mm from the "
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
            f"{file.name}: positions span {shown}, {MM_PER_INCH:g} times less than the "
            "program: they are in inches; millimetres are expected"
        )


def _findings(file: LogFile, facts: LogFacts, tools: set[int]) -> list[Finding]:
    """Say what the log lacks."""
    found = []
    if file.equal_times:
        found.append(f"{counted(file.equal_times, 'row')} with the time of the row before")
    if file.completed > 1:
        found.append(
            f"{file.completed} programs were completed: their cuts are verified as those of "
            "one part"
        )
    if file.is_running:
        found.append("the log ends while a program runs: what came later is missing")
    if file.foreign:
        shown = ", ".join(sorted(file.foreign)[:MOST_SHOWN])
        found.append(f"the log names workingsteps that the program does not have: {shown}")
    if file.unknown:
        found.append(
            f"{counted(file.unknown, 'row')} without a position: interpolated over time"
        )
    if facts.gaps:
        found.append(
            f"{counted(facts.gaps, 'gap')} of up to {facts.longest_gap:.3g} s in which the "
            "tool moved: what it did there is not known, and what it may have cut there is left"
        )
    missing = sorted(tools - facts.tools)
    if missing:
        shown = ", ".join(f"T{each}" for each in missing)
        found.append(
            f"the log never shows {shown}: its tool changes or workingsteps are missing"
        )
    notes = [f"zero from the log: {file.zero_source}"] if file.zero_source else []
    if len(file.work_offsets) > 1:
        shown = ", ".join(file.work_offsets[:MOST_SHOWN])
        message = f"the work offset changes in the log: {shown}"
        (notes if file.zero_source else found).append(message)
    return [
        *(Finding(severity=Severity.NOTE, message=text) for text in notes),
        *(Finding(severity=Severity.WARNING, message=text) for text in found),
    ]
