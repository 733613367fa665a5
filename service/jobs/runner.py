"""Runner that takes jobs from the queue and runs each in its own process.

Only one runner works on a data folder, which a lock file ensures. Job processes are forked from
a process that has loaded everything, so that a job starts within some hundredths of a second; a
job that crashes or takes all memory affects nothing else. When the database does not answer for
a while (it is locked, the disk is full, the folder was moved away), no job is ended: results
are recorded later. Running state.
"""

import fcntl
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import forkserver
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from types import FrameType
from typing import IO, Any

import structlog

from kbe.store import open_store
from service.errors import Conflict, Unavailable
from service.jobs import child
from service.jobs.task import UNFINISHED, clear
from service.problem import plain_problem
from service.storage import jobs
from service.storage.folder import DataFolder, known_data_folder
from service.storage.jobs import Job, JobState

LOOK = 0.05
"""Interval between two looks at the queue, in s."""

BEAT = 2.0
"""Interval between two heartbeats, in s."""

GRACE = 5.0
"""Time that a cancelled job has to end by itself, in s."""

LONGEST = 2 * 3600.0
"""Time limit of a job without user input, in s; a longer job is a mistake or an attack."""

LONGEST_PACED = 12 * 3600.0
"""Time limit of a paced job, in s; one that lasts longer than a shift was forgotten."""

MOST_PACED = 16
"""Largest number of paced jobs that run at once."""

LOG = structlog.get_logger("runner")


@dataclass(kw_only=True)
class Running:
    """Job with its running process."""

    job: Job
    process: ForkServerProcess
    began_at: float = field(default_factory=time.monotonic)
    asked_at: float | None = None
    """Time when the job was asked to end, in s; None if it was not."""
    is_overdue: bool = False


@dataclass(frozen=True, kw_only=True)
class SilentEnd:
    """End of a job whose process did not report one."""

    job: Job
    state: JobState
    problem: Mapping[str, Any] | None


