"""What a database reports becomes an error that says what to do."""

import errno
import sqlite3
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlalchemy.exc import TimeoutError as NoFreeConnection

from kbe.connection import connected, fault, parsed_place, reading, translated
from kbe.errors import (
    KnowledgeError,
    StoreBusy,
    StoreDamaged,
    StoreFull,
    StoreReadOnly,
    StoreUnavailable,
)
from kbe.store import Store, open_store
from tests.every_case import every_case

FILE = parsed_place("kbe.db")
SERVER = parsed_place("postgresql://ann:secret@db/kbe")


@every_case(
    ("code", "kind"),
    [
        (sqlite3.SQLITE_CORRUPT, StoreDamaged),
        (sqlite3.SQLITE_CORRUPT_INDEX, StoreDamaged),
        (sqlite3.SQLITE_NOTADB, StoreDamaged),
        (sqlite3.SQLITE_FULL, StoreFull),
        (sqlite3.SQLITE_IOERR_WRITE, StoreFull),
        (sqlite3.SQLITE_IOERR_SHMSIZE, StoreFull),
        (sqlite3.SQLITE_IOERR_READ, StoreUnavailable),
        (sqlite3.SQLITE_BUSY, StoreBusy),
        (sqlite3.SQLITE_PROTOCOL, StoreBusy),
        (sqlite3.SQLITE_BUSY_SNAPSHOT, StoreBusy),
        (sqlite3.SQLITE_READONLY_DIRECTORY, StoreReadOnly),
        (sqlite3.SQLITE_CANTOPEN, StoreUnavailable),
        (sqlite3.SQLITE_MISUSE, KnowledgeError),
    ],
)
def test_sqlite_codes(code: int, kind: type[KnowledgeError]) -> None:
    error = sqlite3.OperationalError("what SQLite says")
    error.sqlite_errorcode = code
    assert type(fault(error, FILE)) is kind


class Refusal(Exception):
    """As psycopg's errors, which carry the code of the server."""

    def __init__(self, sqlstate: str | None) -> None:
        super().__init__("the server says secret\nand more")
        self.sqlstate = sqlstate


@every_case(
    ("state", "kind"),
    [
        (None, StoreUnavailable),
        ("08006", StoreUnavailable),
        ("28P01", StoreUnavailable),
        ("3D000", StoreUnavailable),
        ("3F000", StoreUnavailable),
        ("53300", StoreUnavailable),
        ("57P01", StoreUnavailable),
        ("53100", StoreFull),
        ("25006", StoreReadOnly),
        ("42501", StoreReadOnly),
        ("40P01", StoreBusy),
        ("55P03", StoreBusy),
        ("XX001", StoreDamaged),
        ("42601", KnowledgeError),
    ],
)
def test_postgresql_codes(state: str | None, kind: type[KnowledgeError]) -> None:
    """Appendix A of its manual."""
    found = fault(Refusal(state), SERVER)
    assert type(found) is kind
    assert "secret" not in str(found)
    assert found.place == "postgresql://ann@db/kbe"


@pytest.mark.parametrize(
    ("number", "kind"),
    [
        (errno.ENOSPC, StoreFull),
        (errno.EDQUOT, StoreFull),
        (errno.EACCES, StoreUnavailable),
        (errno.EROFS, StoreUnavailable),
    ],
)
def test_system_errors(number: int, kind: type[KnowledgeError]) -> None:
    with pytest.raises(kind, match=r"kbe\.db"), translated(FILE):
        raise OSError(number, "what the system says")


def test_no_free_connection_is_busy() -> None:
    with pytest.raises(StoreBusy), translated(FILE):
        raise NoFreeConnection


def test_file_that_is_no_database(tmp_path: Path) -> None:
    place = parsed_place(str(tmp_path / "letter.txt"))
    Path(place.file).write_text("Dear Ann, " * 500, encoding="utf-8")
    engine = connected(place)
    with pytest.raises(StoreDamaged, match="not a database"), reading(engine, place) as found:
        found.execute(text("SELECT 1 FROM outcome"))
    engine.dispose()


def test_nothing_listens_at_the_port() -> None:
    """Port 1 of loopback: refused at once."""
    with pytest.raises(StoreUnavailable, match="check that it runs") as caught:
        open_store("postgresql://ann:secret@127.0.0.1:1/kbe")
    assert "secret" not in str(caught.value)


def test_statement_that_is_wrong_names_the_place(store: Store) -> None:
    with (
        pytest.raises(KnowledgeError, match="please report"),
        reading(store.engine, store.place) as connection,
    ):
        connection.execute(text("SELECT 1 FROM nowhere"))
