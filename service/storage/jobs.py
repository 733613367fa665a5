"""Storage of jobs: request, progress and outcome. Results are in a folder of each job.

A job is claimed by one runner at a time; each claim is a new attempt, and updates from an older
attempt are ignored: the number of the attempt is the token without which no end is recorded.
Running jobs whose runner is gone are queued again if their kind may be run twice; otherwise
they are marked as failed.
"""

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any

from service.errors import Conflict, NotFound, TooMany
from service.ids import new_id
from service.live.journal import storing
from service.storage.connection import Connection, StoredRow
from service.storage.files import FIELDS
from service.storage.folder import DataFolder, remove_results, show_again, show_attempt
from service.storage.idempotency import IdempotencyKey, made_before, remember
from service.storage.pages import Page, PageCursor, page_of

MOST_WAITING = 1000
"""Largest number of queued jobs."""

LOCAL = "local"
"""Owner of all requests where no keys are in use; may fill the whole queue."""

OWNERS = 4
"""Number of keys among which the queue is shared, so that none can fill it alone."""

MOST_ATTEMPTS = 3
"""Largest number of attempts of a job whose runner was lost each time."""

MOST_ATTEMPTS_SHARED = 10
"""The same where several hosts take over from each other, as when all are restarted in turn."""


class JobState(StrEnum):
    """State of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def is_finished(self) -> bool:
        """True if the job has ended."""
        return self not in {JobState.QUEUED, JobState.RUNNING}


class JobKind(StrEnum):
    """Kind of job."""

    ADVICE = "advice"
    SIMULATION = "simulation"
    CONTROL = "control-run"
    TRIAL = "trial"
    EVALUATION = "evaluation"
    REVIEW = "review"
    VERIFICATION = "verification"
    CYCLE_TIME = "cycle-time"
    FACTORY = "factory"

    @property
    def is_live(self) -> bool:
        """True if all jobs of the kind steer a machine and can be changed while they run."""
        return self in {JobKind.CONTROL, JobKind.TRIAL}


PACED = (
    f"(kind IN ('{JobKind.CONTROL.value}', '{JobKind.TRIAL.value}') "
    f"OR (kind IN ('{JobKind.SIMULATION.value}', '{JobKind.FACTORY.value}') "
    "AND CAST(coalesce(json_extract(request, '$.pace'), '0') AS REAL) > 0))"
)
"""SQL condition for :attr:`Job.is_paced`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """Job of the service, with its request, progress and outcome."""

    id: str
    kind: JobKind
    state: JobState
    request: Mapping[str, Any]
    program: str
    """Id of the program that the job works on; empty: none."""
    source: str
    """Id of the job whose result this job works on; empty: none."""
    owner: str
    created: float
    """Time of creation, in s since 1970, like the times below."""
    started: float | None
    ended: float | None
    share: float
    """Share of the work done, 0 to 1."""
    message: str
    problem: Mapping[str, Any] | None
    """Problem details (RFC 9457) of a failed job."""
    attempt: int
    is_cancelling: bool

    @property
    def is_live(self) -> bool:
        """True if the job can be changed while it runs; such a job is not run twice."""
        return self.kind.is_live or (self.kind is JobKind.FACTORY and self.is_paced)

    @property
    def is_paced(self) -> bool:
        """True if the job mostly waits for people, or for the clock."""
        return self.kind.is_live or bool(self.request.get("pace"))


COLUMNS = ", ".join(field.name for field in fields(Job))


@dataclass(frozen=True, slots=True, kw_only=True)
class JobRequest:
    """Request to queue a job."""

    kind: JobKind
    request: Mapping[str, Any]
    program: str = ""
    source: str = ""
    owner: str
    key: str = ""
    """Id of the API key that asked, whose share of the queue it takes; empty: none."""


def add(
    data_folder: DataFolder, order: JobRequest, *, idempotency: IdempotencyKey | None = None
) -> Job:
    """Queue a job.

    Raises
    ------
    TooMany
        When too many jobs are queued.
    NotFound
        When the program, or a file that the request names, was deleted meanwhile.
    """
    id = new_id()
    with data_folder.database.writing() as connection:
        kept = made_before(connection, idempotency)
        if kept is None:
            _require_room(connection, order)
            _require_program(connection, order.program)
            _require_files(connection, order.request)
            connection.execute(
                "INSERT INTO jobs "
                "(id, kind, state, request, program, source, owner, created, key) "
                "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    id, order.kind.value, JobState.QUEUED.value, json.dumps(order.request),
                    order.program, order.source, order.owner, time.time(), order.key,
                ),
            )  # fmt: skip
            remember(connection, idempotency, id)
    return get(data_folder, kept or id)


def get(data_folder: DataFolder, id: str, kind: JobKind | None = None) -> Job:
    """Return a job by its id, and of a given kind if one is named.

    Raises
    ------
    NotFound
        When the job does not exist.
    """
    with data_folder.database.reading() as connection:
        row = connection.execute(f"SELECT {COLUMNS} FROM jobs WHERE id = ?", (id,)).fetchone()
    if row is None or (kind is not None and row["kind"] != kind.value):
        raise NotFound("job" if kind is None else kind.value, id)
    return _job(row)


