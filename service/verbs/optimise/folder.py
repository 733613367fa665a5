"""Optimisation of every program of a folder, on executors.

Programs travel as bytes, so that workers of a cluster need no common folder. What is written is
written here: the optimised program first, then its row of the ledger. A run that was broken off
goes on with what has no row.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

from optimiser.advice import Advice, AdviceStatus, Plan
from optimiser.errors import OptimisationError
from service.execution.executors import Pools, processes, results
from service.execution.pools import pools_of
from service.files import PROGRAMS, is_same, naming, write_atomically
from service.inputs.program_kind import ProgramKind
from service.progress import Tell, Ticker, silent
from service.requests.advice import AdviceRequest
from service.requests.fields import require_bounds
from service.requests.kind_options import require_served
from service.verbs.optimise.folder_result import FolderAdvice
from service.verbs.optimise.ledger import Ledger, ProgramRow, ProgramStatus, known_rows
from service.verbs.optimise.program import advise_program
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError, WriteError

MOST_BYTES = 100_000_000
"""Size of the greatest program, bytes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FolderFiles:
    """Files that ``optimise FOLDER`` reads and writes."""

    folder: Path
    output: Path
    """Folder of the optimised programs and of the ledger."""
    dry_run: bool = False
    """Whether only the ledger is written."""
    holding: Path | None = None
    tools: Path | None = None
    knowledge: str = ""


def optimise_folder(
    request: AdviceRequest, files: AdviceFiles, *, tell: Tell = silent
) -> FolderAdvice:
    """Optimise every program of a folder, on a cluster if one is named.

    Raises
    ------
    StepNcError
        When the folders or an option are not usable.
    """
    require_served(request, ProgramKind.STEP_NC)
    require_served(files, ProgramKind.STEP_NC)
    if files.output is None or files.in_place or files.report is not None:
        raise StepNcError(
            f"{files.file}: is a folder: name another folder with -o, without --in-place and "
            "--report"
        )
    places = FolderFiles(
        folder=files.file,
        output=files.output,
        dry_run=files.dry_run,
        holding=files.holding,
        tools=files.tools,
        knowledge=files.kb,
    )
    return optimise_programs(request, places, pools=pools_of(files.cluster), tell=tell)


def optimise_programs(
    request: AdviceRequest,
    files: FolderFiles,
    *,
    pools: Pools = processes,
    tell: Tell = silent,
) -> FolderAdvice:
    """Optimise every program of a folder.

    Parameters
    ----------
    request : AdviceRequest
    files : FolderFiles
    pools : callable
        Makes executors.
    tell : callable

    Raises
    ------
    StepNcError
        When the folders or an option are not usable. Programs that are not have a row that
        says so.
    """
    require_bounds(request)
    if request.nc_control is not None or request.workingsteps:
        raise StepNcError(f"{files.folder}: --nc and --workingstep are for one program")
    programs = _programs(files)
    common = _common(request, files)
    files.output.mkdir(parents=True, exist_ok=True)
    before = known_rows(files.output)
    digests = {each.name: _digest(common, each) for each in programs}
    kept = {
        name: row
        for name, row in before.items()
        if digests.get(name) == row.digest and _is_there(files, row)
    }
    missing = [each for each in programs if each.name not in kept]
    ticker, found = Ticker(tell), dict(kept)
    with Ledger(files.output, kept.values()) as book:
        work = results(
            pools, advised, _tasks(request, files, missing), tell=tell, what="programs"
        )
        for index, (row, data) in work:
            own = replace(row, digest=digests[missing[index].name])
            if data and not files.dry_run:
                write_atomically(files.output / row.program, data)
            book.add(own)
            found[row.program] = own
            ticker(lambda: f"{len(found) - len(kept)} of {len(missing)} programs")
    rows = tuple(found[name] for name in sorted(found))
    return FolderAdvice(rows=rows, made=len(missing))


def _programs(files: FolderFiles) -> list[Path]:
    """Programs of the folder, by name.

    Raises
    ------
    StepNcError
        If there are none, or the folders are the same.
    """
    if files.output.exists() and not files.output.is_dir():
        raise WriteError("is a file: name a folder with -o", path=str(files.output))
    if files.output.exists() and is_same(files.folder, files.output):
        raise WriteError("is the folder of the programs; name another", path=str(files.output))
    found = sorted(
        each
        for each in files.folder.iterdir()
        if each.suffix.lower() in PROGRAMS and each.is_file()
    )
    if not found:
        suffixes = ", ".join(sorted(PROGRAMS))
        raise StepNcError(f"{files.folder}: has no program ({suffixes})")
    return found


