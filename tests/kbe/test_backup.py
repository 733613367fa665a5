"""Backups and what is restored from them, from each database to each."""

import errno
import hashlib
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest
from sqlalchemy import insert, text

from kbe.backup import _require_same, _take_name, backup, content, restore
from kbe.connection import parsed_place, reading, writing
from kbe.errors import (
    BackupDiffers,
    BackupExists,
    StoreDamaged,
    StoreNotEmpty,
    StoreTooNew,
    StoreUnavailable,
)
from kbe.rows import outcome_row
from kbe.schema import VERSION_TABLE, outcome
from kbe.store import Store, open_store
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome

OutcomeMaker = Callable[..., list[ProcessOutcome]]
UrlMaker = Callable[[], str]

LATER = datetime(2026, 4, 1, tzinfo=UTC)


def fill(store: Store, outcomes: list[ProcessOutcome], proposal: LearnedCorrection) -> None:
    """Everything that a store can hold; ids with a gap, as PostgreSQL leaves after an error."""
    store.add(outcomes)
    with writing(store.engine, store.place) as connection:
        row = {"id": 10_000} | outcome_row(replace(outcomes[0], force_ratio=None, sequence=1))
        connection.execute(insert(outcome), row)
    kept, dropped, open_one = (
        store.propose(replace(proposal, log_centre=centre)) for centre in (0.1, 0.2, 0.3)
    )
    store.accept(kept, by="Ann", at=LATER)
    store.withdraw(dropped, by="Bob", at=LATER)
    assert open_one


@pytest.fixture
def full(store: Store, outcomes: OutcomeMaker, proposal: LearnedCorrection) -> Store:
    fill(store, outcomes(1010), proposal)
    return store


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "backups"
    made.mkdir()
    return made


@pytest.fixture
def file(
    sqlite_place: UrlMaker, folder: Path, outcomes: OutcomeMaker, proposal: LearnedCorrection
) -> str:
    """A backup of a store in SQLite."""
    path = str(folder / "monday.db")
    with open_store(sqlite_place()) as store:
        fill(store, outcomes(10), proposal)
        backup(store, path)
    return path


@pytest.fixture(params=["sqlite_place", "postgres_place"])
def target(request: pytest.FixtureRequest) -> str:
    place: UrlMaker = request.getfixturevalue(request.param)
    return place()


def test_all_comes_back_from_each_database_to_each(
    full: Store, folder: Path, target: str, proposal: LearnedCorrection, outcomes: OutcomeMaker
) -> None:
    file = folder / "monday.db"
    assert backup(full, str(file)) == content(full)
    # Nothing of the work is left beside it.
    assert list(folder.iterdir()) == [file]
    found = restore(str(file), target)
    assert found == content(full)
    assert (found.outcomes, found.corrections, found.decisions) == (1011, 3, 2)
    with open_store(target, is_new_allowed=False) as store:
        assert list(store.outcomes()) == list(full.outcomes())
        assert store.corrections() == full.corrections()
        assert store.accepted(proposal.context) == full.accepted(proposal.context)
        # And it goes on from there.
        store.add(outcomes(2, run="next"))
        store.withdraw(store.propose(proposal), by="Ann", at=LATER)
        assert store.count() == 1013


def test_restoring_twice_does_nothing_the_second_time(file: str, target: str) -> None:
    assert restore(file, target) == restore(file, target)
    with open_store(target) as store:
        assert store.count() == 11


def test_store_with_anything_else_in_it_is_left_alone(
    file: str, target: str, outcomes: OutcomeMaker
) -> None:
    with open_store(target) as store:
        store.add(outcomes(1))
    with pytest.raises(StoreNotEmpty, match="restore into a new file") as caught:
        restore(file, target)
    assert caught.value.rows == 1
    with open_store(target) as store:
        assert list(store.outcomes()) == outcomes(1)


def test_backup_opens_as_a_store(file: str, folder: Path, outcomes: OutcomeMaker) -> None:
    with open_store(file, is_new_allowed=False) as store:
        assert [each for each in store.outcomes() if each.force_ratio] == outcomes(10)
    assert [each.name for each in folder.iterdir()] == ["monday.db"]


def test_backup_never_overwrites(store: Store, file: str, tmp_path: Path) -> None:
    before = Path(file).read_bytes()
    with pytest.raises(BackupExists, match="name another file"):
        backup(store, file)
    dangling = tmp_path / "dangling.db"
    dangling.symlink_to(tmp_path / "nowhere.db")
    with pytest.raises(BackupExists):
        backup(store, str(dangling))
    assert Path(file).read_bytes() == before


