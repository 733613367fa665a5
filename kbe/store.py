"""Store of the knowledge base, to which rows are only ever added.

Data is safely stored when a call returns; a call that fails adds nothing. One store may be used
by many threads, and one database by many programs.

Order: outcomes come by time of recording; corrections by proposal. In force for a context is
the correction that was accepted last and not withdrawn since: withdrawing it puts the previous
one back in force.
"""

import os
import shutil
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, cast

from sqlalchemy import Connection, bindparam, func, insert, select, text
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import URL, Engine

from kbe.connection import (
    StoreLocation,
    connected,
    migrate,
    parsed_place,
    reading,
    require_openable,
    writing,
)
from kbe.errors import (
    KnowledgeError,
    OutcomeDiffers,
    StoreDamaged,
    StoreFull,
    StoreReadOnly,
    StoreUnavailable,
    UnknownCorrection,
)
from kbe.queries import (
    EVERYTHING,
    Group,
    Selection,
    Standing,
    StoredCorrection,
    conditions,
    entries,
    entry,
    group,
    grouped,
    in_force,
)
from kbe.rows import (
    CORRECTION,
    IDENTITY,
    OUTCOME,
    Value,
    outcome_row,
    storable_text,
    utc,
    what_differs,
)
from kbe.schema import DECIDED, TABLES, correction, decision, outcome
from stepnc_model.outcome import Context, LearnedCorrection, ProcessOutcome

if TYPE_CHECKING:
    from sqlalchemy.sql.dml import ReturningInsert

AT_ONCE = 1000
"""Number of rows fetched together."""


