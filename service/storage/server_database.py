"""Database of the service on a PostgreSQL server, which several hosts share.

The only home of psycopg. Connections are lent from a small pool; after a failure all idle ones
are dropped, and for a moment no new one is tried, so that a lost server is told at once instead
of after a timeout each time. Running state.
"""

import select
import threading
import time
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
from typing import Any, TypeVar

import psycopg
from psycopg import errors
from psycopg.abc import PQGen
from psycopg.pq import TransactionStatus
from psycopg.rows import DictRow, dict_row

from kbe.connection import StoreLocation, fault, parsed_place
from service.errors import StorageFull, Unavailable
from service.storage.connection import StatementAnswer
from service.storage.server_schema import SCHEMA, SPACE

MOST_CONNECTIONS = 8
"""Largest number of connections of a process."""

WAIT = 10.0
"""Time to wait for a free connection, and for an answer of the server, in s."""

LOOK = 0.1
"""Interval in which a waiting connection looks for signals, in s."""

CONNECT_TIMEOUT = 5
"""Timeout for connecting, in s."""

PAUSE = 1.0
"""Time after a failure to connect for which no other attempt is made, in s."""

IDLE = 5.0
"""Time after which an idle connection is checked before it is lent, in s."""

SETTINGS = (
    f"SET search_path = {SPACE}",
    # Shorter than whoever asks waits for an answer.
    "SET statement_timeout = '8s'",
    # A process that was stopped in the middle must not keep others waiting.
    "SET idle_in_transaction_session_timeout = '10s'",
    "SET tcp_keepalives_idle = 10",
    "SET tcp_keepalives_interval = 5",
    "SET tcp_keepalives_count = 3",
)
"""Settings of each connection; the last three let the server notice that a host is gone."""

LOCK = 0x53544E44
"""Number of the lock for schema changes; the letters STND."""

RV = TypeVar("RV")

MIGRATION = 3600.0
"""Time to wait for an answer while tables are upgraded, in s."""


class Raw(psycopg.Connection[DictRow]):
    """Connection that is closed when the server does not answer in time. Running state.

    A server whose host is gone, or that was stopped, leaves its connections open: without a
    bound, whoever waits for an answer would wait for ever.
    """

    patience: float = WAIT

    def wait(self, gen: PQGen[RV], interval: float = LOOK, timeout: float | None = None) -> RV:
        """Wait for an answer, at most as long as the connection is patient."""
        try:
            return super().wait(gen, interval, self.patience if timeout is None else timeout)
        except psycopg.OperationalError as error:
            if self.info.transaction_status is TransactionStatus.ACTIVE:
                # Nothing else can be asked while this is not answered.
                self.pgconn.finish()
                raise NoAnswer("the server does not answer") from error
            raise


class NoAnswer(psycopg.OperationalError):
    """The server has not answered in time."""


class ServerConnection:
    """Connection that takes statements written for both databases."""

    skip_locked = " FOR UPDATE SKIP LOCKED"

    def __init__(self, raw: Raw) -> None:
        self._raw = raw

    def execute(self, statement: str, values: Sequence[Any] = (), /) -> StatementAnswer:
        """Execute a statement."""
        return self._raw.execute(_marked(statement), values)

    def lock(self, name: str) -> None:
        """Let no other transaction lock or share a name until this one has ended."""
        self.execute("SELECT pg_advisory_xact_lock(hashtextextended(?, 0))", (name,))

    def share(self, name: str) -> None:
        """Let no other transaction lock a name until this one has ended."""
        self.execute("SELECT pg_advisory_xact_lock_shared(hashtextextended(?, 0))", (name,))


