"""Takes jobs from the queue and runs each in a process of its own.

One runner works for a data folder: a lock on a file of it says so. Processes are forked from
one that has loaded everything, so that a job starts in some hundredths of a second; a job that
crashes, or takes all memory, takes nothing else with it. A database that does not answer for a
while (it is locked, the disk is full, the folder was moved away) ends nobody: what is to be
said is said later. Running state.
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
"""s between two looks at the queue"""

BEAT = 2.0
"""s between two signs of life"""

GRACE = 5.0
"""s that a cancelled job has to end by itself"""

LONGEST = 2 * 3600.0
"""time limit of a job without user input, s: a longer one is a mistake, or an attack"""

LONGEST_PACED = 12 * 3600.0
"""s of a job that waits for people or the clock: longer than a shift it was forgotten"""

MOST_PACED = 16
"""runs that wait for people or the clock, at once"""

LOG = structlog.get_logger("runner")


@dataclass(kw_only=True)
class Running:
    """A job and its process."""

    job: Job
    process: ForkServerProcess
    began_at: float = field(default_factory=time.monotonic)
    asked_at: float | None = None
    """when it was asked to end"""
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
    """jobs at once, paced ones aside"""
    is_stopping: bool = False
    running: dict[str, Running] = field(default_factory=dict)
    _ends: list[SilentEnd] = field(default_factory=list)
    """that are not in the database yet"""
    _has_recovered: bool = False
    _is_answered: bool = True
    _beaten_at: float = -BEAT

    def run(self, *, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Work until the end; jobs that run then are queued again by the next runner."""
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
        """Once, until it answers again."""
        if self._is_answered:
            LOG.warning("the database does not answer", reason=str(error))
        self._is_answered = False

    def _turn(self, context: multiprocessing.context.ForkServerContext) -> None:
        """All that needs the database: what could not be done now is done in the next turn."""
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
        """For one more job that is paced, or is not."""
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
        """See who has ended, and who should."""
        for id, each in list(self.running.items()):
            if not each.process.is_alive():
                del self.running[id]
                self._ended(each)
            elif time.monotonic() - each.began_at > _longest(each.job):
                each.is_overdue = True
                each.process.kill()

    def _ended(self, each: Running) -> None:
        """A process has ended; one that said nothing of its job was lost."""
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
        """Nothing goes on without a runner."""
        for each in self.running.values():
            # Whatever is wrong with one, the others end.
            with suppress(OSError, ValueError):
                each.process.kill()
        for each in self.running.values():
            with suppress(OSError, ValueError):
                each.process.join()


def _longest(job: Job) -> float:
    """S that a job may take."""
    return LONGEST_PACED if job.is_paced else LONGEST


def _too_long(job: Job) -> dict[str, Any]:
    """The problem of a job that did not come to an end."""
    detail = (
        f"it was not over after {_longest(job) / 3600.0:g} h, which is the most for such a job"
    )
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
    """A sign of life."""
    with data_folder.database.writing() as connection:
        connection.execute(
            "INSERT INTO runner VALUES (1, ?, ?) "
            "ON CONFLICT (id) DO UPDATE SET pid = excluded.pid, seen = excluded.seen",
            (os.getpid(), time.time()),
        )


def is_alive(data_folder: DataFolder) -> bool:
    """Whether a runner has shown a heartbeat lately."""
    with data_folder.database.reading() as connection:
        row = connection.execute("SELECT seen FROM runner").fetchone()
    return row is not None and time.time() - float(row["seen"]) < 5.0 * BEAT


def locked(root: Path, name: str = "runner") -> IO[bytes]:
    """The lock of the folder's only runner, or server; free again when the process ends.

    Raises
    ------
    Conflict
        When another has it.
    """
    file = (root / f"{name}.lock").open("wb")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        file.close()
        raise Conflict(f"{root}: another server works with this folder") from error
    return file


def main(root: str, knowledge: str, workers: int, parent: int) -> None:
    """Run jobs as long as the server lives that started this process.

    Raises
    ------
    ServiceError
        When the folder cannot be used.
    """
    data_folder = known_data_folder(Path(root), knowledge=knowledge)
    with locked(data_folder.root):
        with open_store(data_folder.knowledge):
            """made when it is new"""
        runner = Runner(data_folder=data_folder, workers=workers)

        def stop(_signal: int, _frame: FrameType | None) -> None:
            runner.is_stopping = True

        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        runner.run(is_wanted=lambda: os.getppid() == parent)
