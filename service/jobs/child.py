"""What runs in the process of one job. It ends with the runner that started it."""

import signal
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from service.depot import jobs
from service.depot.folder import open_depot
from service.depot.jobs import Job, Kind, State
from service.jobs.task import Task
from service.lifeline import end_with_parent
from service.problem import plain_problem, problem_of
from stepnc_model.errors import StepNcError


class Cancelled(BaseException):
    """The runner has asked for the end; what is half done is cleaned away on the way out."""


def main(root: str, knowledge: str, id: str) -> None:
    """Run a job that was claimed, and say how it ended."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    depot = open_depot(Path(root), knowledge=knowledge)
    job = jobs.get(depot, id)
    task = Task(depot=depot, job=job)
    state, problem = State.SUCCEEDED, None
    try:
        signal.signal(signal.SIGTERM, _cancel)
        task.folder.mkdir(mode=0o700, exist_ok=True)
        _work(job)(task)
    except Cancelled:
        state = State.CANCELLED
    except StepNcError as error:
        state, problem = State.FAILED, problem_of(error, hidden=str(depot.root))
    except MemoryError:
        detail = "the job needed more memory than there is"
        state, problem = State.FAILED, plain_problem(507, "Out of memory", detail)
    except BaseException:
        # Told to the log of the server; a client hears that it is not its fault.
        detail = f"job '{id}' met a fault of the program; the server's log says more"
        jobs.finish(depot, job, State.FAILED, problem=plain_problem(500, "Fault", detail))
        raise
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    jobs.finish(depot, job, state, problem=problem)


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
    raise Cancelled
