"""The service's own database: one file of SQLite that several processes share.

Readers never wait for a writer (write-ahead log); what a call has returned from is on the disk
(``synchronous=FULL``). Each thread has a connection of its own. A file that was moved away or
replaced is not written any more: what went there nobody would find. Running state.
"""

import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from service.errors import Unavailable

WAIT = 10.0
"""s for another writer to finish"""

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
    # No NC code was an empty name.
    """
    UPDATE jobs SET request = json_replace(request, '$.nc_control', NULL)
    WHERE kind = 'advice' AND json_extract(request, '$.nc_control') = ''
    """,
)
"""one script for each version; the file's version is how many of them it has seen"""


class Database:
    """Connections to one file. Running state.

    Parameters
    ----------
    file : Path
        Made when it does not exist; its folder does.

    Raises
    ------
    Unavailable
        When it cannot be opened, or is of a newer version.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        self._local = threading.local()
        self._inode: tuple[int, int] | None = None
        with self.writing() as connection:
            _migrate(connection, file)
        self._inode = self._found()

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """A connection for queries."""
        with self._answering():
            yield self._connection()

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """A connection within a transaction: all of it or nothing; it waits for its turn."""
        with self._answering():
            connection = self._connection()
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.commit()
            except BaseException:
                connection.rollback()
                raise

    def _connection(self) -> sqlite3.Connection:
        known: sqlite3.Connection | None = getattr(self._local, "connection", None)
        if known is None:
            # Transactions are begun by hand.
            known = sqlite3.connect(self.file, timeout=WAIT, isolation_level=None)
            try:
                known.row_factory = sqlite3.Row
                known.execute("PRAGMA journal_mode=WAL")
                known.execute("PRAGMA synchronous=FULL")
            except sqlite3.Error:
                known.close()
                raise
            self._local.connection = known
        return known

    def close(self) -> None:
        """End this thread's connection."""
        known: sqlite3.Connection | None = getattr(self._local, "connection", None)
        if known is not None:
            known.close()
            self._local.connection = None

    def _found(self) -> tuple[int, int]:
        """Identity of the database file that lies there now."""
        try:
            found = os.stat(self.file)
        except OSError as error:
            raise Unavailable(f"{self.file.name}: {error.strerror or error}") from error
        return found.st_dev, found.st_ino

    @contextmanager
    def _answering(self) -> Iterator[None]:
        if self._inode is not None and self._found() != self._inode:
            raise Unavailable(f"{self.file.name}: it is another file than before")
        try:
            yield
        except sqlite3.Error as error:
            raise Unavailable(f"{self.file.name}: {error}") from error


def _migrate(connection: sqlite3.Connection, file: Path) -> None:
    """Bring a file of an older version up to date, within the transaction."""
    version = int(connection.execute("PRAGMA user_version").fetchone()[0])
    if version > len(SCHEMA):
        text = f"of version {version}; this program knows up to {len(SCHEMA)}"
        raise Unavailable(f"{file.name} is {text}: take a newer program")
    for number in range(version, len(SCHEMA)):
        for statement in SCHEMA[number].split(";"):
            connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {number + 1}")
