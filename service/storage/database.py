"""Embedded database of the service: one SQLite file that several processes share.

Readers never wait for a writer (write-ahead log); once a call returns, its changes are on disk
(``synchronous=FULL``). Each thread has its own connection. A file that was moved away or
replaced is no longer written, since those changes would be lost. Running state.

On a full disk SQLite cannot make the files that it needs beside the database, not even to read
it. Then the database is read as it is, until there is room, and whoever writes is refused.
"""

import os
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from urllib.parse import quote

from service.errors import Unavailable

WAIT = 30.0
"""Time to wait for other writers, in s: each of several may wait for a slow disk."""

SCHEMA = (
    """
    CREATE TABLE programs (
        id TEXT PRIMARY KEY, name TEXT NOT NULL, size INTEGER NOT NULL, sha256 TEXT NOT NULL,
        owner TEXT NOT NULL, created REAL NOT NULL
    ) STRICT;
    CREATE TABLE jobs (
        id TEXT PRIMARY KEY, kind TEXT NOT NULL, state TEXT NOT NULL, request TEXT NOT NULL,
        program TEXT NOT NULL, source TEXT NOT NULL, owner TEXT NOT NULL,
        created REAL NOT NULL, started REAL, ended REAL,
        share REAL NOT NULL DEFAULT 0, message TEXT NOT NULL DEFAULT '', problem TEXT,
        attempt INTEGER NOT NULL DEFAULT 0, is_cancelling INTEGER NOT NULL DEFAULT 0
    ) STRICT;
    CREATE INDEX jobs_by_state ON jobs (state, id);
    CREATE INDEX jobs_by_kind ON jobs (kind, id);
    CREATE INDEX jobs_by_program ON jobs (program, id);
    CREATE TABLE requests (
        owner TEXT NOT NULL, key TEXT NOT NULL, fingerprint TEXT NOT NULL,
        made TEXT NOT NULL, created REAL NOT NULL, PRIMARY KEY (owner, key)
    ) STRICT;
    CREATE TABLE keys (
        id TEXT PRIMARY KEY, hash TEXT NOT NULL, name TEXT NOT NULL, roles TEXT NOT NULL,
        created REAL NOT NULL, revoked REAL
    ) STRICT;
    CREATE TABLE runner (
        id INTEGER PRIMARY KEY CHECK (id = 1), pid INTEGER NOT NULL, seen REAL NOT NULL
    ) STRICT;
    """,
    # A missing NC code was stored as an empty name in version 1.
    """
    UPDATE jobs SET request = json_replace(request, '$.nc_control', NULL)
    WHERE kind = 'advice' AND json_extract(request, '$.nc_control') = ''
    """,
    """
    CREATE TABLE files (
        id TEXT PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, size INTEGER NOT NULL,
        sha256 TEXT NOT NULL, owner TEXT NOT NULL, created REAL NOT NULL
    ) STRICT;
    CREATE INDEX files_by_kind ON files (kind, id);
    """,
    # Jobs name the runner that has claimed them; here there is only one, whose name is empty.
    """
    ALTER TABLE jobs ADD COLUMN runner TEXT NOT NULL DEFAULT '';
    DROP TABLE runner;
    CREATE TABLE runner (
        id TEXT PRIMARY KEY, pid INTEGER NOT NULL, seen REAL NOT NULL
    ) STRICT
    """,
    # Programs of earlier versions are STEP-NC programs.
    "ALTER TABLE programs ADD COLUMN kind TEXT NOT NULL DEFAULT 'step-nc'",
    # The share of the queue belongs to a key; several keys may have one name.
    "ALTER TABLE jobs ADD COLUMN key TEXT NOT NULL DEFAULT ''",
)
"""Migration script of each version; the file's version is the number of scripts applied."""


class FileConnection(sqlite3.Connection):
    """Connection to the file; whoever writes has locked all of it."""

    skip_locked = ""

    def lock(self, name: str) -> None:
        """Lock a name: nothing is left to do in a transaction that writes."""

    def share(self, name: str) -> None:
        """Share a name: nothing is left to do in a transaction that writes."""