@dataclass(kw_only=True)
class Runner:
    """Runs jobs until it is told to stop. Running state."""

    data_folder: DataFolder
    workers: int
    """Largest number of jobs that run at once, without paced ones."""
    is_stopping: bool = False
    running: dict[str, Running] = field(default_factory=dict)
    _ends: list[SilentEnd] = field(default_factory=list)
    """Ends of jobs that are not recorded in the database yet."""
    _has_recovered: bool = False
    _is_answered: bool = True
    _beaten_at: float = -BEAT

    def run(self, *, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Run jobs until told to stop; the next runner queues unfinished jobs again."""
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["service.jobs.preloaded"])
        forkserver.ensure_running()
        try:
            while is_wanted() and not self.is_stopping:
                self._look()
                try:
                    self._turn(context)
                    self._is_answered = True
                except Unavailable as error:
                    self._tell(error)
                time.sleep(LOOK)
        finally:
            self._end_all()

    def _tell(self, error: Unavailable) -> None:
        """Log that the database does not answer; once, until it answers again."""
        if self._is_answered:
            LOG.warning("the database does not answer", reason=str(error))
        self._is_answered = False

    def _turn(self, context: multiprocessing.context.ForkServerContext) -> None:
        """Do all work that needs the database; what fails is repeated in the next turn."""
        if not self._has_recovered:
            jobs.recover(self.data_folder)
            self._has_recovered = True
        if time.monotonic() - self._beaten_at > BEAT:
            beat(self.data_folder)
            self._beaten_at = time.monotonic()
        while self._ends:
            end = self._ends[0]
            jobs.finish(self.data_folder, end.job, end.state, problem=end.problem)
            del self._ends[0]
        if self.running:
            for job in jobs.running(self.data_folder):
                if job.is_cancelling and job.id in self.running:
                    _ask_to_end(self.running[job.id])
        for is_paced in (False, True):
            if self._has_room(is_paced=is_paced):
                claimed = jobs.claim(self.data_folder, is_paced=is_paced)
                if claimed is not None:
                    self._start(context, claimed)

    def _has_room(self, *, is_paced: bool) -> bool:
        """Whether one more paced, or one more other job may start."""
        count = sum(each.job.is_paced == is_paced for each in self.running.values())
        return count < (MOST_PACED if is_paced else self.workers)

    def _start(self, context: multiprocessing.context.ForkServerContext, job: Job) -> None:
        LOG.info("job started", job=job.id, kind=job.kind.value, attempt=job.attempt)
        arguments = (str(self.data_folder.root), self.data_folder.knowledge, job.id)
        process = context.Process(target=child.main, args=arguments, daemon=False)
        try:
            process.start()
        except (OSError, EOFError) as error:
            problem = jobs.lost(f"it could not be started: {error}")
            self._ends.append(SilentEnd(job=job, state=JobState.FAILED, problem=problem))
            return
        self.running[job.id] = Running(job=job, process=process)

    def _look(self) -> None:
        """Detect ended processes, and kill jobs that exceed their time limit."""
        for id, each in list(self.running.items()):
            if not each.process.is_alive():
                del self.running[id]
                self._ended(each)
            elif time.monotonic() - each.began_at > _longest(each.job):
                each.is_overdue = True
                each.process.kill()

    def _ended(self, each: Running) -> None:
        """Record the end of a process; a job whose process reported no end counts as lost."""
        job, code = each.job, each.process.exitcode
        each.process.close()
        clear(self.data_folder.job_folder(job.id), UNFINISHED)
        if each.asked_at is not None:
            end = SilentEnd(job=job, state=JobState.CANCELLED, problem=None)
        elif each.is_overdue:
            end = SilentEnd(job=job, state=JobState.FAILED, problem=_too_long(job))
        else:
            end = SilentEnd(job=job, state=JobState.FAILED, problem=jobs.lost(_why(code)))
        self._ends.append(end)
        LOG.info("job ended", job=job.id, kind=job.kind.value, exit_code=code)

    def _end_all(self) -> None:
        """Kill all job processes, because none may go on without a runner."""
        for each in self.running.values():
            # An error with one process must not keep the others alive.
            with suppress(OSError, ValueError):
                each.process.kill()
        for each in self.running.values():
            with suppress(OSError, ValueError):
                each.process.join()


def _longest(job: Job) -> float:
    """Time limit of a job, in s."""
    return LONGEST_PACED if job.is_paced else LONGEST


def _too_long(job: Job) -> dict[str, Any]:
    """Return the problem of a job that exceeded its time limit."""
    detail = f"not finished after {_longest(job) / 3600.0:g} h, the time limit of such a job"
    return plain_problem(422, "Too long", detail)


def _ask_to_end(each: Running) -> None:
    now = time.monotonic()
    if each.asked_at is None:
        each.asked_at = now
        each.process.terminate()
    elif now - each.asked_at > GRACE:
        each.process.kill()


def _why(code: int | None) -> str:
    if code is not None and code < 0:
        return f"by {signal.Signals(-code).name}"
    return f"exit code {code}"


def beat(data_folder: DataFolder) -> None:
    """Record a heartbeat of the runner."""
    with data_folder.database.writing() as connection:
        connection.execute(
            "INSERT INTO runner VALUES (1, ?, ?) "
            "ON CONFLICT (id) DO UPDATE SET pid = excluded.pid, seen = excluded.seen",
            (os.getpid(), time.time()),
        )


def is_alive(data_folder: DataFolder) -> bool:
    """Whether a runner has recorded a heartbeat recently."""
    with data_folder.database.reading() as connection:
        row = connection.execute("SELECT seen FROM runner").fetchone()
    return row is not None and time.time() - float(row["seen"]) < 5.0 * BEAT


def locked(root: Path, name: str = "runner") -> IO[bytes]:
    """Lock the folder for a single runner or server; released when the process ends.

    Raises
    ------
    Conflict
        When another process holds the lock.
    """
    file = (root / f"{name}.lock").open("wb")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        file.close()
        raise Conflict(f"{root}: another server is using this folder") from error
    return file


def main(root: str, knowledge: str, workers: int, parent: int) -> None:
    """Run jobs as long as the server lives that started this process.

    Raises
    ------
    ServiceError
        When the data folder cannot be used.
    """
    data_folder = known_data_folder(Path(root), knowledge=knowledge)
    with locked(data_folder.root):
        with open_store(data_folder.knowledge):
            """The store is created if it is new."""
        runner = Runner(data_folder=data_folder, workers=workers)

        def stop(_signal: int, _frame: FrameType | None) -> None:
            runner.is_stopping = True

        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        runner.run(is_wanted=lambda: os.getppid() == parent)
