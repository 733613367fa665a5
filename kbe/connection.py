"""Database connections and transactions, the same for SQLite and PostgreSQL.

SQLite uses a write-ahead log (WAL), so that readers never wait, and syncs at each commit, so
that committed data survives a power cut. A transaction that will write takes its lock at the
beginning, so that two writers wait for each other instead of failing in the middle.

Location of a knowledge base: a file, or a server database shown without its password.

Translation of database errors into errors of the project that say what to do.

Upgrade of a store to the schema of this program, in one transaction.

Two programs that open a new store at the same time both succeed: the second waits, and finds
the tables already made.

References
----------
.. [1] SQLite, "Result and Error Codes", https://sqlite.org/rescode.html: the low byte is the
   primary code.
.. [2] PostgreSQL, "Appendix A. PostgreSQL Error Codes": the first two letters are the class.
"""

import errno
import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from urllib.parse import quote, urlsplit

from sqlalchemy import (
    Connection,
    MetaData,
    Table,
    Text,
    create_engine,
    event,
    inspect,
    select,
    text,
)
from sqlalchemy.engine import URL, Engine, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError
from sqlalchemy.exc import TimeoutError as NoFreeConnection
from sqlalchemy.pool import QueuePool
from sqlalchemy.schema import Column

from kbe.errors import (
    DriverMissing,
    KnowledgeError,
    StoreBusy,
    StoreDamaged,
    StoreFull,
    StoreReadOnly,
    StoreTooNew,
    StoreUnavailable,
)
from kbe.schema import VERSION, VERSION_TABLE

FORMS = "name a file, or sqlite:///FILE, or postgresql://USER@HOST/DATABASE"


@dataclass(frozen=True, slots=True, kw_only=True)
class StoreLocation:
    """Location of a knowledge base."""

    url: URL
    shown: str
    """Text shown to people, without a password."""
    file: str
    """Path of the file; empty for a server."""
    is_immutable: bool = False
    """Whether the file is read as it is, since nothing can be written beside it."""

    @property
    def reading_address(self) -> str:
        """Address of the file for SQLite, by which nothing is written into it."""
        how = "mode=ro&immutable=1" if self.is_immutable else "mode=ro"
        return f"file:{quote(os.path.abspath(self.file))}?{how}"


def parsed_place(url_or_path: str) -> StoreLocation:
    """Parse the location that a user named.

    Raises
    ------
    StoreUnavailable
        When it is not a valid location; a possible password is not repeated.
    """
    if "://" not in url_or_path:
        return _file(url_or_path)
    scheme, _, rest = url_or_path.partition("://")
    kind = scheme.lower().partition("+")[0]
    if kind == "sqlite":
        return _file(rest.removeprefix("/"))
    if kind not in {"postgresql", "postgres"}:
        raise StoreUnavailable(f"{scheme}://…", reason=f"unknown kind of database; {FORMS}")
    return _server(rest)


def _file(name: str) -> StoreLocation:
    """Location of an SQLite file."""
    if not name or name == ":memory:" or "\0" in name:
        raise StoreUnavailable(repr(name), reason=f"is not a file name; {FORMS}")
    # SQLite would interpret such a name as an address with options.
    path = f"./{name}" if name.startswith("file:") else name
    return StoreLocation(
        url=URL.create("sqlite+pysqlite", database=path), shown=name, file=path
    )


def _server(rest: str) -> StoreLocation:
    """Location of a PostgreSQL database."""
    url = _server_url(rest)
    name = f"{url.username}@" if url.username else ""
    # A socket or host, and also a password, may be given in the query string.
    host = url.host or ",".join(url.normalized_query.get("host", ()))
    port = f":{url.port}" if url.port else ""
    shown = f"postgresql://{name}{host}{port}/{url.database or ''}"
    return StoreLocation(url=url, shown=shown, file="")


