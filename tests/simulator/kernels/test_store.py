"""Files of machine code are whole, found wherever they may be written, and few."""

from pathlib import Path

import pytest

from simulator.kernels import store


def test_what_was_saved_is_found(folder: Path) -> None:
    assert store.load("march", "1") is None
    store.save("march", "1", b"code")
    assert store.load("march", "1") == b"code"
    assert store.load("march", "2") is None
    assert [path.name for path in folder.iterdir()] == ["march-1.o"]


@pytest.mark.parametrize("damage", [b"", b"short", b"x" * 40])
def test_a_damaged_file_counts_as_none(folder: Path, damage: bytes) -> None:
    store.save("march", "1", b"code")
    (folder / "march-1.o").write_bytes(damage)
    assert store.load("march", "1") is None


def test_where_sources_are_read_only_the_users_cache_serves(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder.write_bytes(b"a file in the way of the folder")
    store.save("march", "1", b"code")
    assert store.load("march", "1") == b"code"
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parent / "other"))
    assert store.load("march", "1") is None


def test_where_nothing_may_be_written_nothing_is(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder.write_bytes(b"a file in the way of the folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    store.save("march", "1", b"code")
    assert store.load("march", "1") is None


def test_old_files_of_a_kernel_go(folder: Path) -> None:
    store.save("bore", "1", b"code")
    for number in range(store.KEPT + 3):
        store.save("march", str(number), b"code")
    assert len(list(folder.glob("march-*.o"))) == store.KEPT
    assert store.load("bore", "1") == b"code"
    assert store.load("march", str(store.KEPT + 2)) == b"code"
