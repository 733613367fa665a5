"""Backup and restore of a knowledge base, as a single SQLite file for any database.

A backup file appears complete under its name or not at all, and never replaces another file. A
restore fills an empty store in one transaction; before it is committed, every row is compared
with the backup.

Checksums of the tables of a backup, which find a single bit that changed.

A page of SQLite has no checksum of its own: a digit that becomes another one is read like any
other. So a backup holds a table with the number of rows and the SHA-256 of every other table.
The application id of the file says that the table must be there.
"""

import hashlib
import os
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, CursorResult, Table, func, insert, select, text
from sqlalchemy.engine import URL

from kbe.connection import (
    StoreLocation,
    parsed_place,
    reading,
    require_openable,
    snapshot,
    translated,
    writing,
)
from kbe.errors import (
    BackupDiffers,
    BackupExists,
    StoreDamaged,
    StoreNotEmpty,
    StoreUnavailable,
)
from kbe.schema import TABLES
from kbe.store import AT_ONCE, Store, open_place, open_store

CHECKSUMS = "backup_checksum"
"""Name of the table of checksums."""

APPLICATION_ID = 0x53744E63
"""Application id (the letters StNc) of a file that has such a table."""


def add_checksums(file: str) -> None:
    """Write the checksums of all tables into an SQLite file, replacing those it holds."""
    with closing(sqlite3.connect(file)) as connection:
        connection.execute(f"DROP TABLE IF EXISTS {CHECKSUMS}")
        sums = [(name, *_sum_of(connection, name)) for name in _tables(connection)]
        connection.execute(
            f"CREATE TABLE {CHECKSUMS} "
            "(name TEXT PRIMARY KEY, number INTEGER NOT NULL, sha256 TEXT NOT NULL)"
        )
        connection.executemany(f"INSERT INTO {CHECKSUMS} VALUES (?, ?, ?)", sums)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.commit()


def why_damaged(file: str) -> str:
    """Reason why the rows of a backup are not those that were written; empty if they are.

    Files without checksums, of earlier versions, are not refused.

    Parameters
    ----------
    file : str
        Path of an SQLite file; its table of checksums is removed once they are compared.
    """
    with closing(sqlite3.connect(file)) as connection:
        try:
            return _compared(connection)
        except sqlite3.DatabaseError as error:
            return str(error)


def _compared(connection: sqlite3.Connection) -> str:
    """Compare all tables with their checksums, then drop these."""
    (mark,) = connection.execute("PRAGMA application_id").fetchone()
    query = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?"
    is_there = connection.execute(query, (CHECKSUMS,)).fetchone() is not None
    if not is_there:
        return "the table of checksums is missing" if mark == APPLICATION_ID else ""
    wanted = {
        name: (number, sum)
        for name, number, sum in connection.execute(f"SELECT * FROM {CHECKSUMS}")
    }
    tables = _tables(connection)
    if changed := sorted(wanted.keys() ^ set(tables)):
        return f"table '{changed[0]}' has no checksum, or is missing"
    for name in tables:
        if _sum_of(connection, name) != wanted[name]:
            return f"the rows of table '{name}' do not have the checksum that was written"
    connection.execute(f"DROP TABLE {CHECKSUMS}")
    connection.execute("PRAGMA application_id = 0")
    connection.commit()
    return ""


def _tables(connection: sqlite3.Connection) -> list[str]:
    """Names of all tables but those of SQLite and of the checksums."""
    query = "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"
    names = [str(name) for (name,) in connection.execute(query)]
    return [name for name in names if name != CHECKSUMS and not name.startswith("sqlite_")]


def _sum_of(connection: sqlite3.Connection, table: str) -> tuple[int, str]:
    """Number of rows of a table, and SHA-256 of its definition and its rows."""
    quoted = table.replace('"', '""')
    hasher, number = hashlib.sha256(), 0
    query = "SELECT sql FROM sqlite_master WHERE type = 'table' AND name = ?"
    hasher.update(repr(connection.execute(query, (table,)).fetchone()).encode())
    for row in connection.execute(f'SELECT * FROM "{quoted}" ORDER BY rowid'):
        hasher.update(repr(row).encode())
        number += 1
    return number, hasher.hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """Row counts of a store, with a fingerprint of all rows."""

    outcomes: int
    corrections: int
    decisions: int
    fingerprint: str

    @property
    def rows(self) -> int:
        """Total number of rows in all tables."""
        return self.outcomes + self.corrections + self.decisions


def backup(store: Store, path: str) -> Content:
    """Copy a store to a new file while others continue to write to it.

    Raises
    ------
    BackupExists
        When a file of this name already exists.
    KnowledgeError
        When the store cannot be read, or the file cannot be written.
    """
    place = _file(path)
    require_openable(place, is_new_allowed=True)
    with _new_file(place) as fresh:
        try:
            return _copied(store, fresh)
        except StoreDamaged as error:
            raise StoreDamaged(store.place.shown, reason=error.reason) from error


def restore(path: str, url_or_path: str) -> Content:
    """Fill an empty store from a backup; do nothing if it holds the same rows already.

    Raises
    ------
    StoreNotEmpty
        When the store holds other rows.
    StoreDamaged
        When the backup is damaged.
    KnowledgeError
        When the backup or the store cannot be opened, or the store cannot be written.
    """
    with _readable(path) as source, open_store(url_or_path) as target:
        with (
            reading(source.engine, source.place) as rows,
            writing(target.engine, target.place) as connection,
        ):
            _keep_others_out(connection)
            wanted, found = _content(rows), _content(connection)
            if found.rows and found != wanted:
                raise StoreNotEmpty(target.place.shown, rows=found.rows)
            if found != wanted:
                _copy_rows(rows, connection)
                _require_same(connection, wanted, target.place)
        return wanted


