"""A store is read where nothing can be written: a full disk, or one that is read-only."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from kbe.errors import StoreFull, StoreUnavailable
from kbe.store import open_store, open_to_read
from stepnc_model.outcome import ProcessOutcome
from tests.full_disk import files_of_at_most
from tests.rights import Capability, without

OutcomeMaker = Callable[..., list[ProcessOutcome]]


@pytest.fixture
def file(tmp_path: Path, outcomes: OutcomeMaker) -> Path:
    folder = tmp_path / "full"
    folder.mkdir()
    with open_store(str(folder / "kbe.db")) as store:
        store.add(outcomes(5))
    return folder / "kbe.db"


def test_a_store_on_a_full_disk_is_read(file: Path, outcomes: OutcomeMaker) -> None:
    with files_of_at_most(0):
        with pytest.raises(StoreFull):
            open_store(str(file))
        with open_to_read(str(file)) as store:
            assert list(store.outcomes()) == outcomes(5)
            store.check()
        left = [each.name for each in file.parent.iterdir() if each.stat().st_size]
        assert left == ["kbe.db"]
    with open_store(str(file)) as store:
        assert store.add(outcomes(6)) == 1


def test_what_a_crash_has_left_in_the_log_is_read(
    file: Path, tmp_path: Path, outcomes: OutcomeMaker
) -> None:
    """The folder may not be written, and the rows stand in the log alone."""
    crashed = tmp_path / "crashed"
    crashed.mkdir()
    with open_store(str(file)) as store:
        store.add(outcomes(9))
        for name in ("kbe.db", "kbe.db-wal"):
            shutil.copyfile(file.with_name(name), crashed / name)
    crashed.chmod(0o555)
    with without(Capability.DAC_OVERRIDE):
        with open_to_read(str(crashed / "kbe.db")) as store:
            assert list(store.outcomes()) == outcomes(9)
            copy = Path(store.place.file)
        assert not copy.parent.exists() or copy.parent == crashed
    assert sorted(each.name for each in crashed.iterdir()) == ["kbe.db", "kbe.db-wal"]


def test_a_store_that_is_missing_stays_so(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="no such file"):
        open_to_read(str(tmp_path / "none.db"))
