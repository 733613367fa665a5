"""Process of a single job, which ends with the runner that started it."""

import logging
import resource
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from threading import Timer, main_thread
from time import monotonic, sleep
from types import FrameType
from typing import Any, TypeVar

from kbe.errors import StoreFull
from service.errors import StorageFull, Unavailable
from service.extra_parts import declared
from service.jobs.task import RunningJob, clear
from service.live.journal import has_room
from service.optional_packages import missing_extras_named
from service.processes.lifeline import end_with_parent
from service.processes.process_limits import GIB, ProcessLimits, limit_process
from service.storage import jobs
from service.storage.folder import FolderAddress, known_data_folder
from service.storage.jobs import Job, JobKind, JobState
from service.storage.results import LARGE, UNFINISHED
from service.web.problem import plain_problem, problem_of
from stepnc_model.errors import StepNcError, WriteError

T = TypeVar("T")

VERB = "service.jobs.verb_job:run"
"""Function that runs the verb of a job."""

WORK = {
    JobKind.CONTROL: "service.jobs.steer:run_control",
    JobKind.TRIAL: "service.jobs.steer:run_trial",
    **dict(declared("jobs", "WORK")),
}
"""Functions that do the work of live sessions, and of extras whose jobs are no single verb."""

WITHOUT_ROOM = (StorageFull, StoreFull, WriteError)
"""Errors after which large files of the job are removed, because the disk is full."""

PATIENCE = 600.0
"""Time for which a call that failed is repeated, in s: work of hours outlives the restart of a
server, and a bucket that is away."""

UNTIL_ROOM = 5.0
"""Time between two looks whether a full disk has room again, in s."""

AGAIN = 1.0
"""Delay between two attempts of a database call, in s."""


COMPILERS = "simulator.kernels"
"""Logger of the compilers, which explains why a first run is slow to start."""


class ProgressHandler(logging.Handler):
    """Log handler that reports a library's messages as progress of the job."""

    def __init__(self, task: RunningJob) -> None:
        super().__init__()
        self._task = task

    def emit(self, record: logging.LogRecord) -> None:
        """Report a log message as progress of the job."""
        self._task.progress(0.0, record.getMessage())


SOON = 0.01
"""Time until a request to end is repeated that came where nothing could catch it, in s."""

UnraisableHook = Callable[["sys.UnraisableHookArgs"], Any]


class Cancelled(BaseException):
    """The runner has asked the job to end; unfinished files are removed on the way out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JobEnd:
    """End of a job: state and error."""

    state: JobState
    problem: Mapping[str, Any] | None = None


def limited_main(limits: ProcessLimits, folder: FolderAddress, id: str, attempt: int) -> None:
    """Run a claimed job within limits of memory and processor time."""
    limit_process(limits)
    main(folder, id, attempt)


def main(folder: FolderAddress, id: str, attempt: int) -> None:
    """Run a claimed job and record how it ended; nothing if a later attempt has taken over."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    root = Path(folder.root)
    data_folder = _insisting(root, lambda: known_data_folder(folder))
    job = _insisting(root, lambda: jobs.get(data_folder, id))
    if job.attempt != attempt:
        return
    task = RunningJob(data_folder=data_folder, job=job)
    _say_as_progress(task)
    try:
        end = _end_unless_cancelled(task)
    except BaseException:
        # The server's log has the traceback; the client learns that it is not at fault.
        detail = f"internal error in job '{id}'; see the log of the server"
        fault = plain_problem(500, "Fault", detail)
        _finish(task, JobEnd(state=JobState.FAILED, problem=fault))
        raise
    _finish(task, end)


def _end_unless_cancelled(task: RunningJob) -> JobEnd:
    """Do the work of a job, and return how it has ended; it may be asked to end before."""
    asked: list[int] = []
    try:
        with _cancellable(asked):
            end = _end_of(task)
    except Cancelled:
        # Also where it came between two lines of what handles an error.
        return JobEnd(state=JobState.CANCELLED)
    except Exception:
        # Compiled code, such as that of pydantic, puts an error of its own in its place.
        if not asked:
            raise
        return JobEnd(state=JobState.CANCELLED)
    is_broken_off = asked and end.state is JobState.FAILED
    return JobEnd(state=JobState.CANCELLED) if is_broken_off else end


