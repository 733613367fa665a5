"""Log that a job works on: an uploaded one, the samples of a run, or that of a machine."""

from dataclasses import dataclass
from pathlib import Path

from service.errors import NotFound
from service.jobs.task import LOG, SAMPLES, RunningJob
from service.progress import share_in
from service.recording.kept import keep_run
from service.requests.stored_cycle_time import QueuedCycleTime
from service.requests.stored_verification import QueuedVerification
from service.storage import files, jobs
from service.storage.files import FileKind
from stepnc_model.errors import Finding, Severity


@dataclass(frozen=True, slots=True, kw_only=True)
class JobLog:
    """Log of a run, with its name in messages."""

    path: Path
    name: str
    findings: tuple[Finding, ...] = ()


def log_of(task: RunningJob, request: QueuedVerification | QueuedCycleTime) -> JobLog | None:
    """Return the log of a request, read from an agent if need be; None if it names none.

    Raises
    ------
    StepNcError
        When it was deleted, or the agent does not answer.
    """
    if request.log_id is not None:
        stored = files.get(task.data_folder, request.log_id, FileKind.LOG)
        path = files.require_file(task.data_folder, stored.id, FileKind.LOG)
        return JobLog(path=path, name=stored.name)
    if request.run_id is not None:
        kind = jobs.get(task.data_folder, request.run_id).kind.value
        folder = task.data_folder.job_folder(request.run_id)
        path = task.data_folder.fetched(folder / SAMPLES)
        if not path.is_file():
            raise NotFound(f"samples of {kind}", request.run_id)
        return JobLog(path=path, name=f"samples of {kind} {request.run_id}")
    return _of_machine(task, request) if request.monitor else None


def _of_machine(task: RunningJob, request: QueuedVerification | QueuedCycleTime) -> JobLog:
    """Read the latest run that the agent of a monitored machine keeps."""
    path = task.folder / LOG
    kept = keep_run(request.agent_url, path, tell=lambda message: told(task, message))
    found = [
        Finding(severity=Severity.WARNING, message=f"the run is not whole: {text}")
        for text in kept.missing
    ]
    if kept.program:
        message = f"the machine names the program '{kept.program}'"
        found.insert(0, Finding(severity=Severity.NOTE, message=message))
    return JobLog(path=path, name=f"latest run of {request.monitor}", findings=tuple(found))


def told(task: RunningJob, message: str) -> None:
    """Report a message as progress; with its share where it has one."""
    if share_in(message) is None:
        task.progress(0.0, message)
    else:
        task.tell(message)
