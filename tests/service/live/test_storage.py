"""A disk that is full, or takes so many bytes of a file only: nothing is told as written."""

import errno
from pathlib import Path

import pytest

from service.errors import StorageFull, Unavailable
from service.live.journal import FULL, storing, write_whole
from tests.service.live.room import within_room


@pytest.mark.parametrize("code", sorted(FULL))
def test_a_disk_without_room_is_told_as_such(code: int) -> None:
    with pytest.raises(StorageFull, match=r"^status\.json: "), storing("status.json"):
        raise OSError(code, "no room")


def test_a_file_that_cannot_be_written_for_another_reason_is_told_by_its_name(
    tmp_path: Path,
) -> None:
    with pytest.raises(Unavailable, match=r"^a: No such file") as told, storing("a"):
        (tmp_path / "gone" / "a").open("wb")
    assert str(tmp_path) not in str(told.value)


def test_bytes_that_were_taken_in_part_are_no_success(tmp_path: Path) -> None:
    told = within_room(
        """
import os
from service.live.journal import write_whole
descriptor = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT)
try:
    write_whole(descriptor, b"x" * 1500)
except OSError as error:
    print(error.errno, os.fstat(descriptor).st_size)
""",
        tmp_path / "file",
        room=1000,
    )
    assert told == f"{errno.EFBIG} 1000\n"


def test_all_bytes_are_written(tmp_path: Path) -> None:
    with (tmp_path / "file").open("wb") as file:
        write_whole(file.fileno(), b"abc")
        write_whole(file.fileno(), b"")
    assert (tmp_path / "file").read_bytes() == b"abc"
