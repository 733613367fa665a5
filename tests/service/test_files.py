"""Files are written whole or not at all."""

import errno
import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from service.files import open_lines, read_bytes, write_atomically
from stepnc_model import regular_file
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.regular_file import open_regular
from tests.every_case import every_case
from tests.full_disk import files_of_at_most


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_new_file_holds_the_bytes_and_nothing_else_is_left(tmp_path: Path) -> None:
    write_atomically(tmp_path / "new.stpnc", b"bytes\r\n\x00")
    assert (tmp_path / "new.stpnc").read_bytes() == b"bytes\r\n\x00"
    assert names(tmp_path) == ["new.stpnc"]


def test_a_new_file_has_the_permissions_that_the_umask_leaves(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_atomically(tmp_path / "new", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o640


def test_a_replaced_file_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "old"
    path.write_bytes(b"old")
    path.chmod(0o604)
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o604


def test_who_reads_the_old_file_reads_it_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "old"
    path.write_bytes(b"old")
    with path.open("rb") as reader:
        write_atomically(path, b"new")
        assert reader.read() == b"old"


def test_a_file_that_outgrows_its_quota_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "old"
    path.write_bytes(b"old")
    with files_of_at_most(1_000), pytest.raises(WriteError, match=r"old: File too large"):
        write_atomically(path, b"x" * 5_000)
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["old"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_full_disk_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    path = tmp_path / "old"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, call, full)
    with pytest.raises(WriteError, match=r"old: No space left on device"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["old"]


def test_an_interrupt_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    path = tmp_path / "old"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["old"]


@every_case("place", ["missing/new", "a_file/new", "a_folder", "n" * 300])
def test_a_place_that_cannot_be_written_is_named(tmp_path: Path, place: str) -> None:
    (tmp_path / "a_file").touch()
    (tmp_path / "a_folder").mkdir()
    with pytest.raises(WriteError) as caught:
        write_atomically(tmp_path / place, b"new")
    assert caught.value.path == str(tmp_path / place)
    assert names(tmp_path) == ["a_file", "a_folder"]


@every_case("place", ["missing", "a_folder", "n" * 300])
def test_what_cannot_be_read_is_named(tmp_path: Path, place: str) -> None:
    (tmp_path / "a_folder").mkdir()
    with pytest.raises(StepNcError, match=place):
        read_bytes(tmp_path / place)


@pytest.mark.parametrize("read", [read_bytes, open_lines])
def test_a_pipe_is_refused_before_it_blocks(
    read: Callable[[Path], object], tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(StepNcError, match="is a pipe, not a regular file"):
        read(tmp_path / "pipe")


def test_a_pipe_that_takes_the_place_of_a_file_does_not_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was a regular file when it was looked at."""
    monkeypatch.setattr(regular_file, "why_irregular", lambda _: "")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "device").symlink_to("/dev/zero")
    for name in ("pipe", "device"):
        with pytest.raises(OSError, match=f"is a {name}, not a regular file"):
            open_regular(tmp_path / name)
    (tmp_path / "file").write_bytes(b"content")
    with open_regular(tmp_path / "file") as file:
        assert file.read() == b"content"


def test_a_socket_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("s")
        with pytest.raises(StepNcError, match="is a socket, not a regular file"):
            read_bytes(Path("s"))


def test_a_file_that_is_larger_than_its_budget_is_refused_before_it_is_read(
    tmp_path: Path,
) -> None:
    path = tmp_path / "sparse.stp"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(StepNcError, match=f"{1 << 40} bytes; at most {1 << 31}"):
        read_bytes(path)
    path.write_bytes(b"four")
    assert read_bytes(path, most=4) == b"four"
    with pytest.raises(StepNcError, match="at most 3"):
        read_bytes(path, most=3)