class FileDatabase:
    """Connections to the database file. Running state.

    Parameters
    ----------
    file : Path
        Path of the file; created if it does not exist, in an existing folder.

    Raises
    ------
    Unavailable
        When the file cannot be opened, or was written by a newer version.
    """

    is_shared = False

    def __init__(self, file: Path) -> None:
        self.file = file
        self._local = threading.local()
        self._inode: tuple[int, int] | None = None
        try:
            with self.writing() as connection:
                _migrate(connection, file)
        except Unavailable:
            # A full disk lets nobody write, but what is of this version can be read.
            if not file.is_file() or not self._is_current():
                raise
        self._inode = self._file_identity()

    @contextmanager
    def reading(self) -> Iterator[FileConnection]:
        """Provide a connection for queries."""
        with self._answering(), ExitStack() as stack:
            try:
                found = self._connection()
            except sqlite3.Error:
                if not self._is_without_log():
                    raise
                found = stack.enter_context(closing(self._unchanging()))
            yield found

    @contextmanager
    def writing(self) -> Iterator[FileConnection]:
        """Provide a connection within a transaction, which is rolled back on error."""
        with self._answering():
            connection = self._connection()
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.commit()
            except BaseException:
                connection.rollback()
                raise

    def _connection(self) -> FileConnection:
        known: FileConnection | None = getattr(self._local, "connection", None)
        if known is None:
            # Transactions are begun explicitly.
            known = sqlite3.connect(
                self.file, timeout=WAIT, isolation_level=None, factory=FileConnection
            )
            try:
                known.create_function("wall_clock", 0, time.time)
                known.row_factory = sqlite3.Row
                known.execute("PRAGMA journal_mode=WAL")
                known.execute("PRAGMA synchronous=FULL")
            except sqlite3.Error:
                known.close()
                raise
            self._local.connection = known
        return known

    def _unchanging(self) -> FileConnection:
        """Connection that needs no file beside the database; for one query, as others write."""
        address = f"file:{quote(str(self.file.resolve()))}?mode=ro&immutable=1"
        found = sqlite3.connect(address, uri=True, factory=FileConnection)
        found.create_function("wall_clock", 0, time.time)
        found.row_factory = sqlite3.Row
        return found

    def _is_without_log(self) -> bool:
        """True if all that was stored stands in the file itself."""
        log = self.file.with_name(f"{self.file.name}-wal")
        return self.file.is_file() and not (log.exists() and log.stat().st_size)

    def _is_current(self) -> bool:
        """True if the file can be read, and has the version of this program."""
        try:
            with self.reading() as connection:
                (version,) = connection.execute("PRAGMA user_version").fetchone()
        except Unavailable:
            return False
        return bool(version == len(SCHEMA))

    def close(self) -> None:
        """Close this thread's connection."""
        known: FileConnection | None = getattr(self._local, "connection", None)
        if known is not None:
            known.close()
            self._local.connection = None

    def _file_identity(self) -> tuple[int, int]:
        """Identity (device and inode) of the current database file."""
        try:
            found = os.stat(self.file)
        except OSError as error:
            raise Unavailable(f"{self.file.name}: {error.strerror or error}") from error
        return found.st_dev, found.st_ino

    @contextmanager
    def _answering(self) -> Iterator[None]:
        if self._inode is not None and self._file_identity() != self._inode:
            raise Unavailable(f"{self.file.name}: the file was replaced by another one")
        try:
            yield
        except sqlite3.Error as error:
            raise Unavailable(f"{self.file.name}: {error}") from error


def _migrate(connection: sqlite3.Connection, file: Path) -> None:
    """Migrate a file of an older version, within the transaction."""
    version = int(connection.execute("PRAGMA user_version").fetchone()[0])
    if version > len(SCHEMA):
        text = f"of version {version}; this program supports up to {len(SCHEMA)}"
        raise Unavailable(f"{file.name} is {text}: install a newer program")
    for number in range(version, len(SCHEMA)):
        for statement in SCHEMA[number].split(";"):
            connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {number + 1}")
