"""The typed reading of the library's files."""

from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.files.material_file import MaterialHead
from simulator.files.toml_file import (
    FileTable,
    KeyFault,
    complaint,
    converted,
    parsed,
    quantity,
    read_toml,
    read_toml_head,
    require_together,
    require_window,
    shortest,
    written,
)
from tests.every_case import every_case

Speed = Annotated[float, quantity(1, 100, "rpm")]
MINE = Path("my.toml")


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


class Row(FileTable, frozen=True, kw_only=True):
    speed: Speed
    names: tuple[str, ...] = ()


class Round(FileTable, frozen=True, kw_only=True, tag_field="shape", tag="round"):
    diameter: Speed


class Square(FileTable, frozen=True, kw_only=True, tag_field="shape", tag="square"):
    side: Speed


class Root(FileTable, frozen=True, kw_only=True):
    title: str = ""
    speed: Speed | None = None
    low: Speed | None = None
    high: Speed | None = None
    colour: Colour = Colour.RED
    is_on: bool | None = None
    curve: tuple[Row, ...] = ()
    table: Row | None = None
    part: tuple[Round | Square, ...] = ()

    def __post_init__(self) -> None:
        require_window(self, "low", "high")
        if self.title == "none":
            raise ValueError("has no title")
        if self.title == "twice":
            raise KeyFault("curve[2].speed", "is there twice")


def refused(**content: object) -> str:
    with pytest.raises(LibraryError) as caught:
        converted(content, Root, MINE)
    assert (caught.value.path, str(caught.value)[:9]) == ("my.toml", "my.toml: ")
    return str(caught.value)[9:]


@every_case(
    ("value", "message"),
    [
        (0, "0 rpm is below 1 rpm"),
        (-5.5, "-5.5 rpm is below 1 rpm"),
        (101, "101 rpm exceeds 100 rpm"),
        (float("nan"), "nan is not a finite number; expected 1 to 100 rpm"),
        (float("inf"), "inf is not a finite number; expected 1 to 100 rpm"),
        ("fast", "'fast' is not a number; expected 1 to 100 rpm"),
        (True, "True is not a number; expected 1 to 100 rpm"),
        (10**400, "…"),
    ],
)
def test_a_bad_number_is_told_with_file_key_value_bound_and_unit(
    value: object, message: str
) -> None:
    for key, text in (
        ("speed", refused(speed=value)),
        ("table.speed", refused(table={"speed": value})),
        ("curve[2].speed", refused(curve=[{"speed": 1}, {"speed": value}])),
        ("part[1].side", refused(part=[{"shape": "square", "side": value}])),
    ):
        assert text.startswith(f"{key}: ")
        assert message in text
    assert message in complaint(value, Speed)


@given(st.floats(min_value=1, max_value=100))
def test_a_number_in_its_range_comes_back_unchanged(value: float) -> None:
    assert converted({"speed": value}, Root, MINE).speed == value
    assert complaint(value, Speed) == ""


@every_case(
    ("content", "message"),
    [
        ({"table": {}}, "table.speed: missing; expected a number, 1 to 100 rpm"),
        ({"part": [{"side": 3}]}, "part[1].shape: missing; expected a text"),
        ({"part": [{"shape": "round"}]}, "part[1].diameter: missing; expected a number"),
        ({"part": [{"shape": "oval"}]}, "part[1].shape: 'oval' is not one of round, square"),
        ({"part": [{"shape": "round", "diameter": 2, "side": 3}]}, "part[1].side: unknown"),
        ({"sped": 5}, "sped: unknown key; known here: colour, curve, high, is_on, low"),
        ({"a` - at `$.b": 5}, "unknown key"),
        ({"curve": [{"speed": 1}, {"speed": 2, "sped": 2}]}, "curve[2].sped: unknown key"),
        ({"low": 20, "high": 10}, "low: 20 rpm exceeds high 10 rpm"),
        ({"title": 5}, "title: 5 is not a text"),
        ({"title": "none"}, "has no title"),
        ({"title": "twice"}, "curve[2].speed: is there twice"),
        ({"table": {"speed": 1, "names": ["a", 1]}}, "table.names[2]: 1 is not a text"),
        ({"table": {"speed": 1, "names": 1}}, "table.names: 1 is not a list of texts"),
        ({"curve": 3}, "curve: is not an array of tables; write [[curve]]"),
        ({"curve": [3]}, "curve[1]: 3 is not a table"),
        ({"part": [3]}, "part[1]: 3 is not a table"),
        ({"table": []}, "table: [] is not a table"),
        ({"colour": "green"}, "colour: 'green' is not one of red, blue"),
        ({"colour": 7}, "colour: 7 is not a text"),
        ({"is_on": "yes"}, "is_on: 'yes' is neither true nor false"),
    ],
)
def test_what_is_wrong_is_told_with_its_key(content: dict[str, Any], message: str) -> None:
    assert message in refused(**content)