def test_backup_goes_to_a_file_in_a_folder(store: Store, tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="a backup must be a file"):
        backup(store, "postgresql://ann:secret@db/kbe")
    with pytest.raises(StoreUnavailable, match="the folder does not exist"):
        backup(store, str(tmp_path / "missing" / "monday.db"))


def test_restoring_needs_a_backup(tmp_path: Path) -> None:
    target = str(tmp_path / "new.db")
    with pytest.raises(StoreUnavailable, match="no such file"):
        restore(str(tmp_path / "missing.db"), target)
    letter = tmp_path / "letter.txt"
    letter.write_text("Dear Ann, " * 500, encoding="utf-8")
    with pytest.raises(StoreDamaged, match=r"letter\.txt"):
        restore(str(letter), target)
    (tmp_path / "empty.db").touch()
    with pytest.raises(StoreUnavailable, match="is empty"):
        restore(str(tmp_path / "empty.db"), target)
    # A target that nothing came into was not made either.
    assert not Path(target).exists()


def test_damaged_backup_is_refused_and_left_as_it_is(
    sqlite_place: UrlMaker, tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    path = tmp_path / "monday.db"
    with open_store(sqlite_place()) as store:
        store.add(outcomes(500))
        backup(store, str(path))
    with path.open("r+b") as file:
        file.seek(path.stat().st_size // 2)
        file.write(b"\xa5" * 4096)
    before = hashlib.sha256(path.read_bytes()).digest()
    target = sqlite_place()
    with pytest.raises(StoreDamaged, match=r"monday\.db"):
        restore(str(path), target)
    assert hashlib.sha256(path.read_bytes()).digest() == before
    assert not Path(target).exists()


def test_damaged_store_gives_no_backup(
    sqlite_place: UrlMaker, tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    name = sqlite_place()
    with open_store(name) as store:
        store.add(outcomes(500))
    with Path(name).open("r+b") as file:
        file.seek(Path(name).stat().st_size // 2)
        file.write(b"\xa5" * 4096)
    with open_store(name) as store, pytest.raises(StoreDamaged) as caught:
        backup(store, str(tmp_path / "monday.db"))
    assert caught.value.place == name
    assert not (tmp_path / "monday.db").exists()


def test_backup_of_a_newer_program_is_refused(sqlite_place: UrlMaker, tmp_path: Path) -> None:
    path = str(tmp_path / "monday.db")
    with open_store(sqlite_place()) as store:
        with writing(store.engine, store.place) as connection:
            connection.execute(text(f"UPDATE {VERSION_TABLE} SET version_num = '9999'"))
        with pytest.raises(StoreTooNew):
            backup(store, path)
    assert not Path(path).exists()


def test_backup_has_what_is_still_in_the_log(
    sqlite_place: UrlMaker, tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    name = sqlite_place()
    with open_store(name) as store:
        store.add(outcomes(7))
        assert Path(f"{parsed_place(name).file}-wal").stat().st_size > 0
        assert backup(store, str(tmp_path / "monday.db")).outcomes == 7


def test_fingerprint_tells_stores_apart(sqlite_place: UrlMaker, outcomes: OutcomeMaker) -> None:
    found = []
    for kept in (outcomes(3), outcomes(3), outcomes(3)[::-1], outcomes(2)):
        with open_store(sqlite_place()) as store:
            store.add(kept)
            found.append(content(store).fingerprint)
    assert found[0] == found[1]
    assert len(set(found)) == 3


def test_disk_without_second_names_takes_a_backup_too(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Memory sticks (FAT): link() is refused, EPERM."""

    def refuse(source: str, target: str) -> None:
        raise PermissionError(errno.EPERM, f"{source} to {target}")

    monkeypatch.setattr("os.link", refuse)
    path = tmp_path / "monday.db"
    assert backup(store, str(path)).rows == 0
    with pytest.raises(BackupExists):
        backup(store, str(path))
    path.write_text("another took the name meanwhile", encoding="utf-8")
    with pytest.raises(BackupExists):
        _take_name(str(tmp_path / "fresh.db"), parsed_place(str(path)))
    assert path.read_text(encoding="utf-8").startswith("another")


def test_copy_that_differs_is_refused(store: Store, outcomes: OutcomeMaker) -> None:
    store.add(outcomes(2))
    wanted = content(store)
    store.add(outcomes(1, run="next"))
    with pytest.raises(BackupDiffers), reading(store.engine, store.place) as connection:
        _require_same(connection, wanted, store.place)