def _end_of(task: RunningJob) -> JobEnd:
    """Do the work of a job, and return how it has ended; begin anew when the disk was full."""
    while True:
        end, error = _tried(task)
        is_without_room = isinstance(error, (*WITHOUT_ROOM, Unavailable))
        # What the job has freed may be all that lacked: then it needs more than there is. A
        # run at a pace cannot be done again: people have watched it, and given orders.
        if not is_without_room or task.job.is_paced or has_room(task.data_folder.root):
            return end
        while not has_room(task.data_folder.root):
            sleep(UNTIL_ROOM)


def _tried(task: RunningJob) -> tuple[JobEnd, StepNcError | None]:
    """Do the work of a job once; the end of it, and the error that it would be."""
    try:
        if task.make_folder():
            with missing_extras_named(f"the {task.job.kind.value}"):
                _work(task.job)(task)
            _insisting(task.data_folder.root, task.publish)
    except StepNcError as error:
        if isinstance(error, WITHOUT_ROOM):
            clear(task.folder, LARGE)
        problem = problem_of(error, hidden=str(task.data_folder.files))
        return JobEnd(state=JobState.FAILED, problem=problem), error
    except MemoryError:
        detail = f"the job needed more memory than {_memory()}"
        problem = plain_problem(507, "Out of memory", detail)
        return JobEnd(state=JobState.FAILED, problem=problem), None
    return JobEnd(state=JobState.SUCCEEDED), None


def _memory() -> str:
    """Memory limit of a job, in words."""
    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    if most == resource.RLIM_INFINITY:
        return "is available"
    return f"the {most / GIB:.3g} GB that a job may take (`stepnc serve --job-memory`)"


@contextmanager
def _cancellable(signals: list[int]) -> Iterator[None]:
    """Raise Cancelled where the runner asks the job to end, and only within this block.

    Parameters
    ----------
    signals : list of int
        Gets the number of each signal that has asked for it.
    """
    others = sys.unraisablehook

    def cancel(number: int, frame: FrameType | None) -> None:
        signals.append(number)
        _cancel(number, frame)

    sys.unraisablehook = partial(_cancel_again, others)
    try:
        signal.signal(signal.SIGTERM, cancel)
        yield
    finally:
        # A function instead of SIG_IGN: Python reports a signal that came just before as lost.
        signal.signal(signal.SIGTERM, _too_late)
        sys.unraisablehook = others


def _say_as_progress(task: RunningJob) -> None:
    """Report the compilers' messages as progress of the job."""
    compilers = logging.getLogger(COMPILERS)
    compilers.addHandler(ProgressHandler(task))
    compilers.propagate = False


def _finish(task: RunningJob, end: JobEnd) -> None:
    """Record how a job has ended."""
    if end.state is not JobState.SUCCEEDED:
        clear(task.folder, UNFINISHED)
        # Rows of a run that was ended are kept, where there is room for them.
        with suppress(Unavailable):
            task.publish()
    _insisting(
        task.data_folder.root,
        lambda: jobs.finish(task.data_folder, task.job, end.state, problem=end.problem),
    )


def _insisting(root: Path, ask: Callable[[], T]) -> T:
    """Return the result of a call, repeated for a while when it fails, or the disk is full."""
    begin = monotonic()
    while True:
        try:
            return ask()
        except Unavailable:
            if monotonic() - begin > PATIENCE and has_room(root):
                raise
            sleep(AGAIN)


def _work(job: Job) -> Callable[[RunningJob], None]:
    """Return the function that runs a kind of job; its modules are loaded on demand."""
    work: Callable[[RunningJob], None] = resolve_name(WORK.get(job.kind, VERB))
    return work


def _cancel(_signal: int, _frame: FrameType | None) -> None:
    # Libraries that are interrupted would log misleading errors.
    logging.disable(logging.CRITICAL)
    raise Cancelled


def _cancel_again(others: UnraisableHook, caught: "sys.UnraisableHookArgs") -> None:
    """Raise Cancelled once more after it came within a destructor, where nothing catches it."""
    if caught.exc_type is not Cancelled:
        others(caught)
        return
    again = Timer(SOON, signal.pthread_kill, (main_thread().ident, signal.SIGTERM))
    again.daemon = True
    again.start()


def _too_late(_signal: int, _frame: FrameType | None) -> None:
    """Ignore a request to end: the job has ended."""
