"""Checksums of the tables of a backup, which find a single bit that changed.

A page of SQLite has no checksum of its own: a digit that becomes another one is read like any
other. So a backup holds a table with the number of rows and the SHA-256 of every other table.
The application id of the file says that the table must be there.
"""

import hashlib
import sqlite3
from contextlib import closing

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
