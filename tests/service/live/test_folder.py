"""The files of a run: readers see a whole status, the old one or the new one."""

from pathlib import Path

import pytest

from service.errors import StorageFull
from service.live.journal import LiveFolder


def test_every_file_lies_in_the_folder(tmp_path: Path) -> None:
    folder = LiveFolder(path=tmp_path)
    files = {folder.series, folder.events, folder.orders, folder.status}
    assert len(files) == 4
    assert {file.parent for file in files} == {tmp_path}


def test_nothing_was_said_yet(tmp_path: Path) -> None:
    assert LiveFolder(path=tmp_path).read_status() is None
    assert LiveFolder(path=tmp_path / "not there").read_status() is None


def test_a_status_is_read_as_it_was_written(tmp_path: Path) -> None:
    folder = LiveFolder(path=tmp_path)
    for status in ({"a": 1.5, "ü": None}, {}):
        folder.write_status(status)
        assert folder.read_status() == status
    assert {each.name for each in tmp_path.iterdir()} == {"status.json"}


def test_who_has_the_old_status_open_reads_it_to_its_end(tmp_path: Path) -> None:
    folder = LiveFolder(path=tmp_path)
    folder.write_status({"number": 1})
    with folder.status.open(encoding="utf-8") as opened:
        folder.write_status({"number": 2, "longer": "x" * 1000})
        assert opened.read() == '{"number": 1}'


def test_a_status_for_which_there_is_no_room_is_refused_and_the_old_one_stays(
    tmp_path: Path,
) -> None:
    folder = LiveFolder(path=tmp_path)
    folder.write_status({"number": 1})
    (tmp_path / ".status.json").symlink_to("/dev/full")
    with pytest.raises(StorageFull, match=r"^status\.json: "):
        folder.write_status({"number": 2})
    assert folder.read_status() == {"number": 1}


def test_a_status_of_an_earlier_version_is_read(tmp_path: Path) -> None:
    """As version 0.1 left it when a run had ended."""
    text = '{"time": 12.5, "level": "over", "is_over": true, "is_stopped": false}'
    (tmp_path / "status.json").write_text(text, encoding="utf-8")
    found = LiveFolder(path=tmp_path).read_status()
    assert found == {"time": 12.5, "level": "over", "is_overloaded": True, "is_stopped": False}
