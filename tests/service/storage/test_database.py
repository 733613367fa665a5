"""One file that several processes share: whole transactions, and no newer file is touched."""

import shutil
import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from subprocess import PIPE, Popen

import pytest

from service.errors import Unavailable
from service.storage.database import SCHEMA, FileDatabase

INSERT = "INSERT INTO requests VALUES (?, ?, 'print', 'made', 0.0)"


def count(database: FileDatabase) -> int:
    with database.reading() as connection:
        return int(connection.execute("SELECT count(*) FROM requests").fetchone()[0])


def version(file: Path) -> int:
    with closing(sqlite3.connect(file)) as connection:
        return int(connection.execute("PRAGMA user_version").fetchone()[0])


def test_a_new_file_gets_every_version_and_says_so(tmp_path: Path) -> None:
    database = FileDatabase(tmp_path / "service.db")
    assert version(database.file) == len(SCHEMA)
    with database.reading() as connection:
        found = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        assert {row["name"] for row in found} == {
            "programs", "files", "jobs", "requests", "keys", "runner",
        }  # fmt: skip
        assert connection.execute("PRAGMA journal_mode").fetchone()[0] == "wal"
        assert connection.execute("PRAGMA synchronous").fetchone()[0] == 2


def test_a_file_that_is_up_to_date_is_opened_as_it_is(tmp_path: Path) -> None:
    first = FileDatabase(tmp_path / "service.db")
    with first.writing() as connection:
        connection.execute(INSERT, ("anna", "1"))
    assert count(FileDatabase(tmp_path / "service.db")) == 1


def test_a_newer_file_is_refused_and_stays_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "service.db"
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("CREATE TABLE of_tomorrow (a)")
        connection.execute(f"PRAGMA user_version = {len(SCHEMA) + 1}")
    before = file.read_bytes()
    with pytest.raises(Unavailable, match="install a newer program") as refused:
        FileDatabase(file)
    assert str(tmp_path) not in str(refused.value)
    with closing(sqlite3.connect(file)) as connection:
        names = connection.execute("SELECT name FROM sqlite_master").fetchall()
    assert names == [("of_tomorrow",)]
    assert len(file.read_bytes()) >= len(before)


def test_a_migration_that_breaks_off_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "service.storage.database.SCHEMA", (*SCHEMA, "CREATE TABLE half (a); CREATE nonsense")
    )
    with pytest.raises(Unavailable):
        FileDatabase(tmp_path / "service.db")
    assert version(tmp_path / "service.db") == 0
    monkeypatch.undo()
    assert count(FileDatabase(tmp_path / "service.db")) == 0


def test_a_file_that_is_no_database_is_refused_without_its_folder(tmp_path: Path) -> None:
    (tmp_path / "service.db").write_bytes(b"no database at all, but long enough" * 100)
    with pytest.raises(Unavailable, match=r"^service\.db: ") as refused:
        FileDatabase(tmp_path / "service.db")
    assert str(tmp_path) not in str(refused.value)


def test_a_transaction_is_kept_whole_or_not_at_all(tmp_path: Path) -> None:
    database = FileDatabase(tmp_path / "service.db")

    def half() -> None:
        with database.writing() as connection:
            connection.execute(INSERT, ("anna", "1"))
            connection.execute(INSERT, ("anna", "2"))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        half()
    assert count(database) == 0

    def twice() -> None:
        with database.writing() as connection:
            connection.execute(INSERT, ("anna", "1"))
            connection.execute(INSERT, ("anna", "1"))

    with pytest.raises(Unavailable, match="UNIQUE"):
        twice()
    assert count(database) == 0
    with database.writing() as connection:
        connection.execute(INSERT, ("anna", "1"))
    assert count(database) == 1


def test_a_reader_does_not_wait_for_a_writer(tmp_path: Path) -> None:
    database, other = (
        FileDatabase(tmp_path / "service.db"),
        FileDatabase(tmp_path / "service.db"),
    )
    with database.writing() as connection:
        connection.execute(INSERT, ("anna", "1"))
        assert count(other) == 0
    assert count(other) == 1


def test_a_connection_is_made_anew_after_it_was_closed(tmp_path: Path) -> None:
    database = FileDatabase(tmp_path / "service.db")
    database.close()
    database.close()
    assert count(database) == 0


def test_a_file_that_was_moved_away_is_not_written_and_not_made_anew(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    folder.mkdir()
    database = FileDatabase(folder / "service.db")
    folder.rename(tmp_path / "moved")
    for ask in (database.reading, database.writing):
        with pytest.raises(Unavailable, match=r"^service\.db: No such file"), ask():
            """not met"""
    folder.mkdir()
    FileDatabase(folder / "service.db")
    with pytest.raises(Unavailable, match="replaced by another one"):
        count(database)
    shutil.rmtree(folder)
    (tmp_path / "moved").rename(folder)
    assert count(database) == 0


def test_a_transaction_that_cannot_be_closed_leaves_the_connection_usable(
    tmp_path: Path,
) -> None:
    database = FileDatabase(tmp_path / "service.db")
    with database.writing() as connection:
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute("CREATE TABLE a (id PRIMARY KEY)")
        late = "REFERENCES a (id) DEFERRABLE INITIALLY DEFERRED"
        connection.execute(f"CREATE TABLE b (a {late})")
    with database.reading() as connection:
        connection.execute("PRAGMA foreign_keys = ON")

    def refused() -> None:
        with database.writing() as connection:
            connection.execute("INSERT INTO b VALUES (1)")

    with pytest.raises(Unavailable, match="FOREIGN KEY"):
        refused()
    with database.writing() as connection:
        connection.execute(INSERT, ("anna", "1"))
    assert count(database) == 1


WRITER = """
import sys
from pathlib import Path
from service.storage.database import FileDatabase
sys.stdin.read(1)
database = FileDatabase(Path(sys.argv[1]))
for number in range(25):
    with database.writing() as connection:
        connection.execute("INSERT INTO requests VALUES (?, ?, '', '', 0)",
                           (sys.argv[2], str(number)))
"""


def test_processes_that_open_a_new_file_at_once_lose_nothing(tmp_path: Path) -> None:
    file = tmp_path / "service.db"
    writers = [
        Popen([sys.executable, "-c", WRITER, str(file), str(number)], stdin=PIPE, stderr=PIPE)
        for number in range(4)
    ]
    for writer in writers:
        assert writer.stdin is not None
        writer.stdin.write(b"!")
        writer.stdin.flush()
    for writer in writers:
        _, told = writer.communicate(timeout=120.0)
        assert (writer.returncode, told) == (0, b"")
    assert count(FileDatabase(file)) == 4 * 25