def content(store: Store) -> Content:
    """Count and fingerprint the rows of a store in a consistent snapshot."""
    with snapshot(store.engine, store.place) as connection:
        return _content(connection)


def _file(path: str) -> StoreLocation:
    """Location of a backup file."""
    place = parsed_place(path)
    if not place.file:
        raise StoreUnavailable(place.shown, reason="a backup must be a file; give a file name")
    return place


def _moved(place: StoreLocation, file: str) -> StoreLocation:
    """Location of a temporary file that is shown to users under the name of another place."""
    url = URL.create("sqlite+pysqlite", database=file)
    return StoreLocation(url=url, shown=place.shown, file=file)


@contextmanager
def _new_file(place: StoreLocation) -> Iterator[StoreLocation]:
    """Write to a temporary place beside the target, and rename it on success."""
    folder, name = os.path.split(os.path.abspath(place.file))
    if os.path.lexists(place.file):
        raise BackupExists(place.shown)
    with (
        translated(place),
        tempfile.TemporaryDirectory(prefix=".backup-", dir=folder) as beside,
    ):
        fresh = os.path.join(beside, name)
        yield _moved(place, fresh)
        _sync(fresh)
        _take_name(fresh, place)
        _sync(folder)


def _take_name(fresh: str, place: StoreLocation) -> None:
    """Give a finished file its final name, unless that name is taken."""
    try:
        os.link(fresh, place.file)
    except FileExistsError as error:
        raise BackupExists(place.shown) from error
    except OSError:
        # Some file systems, as of memory sticks, do not support hard links.
        if os.path.lexists(place.file):
            raise BackupExists(place.shown) from None
        os.rename(fresh, place.file)


def _sync(path: str) -> None:
    """Wait until a file or folder has been written to disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _copied(store: Store, fresh: StoreLocation) -> Content:
    """Copy a store to a file, and read the copy back completely."""
    if store.place.file:
        _copy_pages(store.place, fresh)
        _require_one_file(fresh)
    else:
        with (
            snapshot(store.engine, store.place) as rows,
            open_place(fresh, is_new_allowed=True) as copy,
            writing(copy.engine, fresh) as connection,
        ):
            _copy_rows(rows, connection)
            _require_same(connection, _content(rows), fresh)
        _require_one_file(fresh)
    with open_place(fresh, is_new_allowed=False) as copy:
        copy.check()
        found = content(copy)
    add_checksums(fresh.file)
    return found


def _copy_pages(place: StoreLocation, fresh: StoreLocation) -> None:
    """Copy an SQLite file as it is at one moment, without blocking its writers."""
    with (
        closing(sqlite3.connect(place.reading_address, uri=True)) as source,
        closing(sqlite3.connect(fresh.file)) as target,
    ):
        source.backup(target)


def _require_one_file(fresh: StoreLocation) -> None:
    """Merge the write-ahead log into the database file, and keep no log."""
    with closing(sqlite3.connect(fresh.file)) as connection:
        connection.execute("PRAGMA journal_mode = DELETE")


@contextmanager
def _readable(path: str) -> Iterator[Store]:
    """Open a temporary copy of a backup as a store, because an old one must be upgraded."""
    place = _file(path)
    require_openable(place, is_new_allowed=False)
    with translated(place), tempfile.TemporaryDirectory(prefix="stepnc-restore-") as folder:
        copy = _moved(place, str(Path(folder) / "copy.db"))
        _copy_pages(place, copy)
        if reason := why_damaged(copy.file):
            raise StoreDamaged(place.shown, reason=reason)
        with open_place(copy, is_new_allowed=False) as store:
            store.check()
            yield store


def _keep_others_out(connection: Connection) -> None:
    """Lock the store from the check that it is empty until the last row is written."""
    if connection.dialect.name == "postgresql":
        names = ", ".join(table.name for table in TABLES)
        connection.execute(text(f"LOCK TABLE {names} IN SHARE ROW EXCLUSIVE MODE"))


def _copy_rows(source: Connection, target: Connection) -> None:
    """Copy all rows of all tables with their ids."""
    for table in TABLES:
        rows = [each.name for each in table.columns]
        for part in _rows(source, table).partitions():
            target.execute(insert(table), [dict(zip(rows, row, strict=True)) for row in part])
        if target.dialect.name == "postgresql":
            _count_on(target, table)


def _count_on(connection: Connection, table: Table) -> None:
    """Advance PostgreSQL's sequences beyond the ids of the restored rows."""
    last = connection.execute(select(func.max(table.c.id))).scalar_one()
    if last is not None:
        sequence = func.pg_get_serial_sequence(table.name, "id")
        connection.execute(select(func.setval(sequence, last)))


def _require_same(connection: Connection, wanted: Content, place: StoreLocation) -> None:
    """Raise an error if a copy differs from its source."""
    if _content(connection) != wanted:
        raise BackupDiffers(place.shown)


def _rows(connection: Connection, table: Table) -> "CursorResult[Any]":
    """Read all rows of a table in order, in batches."""
    query = select(table).order_by(table.c.id).execution_options(yield_per=AT_ONCE)
    return connection.execute(query)


def _content(connection: Connection) -> Content:
    """Count all rows and hash them in order."""
    hasher = hashlib.sha256()
    counts = []
    for table in TABLES:
        count = 0
        for row in _rows(connection, table):
            hasher.update(repr(tuple(row)).encode())
            count += 1
        hasher.update(f"{table.name} {count}".encode())
        counts.append(count)
    return Content(
        outcomes=counts[0],
        corrections=counts[1],
        decisions=counts[2],
        fingerprint=hasher.hexdigest(),
    )