def listed(
    data_folder: DataFolder,
    place: PageCursor,
    *,
    kind: JobKind | None = None,
    state: JobState | None = None,
    program: str = "",
) -> Page[Job]:
    """List jobs page by page, newest first."""
    where, values = ["id < ?"], [place.before]
    for column, wanted in (("kind", kind), ("state", state), ("program", program)):
        if wanted:
            where.append(f"{column} = ?")
            values.append(str(wanted))
    query = f"SELECT {COLUMNS} FROM jobs WHERE {' AND '.join(where)} ORDER BY id DESC LIMIT ?"
    with data_folder.database.reading() as connection:
        rows = connection.execute(query, (*values, place.limit + 1)).fetchall()
    return page_of([_job(row) for row in rows], [row["id"] for row in rows], limit=place.limit)


def counts(data_folder: DataFolder) -> dict[JobState, int]:
    """Return the number of jobs in each state that has any."""
    with data_folder.database.reading() as connection:
        rows = connection.execute("SELECT state, count(*) AS jobs FROM jobs GROUP BY state")
        return {JobState(row["state"]): row["jobs"] for row in rows.fetchall()}


def cancel(data_folder: DataFolder, id: str) -> Job:
    """Request the end of a job; a queued job is cancelled at once.

    Raises
    ------
    NotFound, Conflict
        When the job does not exist, or has ended.
    """
    with data_folder.database.writing() as connection:
        row = connection.execute(
            "UPDATE jobs SET is_cancelling = 1, "
            "ended = CASE WHEN state = 'queued' THEN ? ELSE ended END, "
            "state = CASE WHEN state = 'queued' THEN 'cancelled' ELSE state END "
            f"WHERE id = ? AND state IN ('queued', 'running', 'cancelled') RETURNING {COLUMNS}",
            (time.time(), id),
        ).fetchone()
    if row is not None:
        return _job(row)
    state = get(data_folder, id).state
    raise Conflict(f"job '{id}' has {state.value}: there is nothing to cancel")


def remove(data_folder: DataFolder, id: str) -> None:
    """Delete a job that has ended, and its results.

    Raises
    ------
    NotFound, Conflict
        When the job does not exist, or has not ended.
    """
    with data_folder.database.writing() as connection:
        gone = connection.execute(
            "DELETE FROM jobs WHERE id = ? AND state NOT IN ('queued', 'running') "
            "RETURNING attempt",
            (id,),
        ).fetchone()
    if gone is None:
        raise Conflict(f"job '{id}' is {get(data_folder, id).state.value}: cancel it first")
    remove_results(data_folder, id, attempts=gone["attempt"])


def claim(
    data_folder: DataFolder,
    *,
    kinds: Sequence[JobKind] = tuple(JobKind),
    is_paced: bool | None = None,
    runner: str = "",
) -> Job | None:
    """Claim the oldest queued job of some kinds; None if there is none.

    Parameters
    ----------
    is_paced : bool, optional
        True: only paced jobs; False: only other jobs; None: either.
    runner : str
        Name of the runner.
    """
    if not kinds:
        return None
    marks = ", ".join("?" for _ in kinds)
    where = f"state = 'queued' AND kind IN ({marks})"
    if is_paced is not None:
        where += f" AND {PACED if is_paced else f'NOT {PACED}'}"
    names = tuple(kind.value for kind in kinds)
    # Most calls find no job, and need no write transaction.
    with data_folder.database.reading() as connection:
        row = connection.execute(f"SELECT 1 FROM jobs WHERE {where} LIMIT 1", names).fetchone()
    if row is None:
        return None
    # Ids follow the wall clock, which may be set back; row ids always grow.
    with data_folder.database.writing() as connection:
        row = connection.execute(
            "UPDATE jobs SET state = 'running', attempt = attempt + 1, started = ?, "
            "runner = ?, share = 0, message = '' "
            f"WHERE id = (SELECT id FROM jobs WHERE {where} "
            f"ORDER BY rowid LIMIT 1{connection.skip_locked}) RETURNING {COLUMNS}",
            (time.time(), runner, *names),
        ).fetchone()
    return None if row is None else _job(row)


def begin(data_folder: DataFolder, job: Job) -> bool:
    """Make the folder of a claimed job; False if a later attempt has taken over."""
    with data_folder.database.writing() as connection:
        # The row is locked then: no other attempt begins before this one is shown.
        is_current = _changed(connection, job, "message = ''", ())
        if is_current:
            with storing("folder of the job"):
                show_attempt(data_folder, job.id, job.attempt)
    return is_current


def tell(data_folder: DataFolder, job: Job, *, share: float, message: str) -> None:
    """Record the progress of a job."""
    _update(data_folder, job, "share = ?, message = ?", (share, message))


