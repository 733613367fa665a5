"""Job ``verification``: the part that logged positions left, against the programmed one."""

from dataclasses import replace
from pathlib import Path

from service.errors import NotFound
from service.file_names import naming, with_names
from service.files import write_atomically
from service.jobs.logs import log_of, told
from service.jobs.task import PLACES, REPORT, SURFACE, RunningJob
from service.requests.stored_verification import QueuedVerification
from service.storage import files
from service.storage.files import FileKind
from service.verbs.verify import run as verify
from service.verbs.verify.request import VerificationFiles
from service.verbs.verify.result import VerificationResult
from service.verification.surface_map import write_surface


def run(task: RunningJob) -> None:
    """Verify a log and store result, report, places and surface.

    Raises
    ------
    StepNcError
        As :func:`service.verbs.verify.run.run`; and when an agent does not answer.
    """
    request = task.request(QueuedVerification)
    names: dict[Path, str] = {}
    tools = _input(task, request.tools_id, FileKind.TOOLS, names)
    request = task.with_stock(request, names)
    required = _input(task, request.required_id, FileKind.REQUIRED_PART, names)
    program: Path | None = None
    if task.job.program:
        program, name = task.program_file()
        names[program] = name
    log = log_of(task, request)
    if log is None:
        raise NotFound("log of verification", task.job.id)
    names[log.path] = log.name
    with naming(names):
        found = verify.run(
            request,
            VerificationFiles(
                log=str(log.path),
                program=program,
                tools=tools,
                required="" if required is None else f"{required}#{request.required_solid}",
            ),
            tell=lambda message: told(task, with_names(message, names)),
        ).found
    findings = (
        replace(each, message=with_names(each.message, names)) for each in found.findings
    )
    shown = replace(
        found,
        program=with_names(found.program, names),
        log=log.name,
        findings=(*log.findings, *findings),
    )
    result = VerificationResult(found=shown)
    for suffix in (".csv", ".parquet"):
        result.write_places(task.folder / f"{PLACES}{suffix}")
    write_surface(task.folder / SURFACE, shown)
    write_atomically(task.folder / REPORT, result.page().encode())
    task.keep(result.record())


def _input(
    task: RunningJob, id: str | None, kind: FileKind, names: dict[Path, str]
) -> Path | None:
    """Return an uploaded file, and note its name; None without an id."""
    if id is None:
        return None
    path = files.require_file(task.data_folder, id, kind)
    names[path] = files.get(task.data_folder, id, kind).name
    return path
