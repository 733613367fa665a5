"""Runner that takes jobs from the queue and runs each in its own process.

Only one runner works on a data folder, which a lock file ensures; runners of several hosts may
share a database. One that gives no sign of life for the time of its lease loses its jobs to
another, but only to one that has heard the database for as long: after the database itself was
away, nobody is taken for dead. Job processes are forked from
a process that has loaded everything, so that a job starts within some hundredths of a second; a
job that crashes or takes all memory affects nothing else. When the database does not answer for
a while (it is locked, the disk is full, the folder was moved away), no job is ended: results
are recorded later. Running state.
"""

import fcntl
import multiprocessing
import os
import signal
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import forkserver
from multiprocessing.connection import wait
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from types import FrameType
from typing import IO, Any

import structlog

from service.errors import Conflict, Unavailable
from service.files import write_atomically
from service.ids import new_id
from service.jobs import child
from service.jobs.task import clear
from service.knowledge.verbs import require_usable
from service.live.journal import storing
from service.processes import log_lines
from service.processes.process_limits import GIB, ProcessLimits
from service.storage import jobs
from service.storage.folder import DataFolder, FolderAddress, known_data_folder
from service.storage.jobs import Job, JobState
from service.storage.results import UNFINISHED
from service.web.problem import plain_problem
from stepnc_model.units import hours_from_seconds

LOOK = 0.05
"""Interval between two looks at the queue, in s."""

BEAT = 2.0
"""Interval between two heartbeats, in s."""

LEASE = 5.0
"""Number of missed heartbeats after which a runner is taken for dead."""

GRACE = 5.0
"""Time that a cancelled job has to end by itself, in s."""

LONGEST = 2 * 3600.0
"""Time limit of a job without user input, in s; a longer job is a mistake or an attack."""

LONGEST_PACED = 12 * 3600.0
"""Time limit of a paced job, in s; one that lasts longer than a shift was forgotten."""

MOST_MEMORY = 8 * GIB
"""Usual greatest address space of a job, bytes; its libraries alone reserve 1 to 2 GB."""

MOST_PACED = 16
"""Largest number of paced jobs that run at once."""

LOADED = ("service.jobs.preloaded_common", "service.jobs.preloaded")
"""Modules that jobs find loaded."""

LOG = structlog.get_logger("runner")