def finish(
    data_folder: DataFolder,
    job: Job,
    state: JobState,
    *,
    problem: Mapping[str, Any] | None = None,
) -> None:
    """Record how a job has ended; its results must be on disk before."""
    said = None if problem is None else json.dumps(problem)
    share = ", share = 1" if state is JobState.SUCCEEDED else ""
    values = (state.value, time.time(), said)
    with data_folder.database.writing() as connection:
        columns = f"state = ?, ended = ?, problem = ?{share}"
        # Results of an earlier attempt are shown if its process was stopped while it began.
        if _changed(connection, job, columns, values):
            with storing("folder of the job"):
                show_again(data_folder, job.id, job.attempt)


def running(data_folder: DataFolder, *, runner: str = "") -> tuple[Job, ...]:
    """Return all jobs that a runner has claimed and that have not ended."""
    with data_folder.database.reading() as connection:
        rows = connection.execute(
            f"SELECT {COLUMNS} FROM jobs WHERE state = 'running' AND runner = ?", (runner,)
        ).fetchall()
    return tuple(_job(row) for row in rows)


def abandoned(data_folder: DataFolder, *, lease: float) -> tuple[Job, ...]:
    """Return the running jobs of runners without a heartbeat for longer than a lease, in s."""
    with data_folder.database.reading() as connection:
        rows = connection.execute(
            f"SELECT {COLUMNS} FROM jobs WHERE state = 'running' AND runner NOT IN "
            "(SELECT id FROM runner WHERE seen > wall_clock() - ?)",
            (lease,),
        ).fetchall()
    return tuple(_job(row) for row in rows)


def recover(data_folder: DataFolder, jobs: Sequence[Job]) -> None:
    """Queue or fail jobs of a runner that is gone; each by the first who comes."""
    most = MOST_ATTEMPTS_SHARED if data_folder.database.is_shared else MOST_ATTEMPTS
    for job in jobs:
        if job.is_cancelling:
            finish(data_folder, job, JobState.CANCELLED)
        elif job.is_live:
            problem = lost("a live run cannot be resumed")
            finish(data_folder, job, JobState.FAILED, problem=problem)
        elif job.attempt >= most:
            finish(data_folder, job, JobState.FAILED, problem=lost(f"{job.attempt} attempts"))
        else:
            _update(
                data_folder, job, "state = 'queued', share = 0, message = ?", ("restarted",)
            )


def lost(why: str) -> dict[str, Any]:
    """Return the problem of a job whose process ended without recording an outcome."""
    return {
        "type": "urn:stepnc:problem:job-lost",
        "title": "Job lost",
        "status": 500,
        "detail": f"the process that ran it has ended: {why}",
    }


def _update(data_folder: DataFolder, job: Job, columns: str, values: Sequence[object]) -> None:
    """Change a running job, unless a later attempt has taken over."""
    with data_folder.database.writing() as connection:
        _changed(connection, job, columns, values)


def _changed(connection: Connection, job: Job, columns: str, values: Sequence[object]) -> bool:
    """Change a running job; False if a later attempt has taken over."""
    return bool(
        connection.execute(
            f"UPDATE jobs SET {columns} WHERE id = ? AND attempt = ? AND state = 'running'",
            (*values, job.id, job.attempt),
        ).rowcount
    )


def _require_room(connection: Connection, order: JobRequest) -> None:
    """Require room in the queue, and in the part of it that one API key may fill."""
    row = connection.execute(
        "SELECT count(*) AS waiting, "
        "count(*) FILTER (WHERE key = ? AND (key <> '' OR owner = ?)) AS own "
        "FROM jobs WHERE state = 'queued'",
        (order.key, order.owner),
    ).fetchone()
    is_alone = order.owner == LOCAL and not order.key
    share = MOST_WAITING if is_alone else max(MOST_WAITING // OWNERS, 1)
    if row["waiting"] >= MOST_WAITING or row["own"] >= share:
        raise TooMany(60.0)


def _require_program(connection: Connection, id: str) -> None:
    if not id:
        return
    # It may not be deleted before this job is queued.
    connection.share(f"program {id}")
    row = connection.execute("SELECT 1 FROM programs WHERE id = ?", (id,)).fetchone()
    if row is None:
        raise NotFound("program", id)


def _require_files(connection: Connection, request: Mapping[str, Any]) -> None:
    for kind, field in FIELDS.items():
        id = request.get(field)
        if not id:
            continue
        connection.share(f"file {id}")
        row = connection.execute("SELECT 1 FROM files WHERE id = ?", (id,)).fetchone()
        if row is None:
            raise NotFound(kind.words, id)


def _job(row: StoredRow) -> Job:
    columns = dict(row)
    problem = columns.pop("problem")
    return Job(**{
        **columns,
        "kind": JobKind(columns["kind"]),
        "state": JobState(columns["state"]),
        "request": json.loads(columns["request"]),
        "problem": None if problem is None else json.loads(problem),
        "is_cancelling": bool(columns["is_cancelling"]),
    })
