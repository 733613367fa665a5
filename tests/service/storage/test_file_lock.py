"""One turn after the other, also between two opened files of one process."""

import fcntl
from pathlib import Path

import pytest

from service.storage.library import LOCK, locked


def is_free(folder: Path) -> bool:
    with (folder / LOCK).open("wb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
    return True


def test_nobody_else_has_it_until_it_ends(tmp_path: Path) -> None:
    with locked(tmp_path):
        assert not is_free(tmp_path)
    assert is_free(tmp_path)


def test_an_error_ends_it(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="within"), locked(tmp_path):
        raise ValueError("within")
    assert is_free(tmp_path)