class Store:
    """Open knowledge base, made by :func:`open_store`; ended by ``with`` or ``close``."""

    def __init__(
        self,
        engine: Engine,
        place: StoreLocation,
        *,
        folder: TemporaryDirectory[str] | None = None,
    ) -> None:
        self.engine = engine
        self.place = place
        self._folder = folder
        """Folder of a copy, which goes when the store is closed."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close all database connections."""
        self.engine.dispose()
        if self._folder is not None:
            self._folder.cleanup()

    def add(self, outcomes: Sequence[ProcessOutcome]) -> int:
        """Store outcomes, all or none, except those recorded before; return how many are new.

        An outcome is known by its run, machine, program, workingstep and sequence. So a
        program that was killed before it could say that it had stored them may try again.

        Raises
        ------
        ValueError
            When a number is not finite, a time has no zone, or a text cannot be stored.
        OutcomeDiffers
            When an outcome is recorded already, with other values.
        KnowledgeError
            When the store cannot take them.
        """
        rows = [outcome_row(each) for each in outcomes]
        if not rows:
            return 0
        with writing(self.engine, self.place) as connection:
            new = connection.execute(_unless_known(connection), rows).all()
            # The rule, not the exception: none of them was known.
            if len(new) < len(rows):
                _require_recorded(connection, rows, self.place)
        return len(new)

    def outcomes(self, selection: Selection = EVERYTHING) -> Iterator[ProcessOutcome]:
        """Iterate over outcomes by time, in one consistent state of the store."""
        columns = [outcome.c[leaf.name] for leaf in OUTCOME.leaves]
        query = (
            select(*columns)
            .where(*conditions(selection))
            .order_by(outcome.c.recorded_at, outcome.c.id)
            .execution_options(yield_per=AT_ONCE)
        )
        with (
            reading(self.engine, self.place) as connection,
            connection.execute(query) as rows,
        ):
            for row in rows:
                yield OUTCOME.noun(row)

    def count(self, selection: Selection = EVERYTHING) -> int:
        """Number of selected outcomes."""
        query = select(func.count()).select_from(outcome).where(*conditions(selection))
        with reading(self.engine, self.place) as connection:
            return connection.execute(query).scalar_one()

    def contexts(self) -> tuple[Context, ...]:
        """Machine, material and tool of all outcomes, in order."""
        columns = (outcome.c.machine, outcome.c.material, outcome.c.tool)
        with reading(self.engine, self.place) as connection:
            rows = sorted(tuple(row) for row in connection.execute(select(*columns).distinct()))
        return tuple(Context(machine=row[0], material=row[1], tool=row[2]) for row in rows)

    def groups(self, selection: Selection = EVERYTHING) -> tuple[Group, ...]:
        """Counts and averages of outcomes by context and kind of feature, in order."""
        query = grouped(selection)
        with reading(self.engine, self.place) as connection:
            rows = sorted(connection.execute(query), key=lambda row: row[:4])
        return tuple(group(row) for row in rows)

    def propose(self, proposed: LearnedCorrection) -> int:
        """Store a proposed correction for a person to decide about; return its id.

        Raises
        ------
        ValueError
            When it is marked as accepted already, and as :meth:`add`.
        """
        if proposed.accepted_by or proposed.accepted_at is not None:
            raise ValueError("a proposed correction must not be accepted already")
        row = CORRECTION.row(proposed)
        stored = {name: value for name, value in row.items() if name not in DECIDED}
        with writing(self.engine, self.place) as connection:
            made = connection.execute(insert(correction).returning(correction.c.id), stored)
            return int(made.scalar_one())

    def accept(self, id: int, *, by: str, at: datetime) -> None:
        """Put a correction in force, in the name of a person.

        Raises
        ------
        UnknownCorrection
            When no correction has this id.
        ValueError
            When nobody is named, or the time has no zone.
        """
        self._decide(id, Standing.ACCEPTED, by=by, at=at)

    def withdraw(self, id: int, *, by: str, at: datetime) -> None:
        """Take a correction out of force, or refuse a proposal; errors as :meth:`accept`."""
        self._decide(id, Standing.WITHDRAWN, by=by, at=at)

    def _decide(self, id_: int, standing: Standing, *, by: str, at: datetime) -> None:
        """Store a decision about a correction."""
        if not by.strip():
            raise ValueError("a decision needs the name of the person who decides")
        row = {
            "correction_id": id_,
            "kind": standing.value,
            "decided_by": storable_text("by", by),
            "decided_at": utc("at", at),
        }
        known = select(correction.c.id).where(correction.c.id == id_)
        with writing(self.engine, self.place) as connection:
            if connection.execute(known).first() is None:
                raise UnknownCorrection(self.place.shown, id=id_)
            connection.execute(insert(decision), row)

    def corrections(self) -> tuple[StoredCorrection, ...]:
        """All stored corrections, in any state."""
        with reading(self.engine, self.place) as connection:
            return tuple(entry(row) for row in connection.execute(entries()))

    def accepted(self, context: Context) -> LearnedCorrection | None:
        """Correction in force for a context, or None."""
        with reading(self.engine, self.place) as connection:
            row = connection.execute(in_force(context)).first()
            return None if row is None else entry(row).correction

    def check(self) -> None:
        """Read all stored data completely, to detect damage.

        Raises
        ------
        StoreDamaged
            When something cannot be read.
        """
        with reading(self.engine, self.place) as connection:
            if self.place.file:
                require_whole(connection, self.place)
                return
            # A server reports pages that it cannot read.
            for table in TABLES:
                query = select(table).execution_options(yield_per=AT_ONCE)
                deque(connection.execute(query), maxlen=0)


def _unless_known(connection: Connection) -> "ReturningInsert[Any]":
    """Statement that inserts outcomes whose identity is new, and returns their ids."""
    is_server = connection.dialect.name == "postgresql"
    made = postgresql.insert(outcome) if is_server else sqlite.insert(outcome)
    return made.on_conflict_do_nothing(index_elements=IDENTITY).returning(outcome.c.id)


