"""Job ``verification``: the part that logged positions left, against the programmed one."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

from service.errors import NotFound
from service.file_names import naming, with_names
from service.files import write_atomically
from service.jobs.task import LOG, PLACES, REPORT, SAMPLES, SURFACE, RunningJob
from service.progress import share_in
from service.recording.kept import keep_run
from service.requests.stored_verification import QueuedVerification
from service.storage import files, jobs
from service.storage.files import FileKind
from service.verification.output import verification_json, verification_page, write_places
from service.verification.run import VerificationInputs, verify
from service.verification.surface_map import write_surface
from stepnc_model.errors import Finding, Severity


@dataclass(frozen=True, slots=True, kw_only=True)
class _Log:
    """Log to verify."""

    path: Path
    name: str
    findings: tuple[Finding, ...] = ()


def run(task: RunningJob) -> None:
    """Verify a log and store result, report, places and surface.

    Raises
    ------
    StepNcError
        As :func:`service.verification.run.verify`; and when an agent does not answer.
    """
    request = task.request(QueuedVerification)
    names: dict[Path, str] = {}
    tools = _input(task, request.tools_id, FileKind.TOOLS, names)
    required = _input(task, request.required_id, FileKind.REQUIRED_PART, names)
    program: Path | None = None
    if task.job.program:
        program, name = task.program_file()
        names[program] = name
    log = _log(task, request)
    names[log.path] = log.name
    with naming(names):
        found = verify(
            log.path,
            program,
            task.named(request),
            inputs=VerificationInputs(tools=tools, required=required),
            tell=lambda message: _tell(task, with_names(message, names)),
        )
    findings = (
        replace(each, message=with_names(each.message, names)) for each in found.findings
    )
    found = replace(
        found,
        program=with_names(found.program, names),
        log=log.name,
        findings=(*log.findings, *findings),
    )
    for suffix in (".csv", ".parquet"):
        write_places(task.folder / f"{PLACES}{suffix}", found)
    write_surface(task.folder / SURFACE, found)
    write_atomically(task.folder / REPORT, verification_page(found).encode())
    task.keep(json.loads(verification_json(found)))


def _tell(task: RunningJob, message: str) -> None:
    """Report a message as progress; its share where it has one."""
    if share_in(message) is None:
        task.progress(0.0, message)
    else:
        task.tell(message)


def _log(task: RunningJob, request: QueuedVerification) -> _Log:
    """Return the log, after it was read from the agent of a monitored machine.

    Raises
    ------
    NotFound
        When it was deleted.
    """
    if request.log_id is not None:
        stored = files.get(task.data_folder, request.log_id, FileKind.LOG)
        path = files.require_file(task.data_folder, stored.id, FileKind.LOG)
        return _Log(path=path, name=stored.name)
    if request.run_id is not None:
        kind = jobs.get(task.data_folder, request.run_id).kind.value
        path = task.data_folder.job_folder(request.run_id) / SAMPLES
        if not path.is_file():
            raise NotFound(f"samples of {kind}", request.run_id)
        return _Log(path=path, name=f"samples of {kind} {request.run_id}")
    path = task.folder / LOG
    kept = keep_run(request.agent_url, path, tell=lambda message: _tell(task, message))
    found = [
        Finding(severity=Severity.WARNING, message=f"the run is not whole: {text}")
        for text in kept.missing
    ]
    if kept.program:
        message = f"the machine names the program '{kept.program}'"
        found.insert(0, Finding(severity=Severity.NOTE, message=message))
    return _Log(path=path, name=f"latest run of {request.monitor}", findings=tuple(found))


def _input(
    task: RunningJob, id: str | None, kind: FileKind, names: dict[Path, str]
) -> Path | None:
    """Return an uploaded file, and note its name; None without an id."""
    if id is None:
        return None
    path = files.require_file(task.data_folder, id, kind)
    names[path] = files.get(task.data_folder, id, kind).name
    return path
