"""Values of columns as people read them."""

from datetime import UTC, datetime
from math import inf, nan

from service.rendering.columns import Cell, Change, Column, clock, grouped, shown, visible
from tests.every_case import every_case


@every_case(
    ("value", "form", "text"),
    [
        (None, "", "–"),
        (nan, ".1f", "–"),
        (inf, ".1f", "–"),
        ("", "", "–"),
        ([], "", "–"),
        (True, "", "yes"),
        (12345.6, ".3g", "12346"),
        (999.9, ".3g", "1000"),
        (0.3333, ".3g", "0.333"),
        (["a", "b"], "", "a, b"),
        (Change(before=1.0, after=2.0), ".1f", "1.0 -> 2.0"),
        (Change(before=1.0, after=1.01), ".1f", "1.0"),
        (Change(before=None, after=2.0), ".1f", "2.0"),
        (Change(before=None, after=None), ".1f", "–"),
    ],
)
def test_a_value_is_shown(value: Cell, form: str, text: str) -> None:
    assert shown(value, form, nothing="–") == text


def test_a_time_is_that_of_this_computer() -> None:
    at = datetime(2026, 3, 5, 12, 0, tzinfo=UTC)
    assert shown(at) == f"{at.astimezone():%Y-%m-%d %H:%M}"


def test_columns_are_grouped_in_their_order() -> None:
    columns = [
        Column(heading=name, group=group, value=str)
        for name, group in (("a", ""), ("b", "g"), ("c", "g"), ("d", ""))
    ]
    found = [(name, [each.heading for each in members]) for name, members in grouped(columns)]
    assert found == [("", ["a"]), ("g", ["b", "c"]), ("", ["d"])]


def test_an_optional_column_without_values_is_left_out() -> None:
    columns: list[Column[str]] = [
        Column(heading="all", value=lambda row: row),
        Column(heading="none", value=lambda _: None, is_optional=True),
        Column(key="file_only", value=lambda row: row),
    ]
    assert [each.heading for each in visible(columns, ["x"])] == ["all"]


@every_case(
    ("seconds", "text"),
    [(12.34, "12.3 s"), (125.0, "2 min 05 s"), (7384.0, "2 h 03 min")],
)
def test_a_time_is_told_as_people_say_it(seconds: float, text: str) -> None:
    assert clock(seconds) == text
