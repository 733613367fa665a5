"""Jobs: what was asked, how far it is, how it ended. Their results lie in folders of theirs.

A job is claimed by one runner at a time; each claim is a new attempt, and what belongs to an
older attempt is not written any more. Running jobs whose runner is gone are queued again when
their kind may be run twice, else they have failed, and say so.
"""

import json
import shutil
import sqlite3
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from service.depot.folder import Depot
from service.depot.ids import new_id
from service.depot.once import Once, made_before, remember
from service.depot.pages import Page, Place, page_of
from service.errors import Conflict, NotFound, TooMany

MOST_WAITING = 1000
"""jobs in the queue"""

LOCAL = "local"
"""owner of what is asked where no keys are in use: the whole queue is theirs"""

OWNERS = 4
"""of keys that fill the queue, at least: none keeps the others out"""

MOST_ATTEMPTS = 3
"""of a job whose runner was lost each time"""


class State(StrEnum):
    """How far a job is."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def is_over(self) -> bool:
        """Whether nothing more happens."""
        return self not in {State.QUEUED, State.RUNNING}


class Kind(StrEnum):
    """What is done."""

    ADVICE = "advice"
    SIMULATION = "simulation"
    CONTROL = "control-run"
    TRIAL = "trial"
    EVALUATION = "evaluation"
    REVIEW = "review"

    @property
    def is_live(self) -> bool:
        """Whether somebody may steer it while it runs; it is not run twice."""
        return self in {Kind.CONTROL, Kind.TRIAL}


PACED = (
    f"(kind IN ('{Kind.CONTROL.value}', '{Kind.TRIAL.value}') OR (kind = "
    f"'{Kind.SIMULATION.value}' AND coalesce(json_extract(request, '$.pace'), 0) > 0))"
)
"""as :attr:`Job.is_paced`; requests of other kinds have no pace, and may be long"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One job."""

    id: str
    kind: Kind
    state: State
    request: Mapping[str, Any]
    program: str
    """id of the program that it works on; empty: on none"""
    source: str
    """id of the job whose result it works on; empty: of none"""
    owner: str
    created: float
    """s since 1970, as those below"""
    started: float | None
    ended: float | None
    share: float
    """that is done, 0 to 1"""
    message: str
    problem: Mapping[str, Any] | None
    """why it failed, as in RFC 9457"""
    attempt: int
    is_cancelling: bool

    @property
    def is_paced(self) -> bool:
        """Whether it mostly waits for people, or for the clock."""
        return self.kind.is_live or bool(self.request.get("pace"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """A job that is asked for."""

    kind: Kind
    request: Mapping[str, Any]
    program: str = ""
    source: str = ""
    owner: str


def add(depot: Depot, order: Order, *, once: Once | None = None) -> Job:
    """Queue a job.

    Raises
    ------
    TooMany
        When too many wait.
    NotFound
        When its program was deleted meanwhile.
    """
    id = new_id()
    with depot.database.writing() as connection:
        kept = made_before(connection, once)
        if kept is None:
            _require_room(connection, order.owner)
            _require_program(connection, order.program)
            connection.execute(
                "INSERT INTO jobs (id, kind, state, request, program, source, owner, created) "
                "VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    id, order.kind.value, State.QUEUED.value, json.dumps(order.request),
                    order.program, order.source, order.owner, time.time(),
                ),
            )  # fmt: skip
            remember(connection, once, id)
    return get(depot, kept or id)


def get(depot: Depot, id: str, kind: Kind | None = None) -> Job:
    """One job, of a kind when one is named.

    Raises
    ------
    NotFound
        When there is none.
    """
    with depot.database.reading() as connection:
        row = connection.execute("SELECT * FROM jobs WHERE id = ?", (id,)).fetchone()
    if row is None or (kind is not None and row["kind"] != kind.value):
        raise NotFound("job" if kind is None else kind.value, id)
    return _job(row)


def listed(
    depot: Depot,
    place: Place,
    *,
    kind: Kind | None = None,
    state: State | None = None,
    program: str = "",
) -> Page[Job]:
    """A page of jobs, newest first."""
    where, values = ["id < ?"], [place.before]
    for column, wanted in (("kind", kind), ("state", state), ("program", program)):
        if wanted:
            where.append(f"{column} = ?")
            values.append(str(wanted))
    query = f"SELECT * FROM jobs WHERE {' AND '.join(where)} ORDER BY id DESC LIMIT ?"
    with depot.database.reading() as connection:
        rows = connection.execute(query, (*values, place.limit + 1)).fetchall()
    return page_of([_job(row) for row in rows], [row["id"] for row in rows], limit=place.limit)


def cancel(depot: Depot, id: str) -> Job:
    """Ask for the end of a job: one that waits is cancelled at once.

    Raises
    ------
    NotFound, Conflict
        When there is none, or it is over.
    """
    with depot.database.writing() as connection:
        row = connection.execute("SELECT state FROM jobs WHERE id = ?", (id,)).fetchone()
        if row is None:
            raise NotFound("job", id)
        state = State(row["state"])
        if state.is_over and state is not State.CANCELLED:
            raise Conflict(f"job '{id}' has {state.value}: there is nothing to cancel")
        if state is State.QUEUED:
            connection.execute(
                "UPDATE jobs SET state = ?, ended = ? WHERE id = ?",
                (State.CANCELLED.value, time.time(), id),
            )
        connection.execute("UPDATE jobs SET is_cancelling = 1 WHERE id = ?", (id,))
    return get(depot, id)


def remove(depot: Depot, id: str) -> None:
    """Delete a job that is over, and its results.

    Raises
    ------
    NotFound, Conflict
        When there is none, or it is not over.
    """
    with depot.database.writing() as connection:
        row = connection.execute("SELECT state FROM jobs WHERE id = ?", (id,)).fetchone()
        if row is None:
            raise NotFound("job", id)
        if not State(row["state"]).is_over:
            raise Conflict(f"job '{id}' is {row['state']}: cancel it first")
        connection.execute("DELETE FROM jobs WHERE id = ?", (id,))
    shutil.rmtree(depot.job_folder(id), ignore_errors=True)


def claim(
    depot: Depot, *, kinds: Sequence[Kind] = tuple(Kind), is_paced: bool | None = None
) -> Job | None:
    """Take the oldest job of some kinds that waits; None: there is none.

    Parameters
    ----------
    depot : Depot
    kinds : sequence of Kind
    is_paced : bool, optional
        Only those that wait for people or the clock, or only others; None: either.
    """
    if not kinds:
        return None
    marks = ", ".join("?" for _ in kinds)
    where = f"state = 'queued' AND kind IN ({marks})"
    if is_paced is not None:
        where += f" AND {PACED if is_paced else f'NOT {PACED}'}"
    names = tuple(kind.value for kind in kinds)
    # Most looks find nothing, and need no turn to write.
    with depot.database.reading() as connection:
        row = connection.execute(f"SELECT 1 FROM jobs WHERE {where} LIMIT 1", names).fetchone()
    if row is None:
        return None
    with depot.database.writing() as connection:
        row = connection.execute(
            "UPDATE jobs SET state = 'running', attempt = attempt + 1, started = ?, "
            f"share = 0, message = '' WHERE id = (SELECT id FROM jobs WHERE {where} "
            "ORDER BY id LIMIT 1) RETURNING *",
            (time.time(), *names),
        ).fetchone()
    return None if row is None else _job(row)


def tell(depot: Depot, job: Job, *, share: float, message: str) -> None:
    """Say how far a job is."""
    _update(depot, job, "share = ?, message = ?", (share, message))


def finish(
    depot: Depot, job: Job, state: State, *, problem: Mapping[str, Any] | None = None
) -> None:
    """Say how a job has ended; its results are on the disk before."""
    said = None if problem is None else json.dumps(problem)
    share = ", share = 1" if state is State.SUCCEEDED else ""
    values = (state.value, time.time(), said)
    _update(depot, job, f"state = ?, ended = ?, problem = ?{share}", values)


def running(depot: Depot) -> tuple[Job, ...]:
    """All jobs that run."""
    with depot.database.reading() as connection:
        rows = connection.execute("SELECT * FROM jobs WHERE state = 'running'").fetchall()
    return tuple(_job(row) for row in rows)


def recover(depot: Depot) -> None:
    """What a runner does first: running jobs are of one that is gone."""
    for job in running(depot):
        if job.is_cancelling:
            finish(depot, job, State.CANCELLED)
        elif job.kind.is_live:
            finish(depot, job, State.FAILED, problem=lost("a run with people cannot go on"))
        elif job.attempt >= MOST_ATTEMPTS:
            finish(depot, job, State.FAILED, problem=lost(f"{job.attempt} attempts"))
        else:
            _update(depot, job, "state = 'queued', share = 0, message = ?", ("once more",))


def lost(why: str) -> dict[str, Any]:
    """The problem of a job whose process ended without a word."""
    return {
        "type": "urn:stepnc:problem:job-lost",
        "title": "Job lost",
        "status": 500,
        "detail": f"the process that ran it has ended: {why}",
    }


def _update(depot: Depot, job: Job, columns: str, values: Sequence[object]) -> None:
    """Change a running job, unless a later attempt has taken over."""
    with depot.database.writing() as connection:
        connection.execute(
            f"UPDATE jobs SET {columns} WHERE id = ? AND attempt = ? AND state = 'running'",
            (*values, job.id, job.attempt),
        )


def _require_room(connection: sqlite3.Connection, owner: str) -> None:
    """Room in the queue, and in the share of it that one owner may fill."""
    waiting, own = connection.execute(
        "SELECT count(*), total(owner = ?) FROM jobs WHERE state = 'queued'", (owner,)
    ).fetchone()
    share = MOST_WAITING if owner == LOCAL else max(MOST_WAITING // OWNERS, 1)
    if waiting >= MOST_WAITING or own >= share:
        raise TooMany(60.0)


def _require_program(connection: sqlite3.Connection, id: str) -> None:
    if not id:
        return
    row = connection.execute("SELECT 1 FROM programs WHERE id = ?", (id,)).fetchone()
    if row is None:
        raise NotFound("program", id)


def _job(row: sqlite3.Row) -> Job:
    columns = {name: row[name] for name in row.keys()}  # noqa: SIM118 (a Row)
    problem = columns.pop("problem")
    return Job(**{
        **columns,
        "kind": Kind(columns["kind"]),
        "state": State(columns["state"]),
        "request": json.loads(columns["request"]),
        "problem": None if problem is None else json.loads(problem),
        "is_cancelling": bool(columns["is_cancelling"]),
    })
