"""What runs in the process of one job. It ends with the runner that started it."""

import logging
import signal
from collections.abc import Callable, Mapping
from pathlib import Path
from time import monotonic, sleep
from types import FrameType
from typing import Any, TypeVar

from kbe.errors import StoreFull
from service.depot import jobs
from service.depot.folder import known_depot
from service.depot.jobs import Job, Kind, State
from service.errors import StorageFull, Unavailable
from service.jobs.task import LARGE, UNFINISHED, Task, clear
from service.lifeline import end_with_parent
from service.problem import plain_problem, problem_of
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


class Words(logging.Handler):
    """What a library says while a job runs, as its progress: the server's log is JSON."""

    def __init__(self, task: Task) -> None:
        super().__init__()
        self._task = task

    def emit(self, record: logging.LogRecord) -> None:
        """Tell whoever watches the job."""
        self._task.progress(0.0, record.getMessage())


class Cancelled(BaseException):
    """The runner has asked for the end; what is half done is cleaned away on the way out."""


def main(root: str, knowledge: str, id: str) -> None:
    """Run a job that was claimed, and say how it ended."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    depot = _insisting(lambda: known_depot(Path(root), knowledge=knowledge))
    job = _insisting(lambda: jobs.get(depot, id))
    task = Task(depot=depot, job=job)
    _say_as_progress(task)
    state, problem = State.SUCCEEDED, None
    try:
        signal.signal(signal.SIGTERM, _cancel)
        task.make_folder()
        _work(job)(task)
    except Cancelled:
        state = State.CANCELLED
    except StepNcError as error:
        state, problem = State.FAILED, problem_of(error, hidden=str(depot.root))
        if isinstance(error, WITHOUT_ROOM):
            clear(task.folder, LARGE)
    except MemoryError:
        detail = "the job needed more memory than there is"
        state, problem = State.FAILED, plain_problem(507, "Out of memory", detail)
    except BaseException:
        # Told to the log of the server; a client hears that it is not its fault.
        detail = f"job '{id}' met a fault of the program; the server's log says more"
        _finish(task, State.FAILED, plain_problem(500, "Fault", detail))
        raise
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    _finish(task, state, problem)


def _say_as_progress(task: Task) -> None:
    """Let compilers of kernels say in the job why it waits."""
    compilers = logging.getLogger(COMPILERS)
    compilers.addHandler(Words(task))
    compilers.propagate = False


def _finish(task: Task, state: State, problem: Mapping[str, Any] | None) -> None:
    """Say how it ended."""
    if state is not State.SUCCEEDED:
        clear(task.folder, UNFINISHED)
    _insisting(lambda: jobs.finish(task.depot, task.job, state, problem=problem))


def _insisting(ask: Callable[[], T]) -> T:
    """What the database answers; when it does not, it is asked again for a while."""
    begin = monotonic()
    while True:
        try:
            return ask()
        except Unavailable:
            if monotonic() - begin > PATIENCE:
                raise
            sleep(AGAIN)


def _work(job: Job) -> Callable[[Task], None]:
    """What a kind of job does; what it needs is loaded when it runs."""
    match job.kind:
        case Kind.ADVICE:
            from service.jobs import advise  # noqa: PLC0415

            return advise.run
        case Kind.SIMULATION:
            from service.jobs import simulate  # noqa: PLC0415

            return simulate.run
        case Kind.CONTROL | Kind.TRIAL:
            from service.jobs import steer  # noqa: PLC0415

            return steer.run_trial if job.kind is Kind.TRIAL else steer.run_control
        case Kind.EVALUATION | Kind.REVIEW:
            from service.jobs import evaluate  # noqa: PLC0415

            is_review = job.kind is Kind.REVIEW
            return evaluate.run_review if is_review else evaluate.run_evaluation


def _cancel(_signal: int, _frame: FrameType | None) -> None:
    # Libraries that are left in the middle of something say so as if it were a fault.
    logging.disable(logging.CRITICAL)
    raise Cancelled
