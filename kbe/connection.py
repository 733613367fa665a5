"""Database connections and transactions, the same for SQLite and PostgreSQL.

SQLite uses a write-ahead log (WAL), so that readers never wait, and syncs at each commit, so
that committed data survives a power cut. A transaction that will write takes its lock at the
beginning, so that two writers wait for each other instead of failing in the middle.
"""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from sqlalchemy import Connection, create_engine, event
from sqlalchemy.engine import Engine
from sqlalchemy.pool import QueuePool

from kbe.errors import DriverMissing, StoreDamaged
from kbe.faults import translated
from kbe.store_location import StoreLocation

PATIENCE = 30.0
"""Time that a writer waits for others, s."""

CONNECT_TIMEOUT = 10
"""Timeout for connecting to a server, s."""

PRAGMAS = (
    "PRAGMA synchronous = FULL",
    "PRAGMA foreign_keys = ON",
    # Detects damaged pages when they are read, before they do harm.
    "PRAGMA cell_size_check = ON",
    # In KiB; the indexes of a million outcomes do not fit into the default 2 MiB.
    "PRAGMA cache_size = -65536",
)


def connected(place: StoreLocation, *, patience: float = PATIENCE) -> Engine:
    """Create the database engine of a place; no connection is opened yet.

    Raises
    ------
    DriverMissing
        When psycopg is not installed.
    """
    if place.file:
        engine = (
            create_engine("sqlite://", creator=partial(_immutable, place), poolclass=QueuePool)
            if place.is_immutable
            else create_engine(place.url, connect_args={"timeout": patience})
        )
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
        return engine
    try:
        return create_engine(
            place.url, pool_pre_ping=True, connect_args={"connect_timeout": CONNECT_TIMEOUT}
        )
    except ImportError as error:
        raise DriverMissing(place.shown) from error


def _immutable(place: StoreLocation) -> sqlite3.Connection:
    """Connection that needs no lock, and no file beside that of the store."""
    return sqlite3.connect(place.reading_address, uri=True, check_same_thread=False)


def _prepare(connection: sqlite3.Connection, _record: object) -> None:
    """Configure a new SQLite connection."""
    # Python's module would begin transactions itself, too late and not before DDL.
    connection.isolation_level = None
    for pragma in PRAGMAS:
        connection.execute(pragma)


def _begin(connection: Connection) -> None:
    """Begin a transaction; a writing one takes its lock at once."""
    will_write = connection.get_execution_options().get("will_write", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if will_write else "BEGIN")


@contextmanager
def reading(engine: Engine, place: StoreLocation) -> Iterator[Connection]:
    """Open a read transaction.

    Raises
    ------
    StoreDamaged
        When a row holds invalid values; other errors as the database reports.
    """
    try:
        with translated(place), engine.connect() as connection:
            yield connection
    except ValueError as error:
        raise StoreDamaged(place.shown, reason=f"a row cannot be read: {error}") from error


@contextmanager
def snapshot(engine: Engine, place: StoreLocation) -> Iterator[Connection]:
    """Open a read transaction that sees one consistent state, whatever others write."""
    with reading(engine, place) as connection:
        if not place.file:
            connection.execution_options(isolation_level="REPEATABLE READ")
        yield connection


@contextmanager
def writing(engine: Engine, place: StoreLocation) -> Iterator[Connection]:
    """Open a write transaction, which is committed at the end or rolled back on an error."""
    with (
        translated(place),
        engine.execution_options(will_write=True).connect() as connection,
        connection.begin(),
    ):
        yield connection
