"""Making and upgrading the tables of a store."""

import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import psycopg
import pytest
from sqlalchemy import make_url, text

from kbe.connection import _write_ahead, connected, parsed_place, writing
from kbe.errors import StoreDamaged, StoreTooNew, StoreUnavailable
from kbe.schema import VERSION_TABLE
from kbe.store import Store, open_store
from stepnc_model.outcome import ProcessOutcome

OutcomeMaker = Callable[..., list[ProcessOutcome]]
UrlMaker = Callable[[], str]


def test_opening_again_finds_what_was_kept(url: str, outcomes: OutcomeMaker) -> None:
    with open_store(url) as store:
        store.add(outcomes(3))
    with open_store(url, is_new_allowed=False) as store:
        assert list(store.outcomes()) == outcomes(3)


OPENER = """
import sys
from kbe.store import open_store
print("ready", flush=True)
sys.stdin.readline()
with open_store(sys.argv[1]) as store:
    print(store.count(), flush=True)
"""


def test_programs_that_make_it_at_once_both_succeed(url: str) -> None:
    programs = [
        subprocess.Popen(
            [sys.executable, "-c", OPENER, url],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    for program in programs:
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
    for program in programs:
        assert program.stdin is not None
        program.stdin.write("go\n")
        program.stdin.flush()
    assert [program.communicate(timeout=120.0)[0] for program in programs] == ["0\n"] * 2
    assert [program.returncode for program in programs] == [0] * 2


def test_mode_of_a_new_file_is_set_by_many_at_once(sqlite_place: UrlMaker) -> None:
    """SQLite reports a lock at once here, in about one of thirty tries, and does not wait."""
    places = [parsed_place(sqlite_place()) for _ in range(60)]
    gate = Barrier(4)

    def set_modes() -> None:
        for place in places:
            engine = connected(place)
            gate.wait(timeout=120.0)
            _write_ahead(engine, place)
            engine.dispose()

    with ThreadPoolExecutor(4) as pool:
        for each in [pool.submit(set_modes) for _ in range(4)]:
            each.result(timeout=120.0)


def test_newer_schema_is_left_alone(store: Store, url: str) -> None:
    with writing(store.engine, store.place) as connection:
        connection.execute(text(f"UPDATE {VERSION_TABLE} SET version_num = '9999'"))
    with pytest.raises(StoreTooNew, match="install the newer") as caught:
        open_store(url)
    assert caught.value.actual == "9999"


def test_tables_of_another_program_are_left_alone(store: Store, url: str) -> None:
    with writing(store.engine, store.place) as connection:
        connection.execute(text(f"DROP TABLE {VERSION_TABLE}"))
    with pytest.raises(StoreUnavailable, match="is not a knowledge base"):
        open_store(url)


def test_empty_database_must_be_allowed(url: str, tmp_path: Path) -> None:
    if not url.startswith("postgresql"):
        url = str(tmp_path / "empty.db")
        Path(url).touch()
    with pytest.raises(StoreUnavailable, match="is empty; check the name"):
        open_store(url, is_new_allowed=False)


def test_database_that_is_not_unicode_is_refused(postgres_url: str) -> None:
    name = "latin_kbe"
    latin = make_url(postgres_url).set(database=name)
    with psycopg.connect(postgres_url, autocommit=True) as connection:
        connection.execute(f"DROP DATABASE IF EXISTS {name}")
        connection.execute(
            f"CREATE DATABASE {name} ENCODING 'LATIN1' LOCALE 'C' TEMPLATE template0"
        )
        try:
            with pytest.raises(StoreUnavailable, match="ENCODING 'UTF8'"):
                open_store(latin.render_as_string(hide_password=False))
        finally:
            connection.execute(f"DROP DATABASE {name}")


@pytest.mark.parametrize(
    "change",
    [
        f"UPDATE {VERSION_TABLE} SET version_num = '0000'",
        f"INSERT INTO {VERSION_TABLE} VALUES ('0')",
    ],
)
def test_a_version_that_never_was_is_damage(sqlite_place: UrlMaker, change: str) -> None:
    place = sqlite_place()
    with open_store(place) as store, writing(store.engine, store.place) as connection:
        connection.execute(text(change))
    with pytest.raises(StoreDamaged, match="unknown schema version"):
        open_store(place)
