"""The typed reading of the library's files."""

from enum import StrEnum
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.toml_file import Range, Table, read_toml, read_toml_head

SPEED = Range(low=1, high=100, unit="rpm")


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


def table(**content: object) -> Table:
    return Table(content, path=Path("my.toml"), name="spindle")


@pytest.mark.parametrize(
    ("value", "complaint"),
    [
        (0, "0 rpm is below 1 rpm"),
        (-5.5, "-5.5 rpm is below 1 rpm"),
        (101, "101 rpm exceeds 100 rpm"),
        (float("nan"), "nan is no finite number; expected 1 to 100 rpm"),
        (float("inf"), "inf is no finite number; expected 1 to 100 rpm"),
        ("fast", "'fast' is no number; expected 1 to 100 rpm"),
        (True, "True is no number; expected 1 to 100 rpm"),
    ],
)
def test_a_bad_number_is_told_with_file_key_value_bound_and_unit(
    value: object, complaint: str
) -> None:
    with pytest.raises(LibraryError) as caught:
        table(max_speed_rpm=value).number("max_speed_rpm", SPEED)
    assert str(caught.value) == f"my.toml: spindle.max_speed_rpm: {complaint}"
    assert (caught.value.path, caught.value.key) == ("my.toml", "spindle.max_speed_rpm")


def test_a_missing_number_is_told_with_what_was_expected() -> None:
    with pytest.raises(LibraryError, match="missing; expected a number, 1 to 100 rpm"):
        table().number("max_speed_rpm", SPEED)


@given(st.floats(min_value=1, max_value=100))
def test_a_number_in_its_range_comes_back_unchanged(value: float) -> None:
    assert table(speed=value).number("speed", SPEED) == value


def test_a_key_that_nobody_asked_for_is_an_error() -> None:
    read = table(max_speed_rpm=10, max_sped_rpm=5)
    read.number("max_speed_rpm", SPEED)
    with pytest.raises(LibraryError, match="max_sped_rpm: unknown key; known here: max_speed"):
        read.finish()


def test_an_unknown_key_deep_below_is_an_error() -> None:
    root = Table({"curve": [{"speed": 1}, {"sped": 2}]}, path=Path("my.toml"))
    for row in root.tables("curve"):
        row.optional_number("speed", SPEED)
    with pytest.raises(LibraryError, match=r"my.toml: curve\[2\].sped: unknown key"):
        root.finish()


def test_a_window_whose_ends_are_exchanged_is_an_error() -> None:
    with pytest.raises(LibraryError, match="low: 20 rpm exceeds high 10 rpm"):
        table(low=20, high=10).window("low", "high", allowed=SPEED)


@pytest.mark.parametrize(
    ("content", "expected"),
    [({}, (None, None)), ({"low": 2}, (2, None)), ({"low": 5, "high": 5}, (5, 5))],
)
def test_an_end_of_a_window_that_is_absent_is_open(
    content: dict[str, object], expected: tuple[float | None, float | None]
) -> None:
    assert table(**content).window("low", "high", allowed=SPEED) == expected


def test_wrong_types_are_told() -> None:
    read = table(title=5, names=["a", 1], curve=3, colour="green", spindle=[])
    with pytest.raises(LibraryError, match="5 is no text"):
        read.text("title")
    with pytest.raises(LibraryError, match="is no list of texts"):
        read.texts("names")
    with pytest.raises(LibraryError, match=r"no array of tables; write \[\[spindle.curve\]\]"):
        read.tables("curve")
    with pytest.raises(LibraryError, match="'green' is none of red, blue"):
        read.choice("colour", Colour)
    with pytest.raises(LibraryError, match="is no table"):
        read.table("spindle")


def test_a_row_that_is_no_table_is_told() -> None:
    with pytest.raises(LibraryError, match="3 is no table"):
        table(curve=[3]).tables("curve")


def test_a_file_that_is_no_toml_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("title = \n", encoding="utf-8")
    with pytest.raises(LibraryError, match="is no TOML: Invalid value"):
        read_toml(path)


def test_a_file_that_is_no_text_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(LibraryError, match="is no UTF-8 text"):
        read_toml(path)


def test_a_file_that_is_absent_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="cannot be read: No such file"):
        read_toml(tmp_path / "absent.toml")


def test_the_head_is_what_stands_before_the_first_table(tmp_path: Path) -> None:
    path = tmp_path / "c45.toml"
    path.write_text(
        'equivalents = [\n    "1.0503",\n    "S45C",\n]\n\n[kienzle]\nm_c = "x"\n',
        encoding="utf-8",
    )
    head = read_toml_head(path)
    assert head.texts("equivalents") == ("1.0503", "S45C")
    assert "kienzle" not in head