@pytest.mark.parametrize("ends", [{}, {"low": 2}, {"high": 2}, {"low": 5, "high": 5}])
def test_an_end_of_a_window_that_is_absent_is_open(ends: dict[str, float]) -> None:
    root = converted(ends, Root, MINE)
    assert (root.low, root.high) == (ends.get("low"), ends.get("high"))


KEYS = st.sampled_from([*Root.__struct_fields__, *Row.__struct_fields__, "shape", "side"])
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text() | KEYS, inner),
    max_leaves=10,
)


@settings(max_examples=40)
@given(st.dictionaries(KEYS, JSON))
def test_any_content_is_read_or_refused_with_its_key(content: dict[str, Any]) -> None:
    with suppress(LibraryError):
        assert set(content) <= set(converted(content, Root, MINE).__struct_fields__)


def test_values_that_belong_together_come_together() -> None:
    class Pair(FileTable, frozen=True, kw_only=True):
        mass: Speed | None = None
        radius: Speed | None = None

        def __post_init__(self) -> None:
            require_together(self, "mass", "radius")

    for both in ({}, {"mass": 1, "radius": 2}):
        assert converted(both, Pair, MINE)
    with pytest.raises(LibraryError, match="radius: missing; expected together with mass"):
        converted({"mass": 1}, Pair, MINE)


def test_a_table_is_written_with_what_it_has() -> None:
    root = Root(
        title='a "name"',
        speed=2.5,
        is_on=False,
        curve=(Row(speed=3.0), Row(speed=4.0, names=("a", "b"))),
        table=Row(speed=5.0),
        part=(Square(side=6.0),),
    )
    text = "\n".join(written(root))
    assert converted(parsed(text, MINE), Root, MINE) == root
    assert text.splitlines()[:3] == ['title = "a \\"name\\""', "speed = 2.5", "is_on = false"]
    assert '[[part]]\nshape = "square"\nside = 6' in text


@given(st.floats(min_value=1e-3, max_value=1e6))
def test_the_shortest_number_reads_as_the_value_that_was_read(value: float) -> None:
    def read(number: float) -> float:
        return number / 60.0

    found = shortest(read(value), lambda speed: speed * 60.0, read)
    assert read(found) == read(value)
    typed = float(f"{value:.9g}")
    assert shortest(read(typed), lambda speed: speed * 60.0, read) == typed


def test_a_file_that_is_no_toml_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("title = \n", encoding="utf-8")
    with pytest.raises(LibraryError, match="is not valid TOML: Invalid value"):
        read_toml(path, Root)


def test_a_file_that_is_no_text_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(LibraryError, match="is not UTF-8 text"):
        read_toml(path, Root)


def test_a_file_that_is_absent_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="cannot be read: No such file"):
        read_toml(tmp_path / "absent.toml", Root)


def test_the_head_is_what_stands_before_the_first_table(tmp_path: Path) -> None:
    path = tmp_path / "c45.toml"
    path.write_text(
        'title = "C45"\nequivalents = [\n  "1.0503",\n  "S45C",\n]\n\n[kienzle]\nm_c = "x"\n',
        encoding="utf-8",
    )
    head = read_toml_head(path, MaterialHead)
    assert (head.title, head.equivalents) == ("C45", ("1.0503", "S45C"))
