"""A bit that flips in a backup is found, or changes nothing.

``STEPNC_SEEDED`` sets how many bits are flipped, one at a time.
"""

import os
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from random import Random

import pytest

from kbe.backup import CHECKSUMS, add_checksums, backup, content, restore, why_damaged
from kbe.errors import KnowledgeError, StoreDamaged
from kbe.store import open_store
from stepnc_model.outcome import ProcessOutcome

SEEDED = int(os.environ.get("STEPNC_SEEDED", "25"))

OutcomeMaker = Callable[..., list[ProcessOutcome]]


@pytest.fixture
def file(tmp_path: Path, outcomes: OutcomeMaker) -> Path:
    path = tmp_path / "monday.db"
    with open_store(str(tmp_path / "store.db")) as store:
        store.add(outcomes(40))
        backup(store, str(path))
    return path


def changed(file: Path, statement: str) -> None:
    with closing(sqlite3.connect(file)) as connection:
        triggers = "SELECT name FROM sqlite_master WHERE type = 'trigger'"
        for (name,) in connection.execute(triggers).fetchall():
            connection.execute(f"DROP TRIGGER {name}")
        connection.execute(statement)
        connection.commit()


def test_a_number_that_changed_is_found_with_its_table(file: Path, tmp_path: Path) -> None:
    changed(file, "UPDATE outcome SET machine = 'vmc16' WHERE id = 7")
    with pytest.raises(StoreDamaged, match="rows of table 'outcome'"):
        restore(str(file), str(tmp_path / "new.db"))


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        (f"DROP TABLE {CHECKSUMS}", "table of checksums is missing"),
        (f"DELETE FROM {CHECKSUMS} WHERE name = 'outcome'", "table 'outcome' has no checksum"),
        ("CREATE TABLE other (x)", "table 'other' has no checksum"),
    ],
)
def test_checksums_that_are_missing_are_found(
    file: Path, tmp_path: Path, statement: str, message: str
) -> None:
    changed(file, statement)
    with pytest.raises(StoreDamaged, match=message):
        restore(str(file), str(tmp_path / "new.db"))


def test_a_backup_of_before_is_still_restored(file: Path, tmp_path: Path) -> None:
    changed(file, f"DROP TABLE {CHECKSUMS}")
    changed(file, "PRAGMA application_id = 0")
    assert restore(str(file), str(tmp_path / "new.db")).outcomes == 40


def test_checksums_do_not_come_back(file: Path, tmp_path: Path) -> None:
    restore(str(file), str(tmp_path / "new.db"))
    with closing(sqlite3.connect(tmp_path / "new.db")) as connection:
        names = [name for (name,) in connection.execute("SELECT name FROM sqlite_master")]
    assert CHECKSUMS not in names


def test_a_store_that_was_a_backup_is_backed_up_anew(
    file: Path, tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    again = tmp_path / "tuesday.db"
    with open_store(str(file)) as store:
        store.add(outcomes(2, run="next"))
        backup(store, str(again))
    assert restore(str(again), str(tmp_path / "new.db")).outcomes == 42


def test_comparing_twice_gives_the_same(file: Path) -> None:
    assert why_damaged(str(file)) == ""
    add_checksums(str(file))
    assert why_damaged(str(file)) == ""


def test_a_flipped_bit_is_found_or_changes_nothing(file: Path, tmp_path: Path) -> None:
    data, rng, found = file.read_bytes(), Random("bits"), 0
    with open_store(str(tmp_path / "store.db")) as store:
        wanted = content(store)
    for number in range(SEEDED):
        place, bit = rng.randrange(len(data)), rng.randrange(8)
        damaged = tmp_path / f"{number}.db"
        flipped = bytes([data[place] ^ (1 << bit)])
        damaged.write_bytes(data[:place] + flipped + data[place + 1 :])
        target = tmp_path / f"{number}.new.db"
        try:
            assert restore(str(damaged), str(target)) == wanted, (place, bit)
        except KnowledgeError:
            found += 1
        damaged.unlink()
        target.unlink(missing_ok=True)
    assert found > 0


def test_every_bit_of_a_row_is_found(file: Path, tmp_path: Path) -> None:
    """The rows themselves, where SQLite's own check sees nothing."""
    data = file.read_bytes()
    place = data.index(b"virtual machine")
    for bit in (0, 3):
        damaged = tmp_path / "damaged.db"
        damaged.write_bytes(
            data[:place] + bytes([data[place] ^ (1 << bit)]) + data[place + 1 :]
        )
        with pytest.raises(KnowledgeError):
            restore(str(damaged), str(tmp_path / "new.db"))
    shutil.copy(file, tmp_path / "good.db")
    assert restore(str(tmp_path / "good.db"), str(tmp_path / "new.db")).outcomes == 40
