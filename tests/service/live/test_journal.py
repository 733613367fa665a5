"""Lines that grow while they are read: whole ones only, each once, whatever was cut off."""

import sys
from pathlib import Path
from subprocess import Popen

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import Unavailable
from service.live.journal import LONGEST, append, read_on
from tests.every_case import every_case
from tests.service.live.room import within_room
from tests.service.waiting import ended

Entries = st.lists(
    st.dictionaries(st.text(max_size=5), st.one_of(st.text(max_size=9), st.integers())),
    max_size=8,
)


def test_a_file_that_is_not_there_has_no_lines(tmp_path: Path) -> None:
    read = read_on(tmp_path / "none", 7)
    assert (read.lines, read.offset) == ((), 7)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(Entries, Entries)
def test_what_was_appended_is_read_on_where_it_ended(
    tmp_path: Path, first: list[dict[str, object]], second: list[dict[str, object]]
) -> None:
    file = tmp_path / "journal"
    file.unlink(missing_ok=True)
    for entry in first:
        append(file, entry)
    read = read_on(file, 0)
    assert list(read.lines) == first
    for entry in second:
        append(file, entry)
    rest = read_on(file, read.offset)
    assert list(rest.lines) == second
    assert read_on(file, rest.offset).lines == ()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 60))
def test_a_line_that_is_being_written_is_not_there_yet(tmp_path: Path, cut: int) -> None:
    file = tmp_path / "journal"
    whole = b'{"a": 1}\n{"b": "\xc3\xa4"}\n'
    file.write_bytes(whole[:cut])
    read = read_on(file, 0)
    file.write_bytes(whole)
    rest = read_on(file, read.offset)
    assert [*read.lines, *rest.lines] == [{"a": 1}, {"b": "ä"}]


def test_a_line_that_was_cut_off_does_not_take_the_later_ones_with_it(tmp_path: Path) -> None:
    file = tmp_path / "journal"
    append(file, {"a": 1})
    with file.open("ab") as opened:
        opened.write(b'{"b": "half of i')
    assert read_on(file, 0).lines == ({"a": 1},)
    append(file, {"c": 3})
    append(file, {"d": 4})
    read = read_on(file, 0)
    assert read.lines == ({"a": 1}, {"c": 3}, {"d": 4})
    assert read.offset == file.stat().st_size


ON_FULL_DISK = """
from pathlib import Path
from service.errors import StorageFull
from service.live.journal import append
for number in range(5):
    try:
        append(Path(sys.argv[1]), {"number": number, "more": "x" * 300})
    except StorageFull as error:
        print(error)
append(Path(sys.argv[1]), {"small": 1})
"""


def test_a_line_for_which_there_is_no_room_is_refused_and_leaves_nothing(
    tmp_path: Path,
) -> None:
    file = tmp_path / "orders.jsonl"
    told = within_room(ON_FULL_DISK, file, room=1100)
    assert told.splitlines() == ["orders.jsonl: File too large"] * 2
    read = read_on(file, 0)
    assert [line.get("number") for line in read.lines] == [0, 1, 2, None]
    assert read.offset == file.stat().st_size


def test_a_journal_whose_folder_is_gone_is_told(tmp_path: Path) -> None:
    with pytest.raises(Unavailable, match=r"^journal: No such file"):
        append(tmp_path / "gone" / "journal", {"a": 1})


@every_case("line", [b"[1]", b"1", b"null", b"\xff\xfe", b"", b"{" * 2000, b'"x"'])
def test_a_line_that_is_no_entry_is_passed_over(tmp_path: Path, line: bytes) -> None:
    file = tmp_path / "journal"
    file.write_bytes(line + b'\n{"a": 1}\n')
    assert read_on(file, 0).lines == ({"a": 1},)


def test_numbers_that_are_none_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        append(tmp_path / "journal", {"a": float("nan")})
    assert not (tmp_path / "journal").exists()


def test_a_long_journal_is_read_in_pieces(tmp_path: Path) -> None:
    file = tmp_path / "journal"
    file.write_bytes((b'{"a": "' + b"x" * 1000 + b'"}\n') * 3000)
    lines, offset = 0, 0
    while (read := read_on(file, offset)).lines:
        assert read.offset - offset <= LONGEST
        lines, offset = lines + len(read.lines), read.offset
    assert (lines, offset) == (3000, file.stat().st_size)


APPENDER = """
import sys
from pathlib import Path
from service.live.journal import append
for number in range(200):
    append(Path(sys.argv[1]), {"of": sys.argv[2], "number": number, "more": "x" * 500})
"""


def test_lines_of_several_processes_are_never_mixed(tmp_path: Path) -> None:
    file = tmp_path / "journal"
    words = [sys.executable, "-c", APPENDER, str(file)]
    writers = [Popen([*words, name]) for name in "abc"]
    assert [ended(writer) for writer in writers] == [0, 0, 0]
    lines = read_on(file, 0).lines
    for name in "abc":
        assert [line["number"] for line in lines if line["of"] == name] == list(range(200))