def _server_url(rest: str) -> URL:
    """Parse the address of a server, if it is certain which part is the password."""
    try:
        address = urlsplit(f"postgresql://{rest}")
        beyond = address.path + address.query + address.fragment
        is_clear = address.netloc.count("@") <= 1 and "@" not in beyond
        if is_clear and not address.fragment:
            return make_url(f"postgresql+psycopg://{rest}")
    except (ArgumentError, ValueError):
        pass
    reason = (
        "is not a valid address; write postgresql://USER:PASSWORD@HOST:PORT/DATABASE, "
        "with %40 for @, %2F for /, %3A for :, %23 for # and %3F for ? in the password"
    )
    # The original error could reveal a password.
    raise StoreUnavailable("postgresql://…", reason=reason) from None


def require_openable(place: StoreLocation, *, is_new_allowed: bool) -> None:
    """Refuse a file that cannot be a store, before SQLite creates one.

    Raises
    ------
    StoreUnavailable
        With what to do.
    """
    path, shown = place.file, place.shown
    if not path:
        return
    if os.path.exists(path):
        if not os.path.isfile(path):
            raise StoreUnavailable(shown, reason=f"is not a file; {FORMS}")
        return
    if not os.path.isdir(os.path.dirname(path) or "."):
        raise StoreUnavailable(shown, reason="the folder does not exist; create it first")
    if not is_new_allowed:
        raise StoreUnavailable(shown, reason="there is no such file; check the name")


SHARED_MEMORY = sqlite3.SQLITE_IOERR_SHMSIZE, sqlite3.SQLITE_IOERR_SHMOPEN
"""SQLite codes for a lack of room for the index of the write-ahead log."""


@contextmanager
def translated(place: StoreLocation) -> Iterator[None]:
    """Translate database errors into errors of the knowledge base.

    Raises
    ------
    KnowledgeError
        Of the class that matches the database error.
    """
    try:
        yield
    except DBAPIError as error:
        raise fault(error.orig or error, place) from error
    except sqlite3.Error as error:
        raise fault(error, place) from error
    except NoFreeConnection as error:
        raise StoreBusy(place.shown) from error
    except OSError as error:
        if error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}:
            raise StoreFull(place.shown) from error
        reason = f"{error.strerror or error}; check the disk and the rights"
        raise StoreUnavailable(place.shown, reason=reason) from error


def fault(error: BaseException, place: StoreLocation) -> KnowledgeError:
    """Convert a database error into an error of the knowledge base."""
    if isinstance(error, sqlite3.Error):
        return _sqlite_fault(error, place)
    return _postgresql_fault(error, place)


def _sqlite_fault(error: sqlite3.Error, place: StoreLocation) -> KnowledgeError:
    """Convert an SQLite error by its result code, [1]_."""
    code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR)
    shown = place.shown
    match code & 0xFF:
        case sqlite3.SQLITE_CORRUPT | sqlite3.SQLITE_NOTADB:
            return StoreDamaged(shown, reason=str(error))
        case sqlite3.SQLITE_FULL:
            return StoreFull(shown)
        case sqlite3.SQLITE_BUSY | sqlite3.SQLITE_LOCKED | sqlite3.SQLITE_PROTOCOL:
            return StoreBusy(shown)
        case sqlite3.SQLITE_READONLY | sqlite3.SQLITE_PERM:
            return StoreReadOnly(shown)
        case sqlite3.SQLITE_CANTOPEN:
            return StoreUnavailable(
                shown,
                reason="cannot be opened; allow this user to write the file and its folder",
            )
        case sqlite3.SQLITE_IOERR:
            return _disk_fault(code, place)
    return KnowledgeError(f"{error} (SQLite {code}); please report this", place=shown)


def _disk_fault(code: int, place: StoreLocation) -> KnowledgeError:
    """Convert a disk error: failed writes are mostly quota or size limits, others hardware."""
    if code in {sqlite3.SQLITE_IOERR_WRITE, *SHARED_MEMORY}:
        return StoreFull(place.shown)
    reason = f"the disk reports a fault (SQLite {code}); check it, and keep a backup elsewhere"
    return StoreUnavailable(place.shown, reason=reason)


