"""Tables as text: shared cells, groups, blocks, colours."""

import pytest

from service.rendering.columns import Column
from service.rendering.text import GREEN, RED, one_line, print_line, table

ENDLESS = 10**9

COLUMNS: tuple[Column[tuple[str, float]], ...] = (
    Column(heading="name", value=lambda row: row[0], is_key=True, is_of_row=True),
    Column(heading="force N", group="Cut", form=".1f", value=lambda row: row[1], is_right=True),
    Column(heading="twice", group="Cut", form=".1f", value=lambda row: 2.0 * row[1]),
    Column(heading="none", value=lambda _: None),
)
ROWS = (("a", 1.0), ("a", 20.0), ("b", 3.0))


def test_lines_of_one_row_share_cells() -> None:
    found = table(COLUMNS, ROWS, width=ENDLESS, nothing="–", row_of=lambda row: row[0])
    assert [text for text, _ in found] == [
        "      Cut",
        "name  force N  twice  none",
        "----  -------  -----  ----",
        "a         1.0  2.0    –",
        "         20.0  40.0   –",
        "b         3.0  6.0    –",
    ]


def test_each_row_stands_for_itself_where_nothing_else_is_said() -> None:
    assert [line[0] for line, _ in list(table(COLUMNS, ROWS, width=ENDLESS))[3:]] == [
        "a",
        "a",
        "b",
    ]


def test_blocks_begin_with_the_key_and_keep_groups_together() -> None:
    heads = [line for line, _ in table(COLUMNS, ROWS, width=22) if line.startswith("name")]
    assert heads == ["name  force N  twice", "name  none"]


def test_lines_are_coloured_where_that_is_asked_for() -> None:
    lines = list(
        table(COLUMNS, ROWS, width=ENDLESS, colour=lambda row: RED if row[1] > 10.0 else "")
    )
    assert [colour for _, colour in lines] == ["", "", "", "", RED, ""]


def test_a_name_cannot_steer_the_terminal() -> None:
    found = table(COLUMNS, [("a\x1b[2J\nb", 1.0)], width=ENDLESS)
    assert any("a�[2J b" in line for line, _ in found)
    assert one_line(" a\n b ") == "a b"
    assert one_line(" \n ") == "–"


def test_a_line_is_coloured_on_a_terminal_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    print_line("plain", GREEN)
    monkeypatch.setattr("service.rendering.text.wants_colours", lambda: True)
    print_line("green", GREEN)
    assert capsys.readouterr().out == "plain\n\x1b[32mgreen\x1b[0m\n"