def _tasks(
    request: AdviceRequest, files: FolderFiles, programs: Iterable[Path]
) -> Iterator[tuple[object, ...]]:
    for place in programs:
        yield request, files, place.name, place.read_bytes()


def advised(
    request: AdviceRequest, files: FolderFiles, name: str, data: bytes
) -> tuple[ProgramRow, bytes]:
    """Optimise one program, in any process.

    Parameters
    ----------
    request : AdviceRequest
    files : FolderFiles
    name : str
        Name of the file.
    data : bytes
        Its contents.

    Returns
    -------
    ProgramRow, bytes
        Its row, and the optimised program; empty where nothing was advised.
    """
    with TemporaryDirectory(prefix="stepnc-") as folder:
        place, output = Path(folder) / name, Path(folder) / "advised"
        place.write_bytes(data)
        try:
            with naming({place: name}):
                found = advise_program(
                    request,
                    AdviceFiles(
                        file=place, name=name, output=output, holding=files.holding,
                        tools=files.tools, kb=files.knowledge,
                    ),
                )  # fmt: skip
        except OptimisationError as error:
            status = ProgramStatus.INFEASIBLE
            return ProgramRow(program=name, status=status, message=str(error)), b""
        except StepNcError as error:
            return ProgramRow(program=name, status=ProgramStatus.BAD, message=str(error)), b""
        written = output.read_bytes() if found.written is not None else b""
    passed = found.confirmation is not None and bool(found.confirmation.passed)
    return _row(name, found.plan, is_exceeded=passed), written


def _row(name: str, plan: Plan, *, is_exceeded: bool) -> ProgramRow:
    """Row of a program that has a plan."""
    advice = [each for each in plan.advices if each.status is AdviceStatus.ADVISED]
    conflicts = [each for each in plan.advices if each.status is AdviceStatus.INFEASIBLE]
    status, message = ProgramStatus.ADVISED, ""
    if plan.has_bad_data:
        status = ProgramStatus.BAD
        message = "; ".join(f"'{each.id}': {each.reason}" for each in plan.refused)
    elif conflicts:
        status, message = ProgramStatus.INFEASIBLE, _names(conflicts)
    elif is_exceeded or plan.faults:
        status, message = ProgramStatus.EXCEEDED, "; ".join(plan.faults)
    elif not advice:
        status = ProgramStatus.NOTHING
    return ProgramRow(
        program=name,
        status=status,
        workingsteps=len(plan.advices),
        advised=len(advice),
        time_before_s=plan.time_before,
        time_after_s=plan.time_after,
        message=message,
    )


def _names(conflicts: list[Advice]) -> str:
    return "infeasible: " + ", ".join(each.workingstep.id for each in conflicts)


def _is_there(files: FolderFiles, row: ProgramRow) -> bool:
    """True if what a row promises is written."""
    return files.dry_run or not row.advised or (files.output / row.program).is_file()


def _common(request: AdviceRequest, files: FolderFiles) -> bytes:
    """Everything beside the program that determines the advice.

    Raises
    ------
    StepNcError
        If a file that is named cannot be read.
    """
    own = (request, files.dry_run, files.knowledge, version("stepnc-optimiser"))
    digest = hashlib.sha256(repr(own).encode())
    named = (
        request.machine, request.material, files.holding, files.tools, files.knowledge,
    )  # fmt: skip
    for place in (Path(each) for each in named if each):
        if place.is_file():
            digest.update(place.read_bytes())
    return digest.digest()


def _digest(common: bytes, program: Path) -> str:
    """Digest of a program and of what determines its advice.

    Raises
    ------
    StepNcError
        If the program cannot be read, or is too large.
    """
    try:
        if program.stat().st_size > MOST_BYTES:
            raise StepNcError(
                f"{program}: has {program.stat().st_size} bytes: it must be at most "
                f"{MOST_BYTES} in a folder; optimise it by itself"
            )
        return hashlib.sha256(common + program.read_bytes()).hexdigest()[:32]
    except OSError as error:
        raise StepNcError(f"{program}: {error.strerror}") from error
