"""Takes jobs from the queue and runs each in a process of its own.

One runner works for a data folder: a lock on a file of it says so. Processes are forked from
one that has loaded everything, so that a job starts in some hundredths of a second; a job that
crashes, or takes all memory, takes nothing else with it. Running state.
"""

import fcntl
import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing import forkserver
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from types import FrameType
from typing import IO

import structlog

from kbe.store import open_store
from service.depot import jobs
from service.depot.folder import Depot, open_depot
from service.depot.jobs import Job, Kind, State
from service.errors import Conflict
from service.jobs import child

LOOK = 0.05
"""s between two looks at the queue"""

BEAT = 2.0
"""s between two signs of life"""

GRACE = 5.0
"""s that a cancelled job has to end by itself"""

LONGEST = 2 * 3600.0
"""s of a job with which nobody talks: a program that takes longer is a slip, or an attack"""

MOST_LIVE = 16
"""runs that somebody may steer, at once: they mostly wait"""

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

    @property
    def is_bounded(self) -> bool:
        """Whether it must be over after some time: nobody watches it at the machine's pace."""
        return not self.job.kind.is_live and not self.job.request.get("pace")


@dataclass(kw_only=True)
class Runner:
    """Runs jobs until it is told to stop. Running state."""

    depot: Depot
    workers: int
    """jobs at once, live runs aside"""
    longest: float = LONGEST
    """s of a job that is no live run"""
    is_stopping: bool = False
    running: dict[str, Running] = field(default_factory=dict)

    def run(self, *, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Work until the end; jobs that run then are queued again by the next runner."""
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["service.jobs.preloaded"])
        forkserver.ensure_running()
        jobs.recover(self.depot)
        beaten = 0.0
        try:
            while is_wanted() and not self.is_stopping:
                if time.monotonic() - beaten > BEAT:
                    beaten = time.monotonic()
                    beat(self.depot)
                self._look()
                for kinds in self._free():
                    job = jobs.claim(self.depot, kinds=kinds)
                    if job is not None:
                        self._start(context, job)
                time.sleep(LOOK)
        finally:
            self._end_all()

    def _free(self) -> list[list[Kind]]:
        """Kinds of jobs for which there is room."""
        live = sum(each.job.kind.is_live for each in self.running.values())
        free = []
        if len(self.running) - live < self.workers:
            free.append([kind for kind in Kind if not kind.is_live])
        if live < MOST_LIVE:
            free.append([kind for kind in Kind if kind.is_live])
        return free

    def _start(self, context: multiprocessing.context.ForkServerContext, job: Job) -> None:
        LOG.info("job started", job=job.id, kind=job.kind.value, attempt=job.attempt)
        arguments = (str(self.depot.root), self.depot.knowledge, job.id)
        process = context.Process(target=child.main, args=arguments, daemon=False)
        process.start()
        self.running[job.id] = Running(job=job, process=process)

    def _look(self) -> None:
        """See who has ended, and who should."""
        if not self.running:
            return
        cancelling = {job.id for job in jobs.running(self.depot) if job.is_cancelling}
        for id, each in list(self.running.items()):
            if not each.process.is_alive():
                self._ended(each)
                del self.running[id]
            elif id in cancelling:
                _ask_to_end(each)
            elif each.is_bounded and time.monotonic() - each.began_at > self.longest:
                each.is_overdue = True
                each.process.kill()

    def _ended(self, each: Running) -> None:
        """A process has ended; one that said nothing of its job was lost."""
        code = each.process.exitcode
        each.process.close()
        state = State.CANCELLED if each.asked_at is not None else State.FAILED
        why = f"after {self.longest:g} s, the most" if each.is_overdue else _why(code)
        problem = None if state is State.CANCELLED else jobs.lost(why)
        jobs.finish(self.depot, each.job, state, problem=problem)
        LOG.info("job ended", job=each.job.id, kind=each.job.kind.value, exit_code=code)

    def _end_all(self) -> None:
        """Nothing goes on without a runner."""
        for each in self.running.values():
            each.process.kill()
        for each in self.running.values():
            each.process.join()


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


def beat(depot: Depot) -> None:
    """A sign of life."""
    with depot.database.writing() as connection:
        connection.execute(
            "INSERT INTO runner VALUES (1, ?, ?) "
            "ON CONFLICT (id) DO UPDATE SET pid = excluded.pid, seen = excluded.seen",
            (os.getpid(), time.time()),
        )


def is_alive(depot: Depot) -> bool:
    """Whether a runner has given a sign of life lately."""
    with depot.database.reading() as connection:
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
    depot = open_depot(Path(root), knowledge=knowledge)
    with locked(depot.root):
        with open_store(depot.knowledge):
            """made when it is new"""
        runner = Runner(depot=depot, workers=workers)

        def stop(_signal: int, _frame: FrameType | None) -> None:
            runner.is_stopping = True

        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        runner.run(is_wanted=lambda: os.getppid() == parent)