@dataclass(kw_only=True)
class Running:
    """Job with its running process."""

    job: Job
    process: ForkServerProcess
    began_at: float = field(default_factory=time.monotonic)
    cancel_time: float | None = None
    """Time when the job was asked to end, in s; None if it was not."""
    is_overdue: bool = False
    over_since: float | None = None
    """Time since when the job is not running any more, or not this attempt of it, in s."""


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
    name: str = ""
    """Name of the runner in the database."""
    level: str = "info"
    """Level of the log of its jobs."""
    memory: int = MOST_MEMORY
    """Greatest address space of a job, bytes."""
    is_stopping: bool = False
    running: dict[str, Running] = field(default_factory=dict)
    _ends: list[SilentEnd] = field(default_factory=list)
    """Ends of jobs that are not recorded in the database yet."""
    _is_answered: bool = True
    _beaten_at: float | None = None
    _heard_since: float = 0.0
    """Time since when each heartbeat was recorded before the next was due."""

    def run(self, *, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Run jobs until told to stop; the next runner queues unfinished jobs again."""
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload([log_lines.FORKED, *LOADED, "service.jobs.frozen"])
        forkserver.ensure_running()
        try:
            while is_wanted() and not self.is_stopping:
                self._look()
                try:
                    self._turn(context)
                    self._is_answered = True
                except Unavailable as error:
                    self._tell(error)
                # The end of a process makes room for the next job at once.
                wait([each.process.sentinel for each in self.running.values()], timeout=LOOK)
        finally:
            self._end_all()

    def _tell(self, error: Unavailable) -> None:
        """Log that the database does not answer; once, until it answers again."""
        if self._is_answered:
            LOG.warning("the database does not answer", reason=str(error))
        self._is_answered = False

    def _turn(self, context: multiprocessing.context.ForkServerContext) -> None:
        """Do all work that needs the database; what fails is repeated in the next turn."""
        self._beat()
        while self._ends:
            end = self._ends[0]
            jobs.finish(self.data_folder, end.job, end.state, problem=end.problem)
            del self._ends[0]
        if self.running:
            claimed = {job.id: job for job in self._claimed()}
            for id, each in self.running.items():
                self._follow(each, claimed.get(id))
        for is_paced in (False, True):
            while self._has_room(is_paced=is_paced) and self._claim(context, is_paced):
                """One more."""

    def _beat(self) -> None:
        """Record a heartbeat when it is due, and take over jobs of runners that are gone."""
        now = time.monotonic()
        if self._beaten_at is not None and now - self._beaten_at <= BEAT:
            return
        beat(self.data_folder, self.name)
        if self._beaten_at is None or now - self._beaten_at > LEASE * BEAT:
            self._heard_since = now
        self._beaten_at = now
        # Jobs of an earlier process of this runner, and claims whose answer was lost.
        mine = {end.job.id for end in self._ends} | set(self.running)
        lost = [job for job in self._claimed() if job.id not in mine]
        if now - self._heard_since > LEASE * BEAT:
            lost += jobs.abandoned(self.data_folder, lease=LEASE * BEAT)
        if lost:
            LOG.info("jobs recovered", jobs=[job.id for job in lost])
            jobs.recover(self.data_folder, lost)

    def _claimed(self) -> tuple[Job, ...]:
        return jobs.running(self.data_folder, runner=self.name)

    @staticmethod
    def _follow(running: Running, now: Job | None) -> None:
        """End the process of a job that was cancelled, or taken over by another runner."""
        if now is not None and now.attempt == running.job.attempt:
            if now.is_cancelling:
                _ask_to_end(running)
        elif running.over_since is None:
            # Most often it has just ended by itself.
            running.over_since = time.monotonic()
        elif time.monotonic() - running.over_since > GRACE:
            _ask_to_end(running)

    def _has_room(self, *, is_paced: bool) -> bool:
        """True if one more paced, or one more other job may start."""
        count = sum(each.job.is_paced == is_paced for each in self.running.values())
        return count < (MOST_PACED if is_paced else self.workers)

    def _claim(
        self, context: multiprocessing.context.ForkServerContext, is_paced: bool
    ) -> bool:
        """Start the next job; False if there is none, or none can be started."""
        job = jobs.claim(self.data_folder, is_paced=is_paced, runner=self.name)
        if job is None:
            return False
        before = self.running.pop(job.id, None)
        if before is not None:
            # Another runner has taken this one for dead, and queued its job again.
            before.process.kill()
            before.process.join()
        return self._start(context, job)

    def _start(self, context: multiprocessing.context.ForkServerContext, job: Job) -> bool:
        LOG.info("job started", job=job.id, kind=job.kind.value, attempt=job.attempt)
        limits = ProcessLimits(memory=self.memory, processor=_processor(job))
        address = self.data_folder.address
        arguments = (self.level, child.limited_main, limits, address, job.id, job.attempt)
        process = context.Process(target=log_lines.reported, args=arguments, daemon=False)
        try:
            process.start()
        except (OSError, EOFError) as error:
            problem = jobs.lost(f"it could not be started: {error}")
            self._ends.append(SilentEnd(job=job, state=JobState.FAILED, problem=problem))
            return False
        self.running[job.id] = Running(job=job, process=process)
        return True

    def _look(self) -> None:
        """Detect ended processes, and kill jobs that exceed their time limit."""
        for id, each in list(self.running.items()):
            if not each.process.is_alive():
                del self.running[id]
                self._ended(each)
            elif time.monotonic() - each.began_at > _longest(each.job):
                each.is_overdue = True
                each.process.kill()

    def _ended(self, running: Running) -> None:
        """Record the end of a process; a job whose process reported no end counts as lost."""
        job, code = running.job, running.process.exitcode
        running.process.close()
        clear(self.data_folder.attempt_folder(job.id, job.attempt), UNFINISHED)
        if running.cancel_time is not None:
            end = SilentEnd(job=job, state=JobState.CANCELLED, problem=None)
        elif running.is_overdue:
            end = SilentEnd(job=job, state=JobState.FAILED, problem=_too_long(job))
        elif code == -signal.SIGXCPU:
            problem = plain_problem(
                422,
                "Too long",
                f"took more than {hours_from_seconds(_processor(job)):g} h of processor time, "
                "the limit of such a job",
            )
            end = SilentEnd(job=job, state=JobState.FAILED, problem=problem)
        else:
            problem = jobs.lost(_why(code, self.memory))
            end = SilentEnd(job=job, state=JobState.FAILED, problem=problem)
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


def _processor(job: Job) -> int:
    """Limit of processor time of a job, s: it may use all processors for its time."""
    return int(_longest(job)) * (os.cpu_count() or 1)


def _too_long(job: Job) -> dict[str, Any]:
    """Return the problem of a job that exceeded its time limit."""
    hours = hours_from_seconds(_longest(job))
    detail = f"not finished after {hours:g} h, the time limit of such a job"
    return plain_problem(422, "Too long", detail)


def _ask_to_end(running: Running) -> None:
    now = time.monotonic()
    if running.cancel_time is None:
        running.cancel_time = now
        running.process.terminate()
    elif now - running.cancel_time > GRACE:
        running.process.kill()


def _why(code: int | None, memory: int) -> str:
    if code in {-signal.SIGABRT, -signal.SIGSEGV, -signal.SIGBUS}:
        name = signal.Signals(-code).name
        return f"by {name}, as where a library lacks memory: a job may take {memory / GIB:g} GB"
    if code is not None and code < 0:
        return f"by {signal.Signals(-code).name}"
    return f"exit code {code}"


def beat(data_folder: DataFolder, name: str = "") -> None:
    """Record a heartbeat of a runner."""
    with data_folder.database.writing() as connection:
        connection.execute(
            "INSERT INTO runner VALUES (?, ?, wall_clock()) "
            "ON CONFLICT (id) DO UPDATE SET pid = excluded.pid, seen = excluded.seen",
            (name, os.getpid()),
        )


def is_alive(data_folder: DataFolder) -> bool:
    """True if a runner, of this host or another one, has recorded a heartbeat recently."""
    query = "SELECT 1 FROM runner WHERE seen > wall_clock() - ? LIMIT 1"
    with data_folder.database.reading() as connection:
        return connection.execute(query, (LEASE * BEAT,)).fetchone() is not None


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


def own_name(data_folder: DataFolder) -> str:
    """Return the name of the runner of a data folder; the lock must be held.

    It stays the same from start to start, so that a new process takes up at once what its
    predecessor has left. An embedded database has one runner, without a name.

    Raises
    ------
    Unavailable
        When the name cannot be kept in the folder.
    """
    if not data_folder.database.is_shared:
        return ""
    file = data_folder.root / "runner.name"
    with storing(file.name):
        if not file.is_file():
            write_atomically(file, f"{new_id()}\n".encode())
        # A folder that was copied to another host must not have the same name there.
        return f"{socket.gethostname()} {file.read_text('ascii').strip()}"


def main(
    folder: FolderAddress,
    workers: int,
    parent: int,
    *,
    level: str = "info",
    memory: int = MOST_MEMORY,
) -> None:
    """Run jobs as long as the server lives that started this process.

    Raises
    ------
    ServiceError
        When the data folder cannot be used.
    """
    data_folder = known_data_folder(folder)
    with locked(data_folder.root):
        if reason := require_usable(data_folder.knowledge):
            LOG.warning("the knowledge base can only be read", reason=reason)
        runner = Runner(
            data_folder=data_folder,
            workers=workers,
            name=own_name(data_folder),
            level=level,
            memory=memory,
        )

        def stop(_signal: int, _frame: FrameType | None) -> None:
            runner.is_stopping = True

        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        runner.run(is_wanted=lambda: os.getppid() == parent)