def _postgresql_fault(error: BaseException, place: StoreLocation) -> KnowledgeError:
    """Convert a PostgreSQL error by the class of its code, [2]_; no code: no answer."""
    state = getattr(error, "sqlstate", None) or ""
    shown, said = place.shown, _first_line(error, place)
    if state == "53100":
        return StoreFull(shown)
    if state in {"25006", "42501"}:
        return StoreReadOnly(shown)
    match state[:2]:
        case "XX":
            return StoreDamaged(shown, reason=said)
        case "40" | "55":
            return StoreBusy(shown)
        case "" | "08" | "28" | "3D" | "3F" | "53" | "57" | "58":
            return StoreUnavailable(
                shown,
                reason=f"cannot connect to the server ({said}); "
                "check that it runs, the address, the user, its rights and the password",
            )
    return KnowledgeError(f"{said} (PostgreSQL {state}); please report this", place=shown)


def _first_line(error: BaseException, place: StoreLocation) -> str:
    """First line of a server message, with any password removed."""
    line = next(iter(str(error).splitlines()), type(error).__name__)
    secrets = [place.url.password, *place.url.normalized_query.get("password", ())]
    for secret in filter(None, map(str, secrets)):
        line = line.replace(secret, "***")
    return line


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


MIGRATIONS = Path(__file__).parent / "migrations"

LOCK = 0x53544E43
"""Number of the database lock for schema changes; the letters STNC."""

_version = Table(VERSION_TABLE, MetaData(), Column("version_num", Text()))


def migrate(engine: Engine, place: StoreLocation, *, is_new_allowed: bool) -> None:
    """Create or upgrade the tables of a store.

    Raises
    ------
    StoreTooNew
        When a newer program made the store.
    StoreUnavailable
        When the database is not a knowledge base, or new although that is not allowed.
    """
    with reading(engine, place) as connection:
        found = _schema_version(connection, place, is_new_allowed=is_new_allowed)
    if found == VERSION:
        return
    if place.file and not found:
        _write_ahead(engine, place)
    with writing(engine, place) as connection:
        if not place.file:
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
            _require_unicode(connection, place)
        # Another program may have upgraded it in the meantime.
        if _schema_version(connection, place, is_new_allowed=is_new_allowed) != VERSION:
            _upgrade(connection)


def _schema_version(
    connection: Connection, place: StoreLocation, *, is_new_allowed: bool
) -> str:
    """Version of the schema found; empty if there are no tables yet."""
    tables = inspect(connection).get_table_names()
    if VERSION_TABLE in tables:
        found = connection.execute(select(_version.c.version_num)).scalars().all()
        if found and max(found) > VERSION:
            raise StoreTooNew(place.shown, actual=max(found), known=VERSION)
        if len(found) > 1 or not set(found) <= _known_versions():
            versions = ", ".join(map(str, found))
            raise StoreDamaged(place.shown, reason=f"unknown schema version {versions}")
        return found[0] if found else ""
    if tables:
        reason = f"is not a knowledge base (table {tables[0]}); name another file or database"
        raise StoreUnavailable(place.shown, reason=reason)
    if not is_new_allowed:
        raise StoreUnavailable(place.shown, reason="is empty; check the name")
    return ""


def _known_versions() -> set[str]:
    return {path.name[: len(VERSION)] for path in (MIGRATIONS / "versions").glob("[0-9]*.py")}


def _write_ahead(engine: Engine, place: StoreLocation) -> None:
    """Switch an SQLite file to write-ahead logging, retrying while others lock it."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            with translated(place):
                _set_write_ahead(engine)
                break
        except StoreBusy:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.01)


def _set_write_ahead(engine: Engine) -> None:
    """Set the journal mode outside a transaction, as SQLite requires."""
    raw = engine.raw_connection()
    try:
        raw.cursor().execute("PRAGMA journal_mode = WAL")
    finally:
        raw.close()


def _require_unicode(connection: Connection, place: StoreLocation) -> None:
    """Require a database encoding that can store all names."""
    encoding = connection.execute(text("SHOW server_encoding")).scalar_one()
    if encoding != "UTF8":
        reason = f"has the encoding {encoding}; create a database with ENCODING 'UTF8'"
        raise StoreUnavailable(place.shown, reason=reason)


def _upgrade(connection: Connection) -> None:
    """Run the missing migrations in ``migrations/versions``."""
    # Slow to import, and rarely needed.
    from alembic import command  # noqa: PLC0415
    from alembic.config import Config  # noqa: PLC0415

    config = Config(attributes={"connection": connection})
    # A percent sign is special in Alembic's settings.
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    command.upgrade(config, "head")