class ServerDatabase:
    """Connections to the database on a server. Running state.

    Parameters
    ----------
    url : str
        ``postgresql://USER@HOST:PORT/DATABASE``; tables are made in a schema of their own.

    Raises
    ------
    Unavailable
        When the server does not answer or refuses, or the tables are of a newer version. A
        password is not repeated.
    """

    is_shared = True

    def __init__(self, url: str) -> None:
        self.place = server_place(url)
        address = self.place.url.set(drivername="postgresql")
        self._address = address.render_as_string(hide_password=False)
        self._idle: list[tuple[float, Raw]] = []
        # Also when the process ends, so that the server need not notice by itself.
        weakref.finalize(self, _close, self._idle)
        self._free = threading.BoundedSemaphore(MOST_CONNECTIONS)
        self._failed_at = -PAUSE
        self._is_away = False
        self._probing = threading.Lock()
        try:
            with self._lent() as raw:
                connection = ServerConnection(raw)
                # Most processes find everything made, and wait for nobody.
                if _version(connection) != len(SCHEMA):
                    raw.patience = MIGRATION
                    with raw.transaction():
                        connection.execute("SET LOCAL statement_timeout = 0")
                        _migrate(connection, self.place)
                    # The patient one is not lent to others.
                    raw.close()
        except psycopg.Error as error:
            raise Unavailable(str(fault(error, self.place))) from error

    @contextmanager
    def reading(self) -> Iterator[ServerConnection]:
        """Provide a connection for queries."""
        with _answering(), self._lent() as raw:
            yield ServerConnection(raw)

    @contextmanager
    def writing(self) -> Iterator[ServerConnection]:
        """Provide a connection within a transaction, which is rolled back on error."""
        with _answering(), self._lent() as raw, raw.transaction():
            yield ServerConnection(raw)

    def close(self) -> None:
        """Close idle connections."""
        _close(self._idle)

    @contextmanager
    def _lent(self) -> Iterator[Raw]:
        """Lend a connection; a broken one is closed, and the idle ones with it."""
        self._require_present()
        if not self._free.acquire(timeout=WAIT):
            raise Unavailable("the database is busy: no connection is free")
        try:
            # It may have gone away while this one waited.
            self._require_present()
            raw = self._checked() or self._connected()
            try:
                yield raw
            except NoAnswer:
                self._went_away()
                raise
            finally:
                if raw.closed or raw.info.transaction_status.name != "IDLE":
                    raw.close()
                    self.close()
                else:
                    self._idle.append((time.monotonic(), raw))
        finally:
            self._free.release()

    def _require_present(self) -> None:
        """Refuse at once while the server is away, but for one who tries now and then."""
        if time.monotonic() - self._failed_at < PAUSE or self._probing.locked():
            raise Unavailable("the database does not answer: try again later")

    def _went_away(self) -> None:
        self._failed_at, self._is_away = time.monotonic(), True

    def _checked(self) -> Raw | None:
        """Return an idle connection that still answers; None if there is none."""
        while True:
            try:
                since, raw = self._idle.pop()
            except IndexError:
                return None
            if time.monotonic() - since < IDLE and not _has_news(raw):
                return raw
            try:
                raw.execute(b"SELECT 1")
            except NoAnswer:
                self._went_away()
                raise
            except psycopg.Error:
                raw.close()
            else:
                return raw

    def _connected(self) -> Raw:
        if not self._is_away:
            return self._opened()
        if not self._probing.acquire(blocking=False):
            raise Unavailable("the database does not answer: try again later")
        try:
            raw = self._opened()
        finally:
            self._probing.release()
        self._is_away = False
        return raw

    def _opened(self) -> Raw:
        try:
            raw = Raw.connect(
                self._address,
                autocommit=True,
                row_factory=dict_row,
                connect_timeout=CONNECT_TIMEOUT,
                keepalives_idle=10,
                keepalives_interval=5,
                keepalives_count=3,
                tcp_user_timeout=int(WAIT * 1000.0),
                application_name="stepnc",
            )
            raw.execute("; ".join(SETTINGS).encode())
        except psycopg.Error:
            self._went_away()
            raise
        return raw


def _has_news(raw: Raw) -> bool:
    """True if an idle connection has something to read: most often that it was closed."""
    probe = select.poll()
    probe.register(raw.fileno(), select.POLLIN)
    return bool(probe.poll(0))


def _close(idle: list[tuple[float, Raw]]) -> None:
    """Close the connections of a list, which other threads may use meanwhile."""
    while True:
        try:
            _, raw = idle.pop()
        except IndexError:
            return
        with suppress(psycopg.Error):
            raw.close()


def server_place(url: str) -> StoreLocation:
    """Parse the address of a server.

    Raises
    ------
    Unavailable
        When it is none; a password is not repeated.
    """
    scheme, mark, _ = url.partition("://")
    if not mark or scheme.lower() not in {"postgresql", "postgres"}:
        what = f"{scheme}://…" if mark else "a file name"
        raise Unavailable(
            f"--database {what}: write postgresql://USER@HOST/DATABASE; "
            "without --database, the database is a file in the data folder"
        )
    return parsed_place(url)


@lru_cache(maxsize=256)
def _marked(statement: str) -> bytes:
    """Statement with the placeholders of psycopg."""
    return statement.replace("?", "%s").encode()


@contextmanager
def _answering() -> Iterator[None]:
    """Convert errors of the server; the address is for the log, not for clients."""
    try:
        yield
    except errors.DiskFull as error:
        raise StorageFull("the disk of the database is full") from error
    except (psycopg.OperationalError, psycopg.InterfaceError) as error:
        raise Unavailable("the database does not answer: try again later") from error
    except psycopg.Error as error:
        raise Unavailable(f"the database refuses: {type(error).__name__}") from error


def _version(connection: ServerConnection) -> int:
    """Return the version of the tables; 0 if there are none."""
    row = connection.execute("SELECT to_regclass('version') IS NULL AS is_new").fetchone()
    if row["is_new"]:
        return 0
    row = connection.execute("SELECT max(number) AS number FROM version").fetchone()
    return int(row["number"] or 0)


def _migrate(connection: ServerConnection, place: StoreLocation) -> None:
    """Create or upgrade the tables, within the transaction."""
    connection.execute("SELECT pg_advisory_xact_lock(?)", (LOCK,))
    row = connection.execute("SHOW server_encoding").fetchone()
    if row["server_encoding"] != "UTF8":
        what = f"has the encoding {row['server_encoding']}"
        raise Unavailable(f"{place.shown} {what}: create a database with ENCODING 'UTF8'")
    connection.execute(f"CREATE SCHEMA IF NOT EXISTS {SPACE}")
    connection.execute("CREATE TABLE IF NOT EXISTS version (number BIGINT NOT NULL)")
    version = _version(connection)
    if version > len(SCHEMA):
        text = f"of version {version}; this program supports up to {len(SCHEMA)}"
        raise Unavailable(f"{place.shown} is {text}: install a newer program")
    for number in range(version, len(SCHEMA)):
        for statement in SCHEMA[number]:
            connection.execute(statement)
        connection.execute("INSERT INTO version VALUES (?)", (number + 1,))
