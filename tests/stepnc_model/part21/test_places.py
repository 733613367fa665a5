"""Lines and columns."""

import pytest

from stepnc_model.part21.places import Lines, error_at, excerpt, line_break


@pytest.mark.parametrize("newline", [b"\n", b"\r\n", b"\r"])
def test_lines_are_counted_whatever_ends_them(newline: bytes) -> None:
    data = newline.join(b"line %d" % number for number in range(1, 5001))
    lines = Lines(data)
    assert line_break(data) == newline
    for number in (1, 2, 2500, 5000):
        assert lines.line(data.index(b"line %d" % number)) == number
    assert lines.line(len(data)) == 5000


def test_file_of_one_line_gets_line_feeds() -> None:
    assert line_break(b"one") == b"\n"


def test_error_names_line_and_column_from_one() -> None:
    error = error_at(b"ab\r\ncd", 5, "wrong")
    assert (error.line, error.column) == (2, 2)
    assert str(error) == "line 2, column 2: wrong"


def test_excerpt_is_one_short_line() -> None:
    assert excerpt(b"a\n \x00b", 0, 5) == "'a b'"
    assert excerpt(b"x" * 100, 0, 100) == "'" + "x" * 40 + "…'"