def _require_recorded(
    connection: Connection, rows: Sequence[dict[str, Value]], place: StoreLocation
) -> None:
    """Require that the store holds each of these rows with the values that it has here.

    Raises
    ------
    OutcomeDiffers
        For the first that it holds with others.
    """
    query = select(outcome).where(*(outcome.c[name] == bindparam(name) for name in IDENTITY))
    for row in rows:
        stored = connection.execute(query, {name: row[name] for name in IDENTITY}).mappings()
        known = cast("Mapping[str, Value]", stored.one())
        if name := what_differs(row, known):
            raise OutcomeDiffers(
                place.shown,
                run=str(row["run"]),
                workingstep=str(row["workingstep"]),
                column=name,
                recorded=known[name],
                value=row[name],
            )


def require_whole(connection: Connection, place: StoreLocation) -> None:
    """Check the pages, indexes and references of an SQLite file.

    Raises
    ------
    StoreDamaged
        With the first fault found.
    """
    said = connection.execute(text("PRAGMA integrity_check(1)")).scalar_one()
    if said != "ok":
        raise StoreDamaged(place.shown, reason=str(said))
    broken = connection.execute(text("PRAGMA foreign_key_check")).first()
    if broken is not None:
        raise StoreDamaged(place.shown, reason=f"a row of {broken[0]} refers to a missing row")


def open_store(url_or_path: str, *, is_new_allowed: bool = True) -> Store:
    """Open a knowledge base; create or upgrade it if necessary.

    Parameters
    ----------
    url_or_path : str
        A file name, ``sqlite:///FILE`` or ``postgresql://USER:PASSWORD@HOST:PORT/DATABASE``.
    is_new_allowed : bool
        Whether to create a store where there is none.

    Raises
    ------
    StoreUnavailable
        When it cannot be reached, or is not a knowledge base; DriverMissing without psycopg.
    StoreDamaged, StoreTooNew, StoreReadOnly, StoreBusy, StoreFull
        As their names say.
    """
    return open_place(parsed_place(url_or_path), is_new_allowed=is_new_allowed)


def open_place(place: StoreLocation, *, is_new_allowed: bool) -> Store:
    """Open the store at a location; errors as :func:`open_store`."""
    require_openable(place, is_new_allowed=is_new_allowed)
    engine = connected(place)
    try:
        migrate(engine, place, is_new_allowed=is_new_allowed)
    except BaseException:
        engine.dispose()
        raise
    return Store(engine, place)


def open_to_read(url_or_path: str) -> Store:
    """Open a knowledge base for reading, also where nothing can be written.

    SQLite writes files beside that of the store even to read it. Where it cannot, on a full
    disk or one that is read-only, the file is read as it is; one that has a log of changes, or
    that an earlier version has made, is copied to the folder of temporary files first.

    Raises
    ------
    KnowledgeError
        As :func:`open_store`.
    """
    place = parsed_place(url_or_path)
    try:
        return open_place(place, is_new_allowed=False)
    except (StoreFull, StoreReadOnly, StoreUnavailable) as error:
        if not place.file or not os.path.isfile(place.file):
            raise
        return _unwritable(place, error)


def _unwritable(place: StoreLocation, why: KnowledgeError) -> Store:
    """Open a file for reading that cannot be written, or nothing beside it."""
    log = f"{place.file}-wal"
    if not os.path.exists(log) or not os.path.getsize(log):
        with suppress(StoreReadOnly):
            return open_place(replace(place, is_immutable=True), is_new_allowed=False)
    folder = None
    try:
        folder = TemporaryDirectory(prefix="stepnc-kbe-")
        copy = os.path.join(folder.name, "copy.db")
        shutil.copyfile(place.file, copy)
        if os.path.exists(log):
            shutil.copyfile(log, f"{copy}-wal")
        url = URL.create("sqlite+pysqlite", database=copy)
        found = open_place(replace(place, url=url, file=copy), is_new_allowed=False)
    except (OSError, StoreFull) as error:
        if folder is not None:
            folder.cleanup()
        raise why from error
    return Store(found.engine, found.place, folder=folder)
