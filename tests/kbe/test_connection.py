"""Connections and transactions."""

import sys
from pathlib import Path

import pytest
from sqlalchemy import text

from kbe.connection import connected, parsed_place, reading, snapshot, writing
from kbe.errors import DriverMissing, StoreBusy
from kbe.store import Store, open_store


def test_sqlite_writes_ahead_and_syncs_every_commit(tmp_path: Path) -> None:
    names = ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
    with (
        open_store(str(tmp_path / "kbe.db")) as store,
        reading(store.engine, store.place) as connection,
    ):
        found = {
            name: connection.execute(text(f"PRAGMA {name}")).scalar_one() for name in names
        }
    # https://sqlite.org/pragma.html#pragma_synchronous: 2 is FULL.
    assert found == {
        "journal_mode": "wal",
        "synchronous": 2,
        "foreign_keys": 1,
        "busy_timeout": 30_000,
    }


def test_missing_driver_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(DriverMissing, match=r"pip install 'stepnc-optimiser\[postgres\]'"):
        connected(parsed_place("postgresql://ann:secret@db/kbe"))


def test_second_writer_waits_only_so_long(tmp_path: Path) -> None:
    place = parsed_place(str(tmp_path / "kbe.db"))
    with open_store(place.file):
        first, second = connected(place), connected(place, patience=0.01)
        with writing(first, place), reading(second, place) as reader:
            # Who reads does not wait.
            assert reader.execute(text("SELECT count(*) FROM outcome")).scalar_one() == 0
        with writing(first, place), pytest.raises(StoreBusy), writing(second, place):
            pass
        first.dispose()
        second.dispose()


def test_error_undoes_the_whole_transaction(store: Store) -> None:
    def fails_half_way() -> None:
        with writing(store.engine, store.place) as connection:
            connection.execute(text("CREATE TABLE half (id INTEGER)"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails_half_way()
    with reading(store.engine, store.place) as connection:
        assert not connection.dialect.has_table(connection, "half")


def test_snapshot_does_not_see_what_comes_later(store: Store) -> None:
    query = text("SELECT count(*) FROM half")
    with writing(store.engine, store.place) as connection:
        connection.execute(text("CREATE TABLE half (id INTEGER)"))
    with snapshot(store.engine, store.place) as early:
        assert early.execute(query).scalar_one() == 0
        with writing(store.engine, store.place) as connection:
            connection.execute(text("INSERT INTO half VALUES (1)"))
        assert early.execute(query).scalar_one() == 0
    with snapshot(store.engine, store.place) as late:
        assert late.execute(query).scalar_one() == 1
