"""Process of one job. It ends with the runner that started it."""

import logging
import signal
from collections.abc import Callable, Mapping
from pathlib import Path
from time import monotonic, sleep
from types import FrameType
from typing import Any, TypeVar

from kbe.errors import StoreFull
from service.errors import StorageFull, Unavailable
from service.jobs.task import LARGE, UNFINISHED, RunningJob, clear
from service.lifeline import end_with_parent
from service.problem import plain_problem, problem_of
from service.storage import jobs
from service.storage.folder import known_data_folder
from service.storage.jobs import Job, JobKind, JobState
from stepnc_model.errors import StepNcError, WriteError

T = TypeVar("T")

WITHOUT_ROOM = (StorageFull, StoreFull, WriteError)
"""errors of a job that found no room on the disk"""

PATIENCE = 60.0
"""s for which a database that does not answer is asked again"""

AGAIN = 1.0
"""s between two such questions"""


COMPILERS = "simulator.kernels"
"""logger that says why a first run waits"""


class ProgressHandler(logging.Handler):
    """Log handler that shows a library's messages as progress: the server's log is JSON."""

    def __init__(self, task: RunningJob) -> None:
        super().__init__()
        self._task = task

    def emit(self, record: logging.LogRecord) -> None:
        """Show a message as progress of the job."""
        self._task.progress(0.0, record.getMessage())


class Cancelled(BaseException):
    """The runner has asked for the end; what is half done is cleaned away on the way out."""


def main(root: str, knowledge: str, id: str) -> None:
    """Run a job that was claimed, and say how it ended."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    data_folder = _insisting(lambda: known_data_folder(Path(root), knowledge=knowledge))
    job = _insisting(lambda: jobs.get(data_folder, id))
    task = RunningJob(data_folder=data_folder, job=job)
    _say_as_progress(task)
    state, problem = JobState.SUCCEEDED, None
    try:
        signal.signal(signal.SIGTERM, _cancel)
        task.make_folder()
        _work(job)(task)
    except Cancelled:
        state = JobState.CANCELLED
    except StepNcError as error:
        state, problem = JobState.FAILED, problem_of(error, hidden=str(data_folder.root))
        if isinstance(error, WITHOUT_ROOM):
            clear(task.folder, LARGE)
    except MemoryError:
        detail = "the job needed more memory than there is"
        state, problem = JobState.FAILED, plain_problem(507, "Out of memory", detail)
    except BaseException:
        # Told to the log of the server; a client hears that it is not its fault.
        detail = f"job '{id}' met a fault of the program; the server's log says more"
        _finish(task, JobState.FAILED, plain_problem(500, "Fault", detail))
        raise
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    _finish(task, state, problem)


def _say_as_progress(task: RunningJob) -> None:
    """Show the compilers' messages as progress of the job."""
    compilers = logging.getLogger(COMPILERS)
    compilers.addHandler(ProgressHandler(task))
    compilers.propagate = False


def _finish(task: RunningJob, state: JobState, problem: Mapping[str, Any] | None) -> None:
    """Say how it ended."""
    if state is not JobState.SUCCEEDED:
        clear(task.folder, UNFINISHED)
    _insisting(lambda: jobs.finish(task.data_folder, task.job, state, problem=problem))


def _insisting(ask: Callable[[], T]) -> T:
    """Result of a database call, which is repeated for a while when it fails."""
    begin = monotonic()
    while True:
        try:
            return ask()
        except Unavailable:
            if monotonic() - begin > PATIENCE:
                raise
            sleep(AGAIN)


def _work(job: Job) -> Callable[[RunningJob], None]:
    """Function of a kind of job; its modules are loaded when it runs."""
    match job.kind:
        case JobKind.ADVICE:
            from service.jobs import advise  # noqa: PLC0415

            return advise.run
        case JobKind.SIMULATION:
            from service.jobs import simulate  # noqa: PLC0415

            return simulate.run
        case JobKind.CONTROL | JobKind.TRIAL:
            from service.jobs import steer  # noqa: PLC0415

            return steer.run_trial if job.kind is JobKind.TRIAL else steer.run_control
        case JobKind.EVALUATION | JobKind.REVIEW:
            from service.jobs import evaluate  # noqa: PLC0415

            is_review = job.kind is JobKind.REVIEW
            return evaluate.run_review if is_review else evaluate.run_evaluation


def _cancel(_signal: int, _frame: FrameType | None) -> None:
    # Libraries that are left in the middle of something say so as if it were a fault.
    logging.disable(logging.CRITICAL)
    raise Cancelled
