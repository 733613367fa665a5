"""The evaluation table as text: two levels of header, blocks on narrow screens."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.remarks import EvaluationGrade
from service.knowledge.evaluation_columns import COLUMNS
from service.knowledge.evaluation_columns import lines as lines_of
from service.knowledge.evaluation_table import EvaluationTable, table
from service.rendering.text import RED, TextColumn, blocks, one_line, screen_width
from service.requests.knowledge import EvaluationRequest
from service.verbs.kbe.table.result import EvaluationResult

ENDLESS = 10**9


@pytest.fixture(scope="module")
def found(shop_file: Path) -> EvaluationTable:
    return table(str(shop_file), EvaluationRequest())


def lines(found: EvaluationTable, width: int) -> list[tuple[str, str]]:
    """Lines of a table with their colours, as in a file."""
    view = EvaluationResult(evaluation=found).view()
    return list(view.lines(width=width, is_reported=False))


def table_text(found: EvaluationTable, *, width: int) -> str:
    """A table as text."""
    return "\n".join(text for text, _ in lines(found, width))


def test_the_header_has_two_levels_as_in_the_paper(found: EvaluationTable) -> None:
    groups, labels, rule, *_ = table_text(found, width=ENDLESS).splitlines()
    for name in ("Geometrical data", "Workpiece material", "Cutting tool", "Cutting"):
        assert name in groups
    for name in ("Machine_ID", "Feature_ID", "L/X mm", "a_t mm", "predicted", "evaluated"):
        assert name in labels
    # The name of a group stands above its first column.
    assert labels[groups.index("Roughing f_z") :].startswith("predicted")
    assert labels[groups.index("Cutting tool") :].startswith("ID")
    assert set(rule) == {"-", " "}
    assert len(rule) >= len(labels) >= len(groups)


@pytest.mark.parametrize("width", [60, 80, 120, 160, 250])
def test_no_line_of_a_table_is_longer_than_the_screen(
    width: int, found: EvaluationTable
) -> None:
    text = table_text(found, width=width)
    assert max(map(len, text.splitlines())) <= width


@given(st.integers(1, 300))
def test_blocks_have_every_column_once_and_the_key_each_time(width: int) -> None:
    laid = [TextColumn(column=each, cells=("12345678",), width=8) for each in COLUMNS]
    keys = [each for each in laid if each.column.is_key]
    found = list(blocks(laid, width=width))
    assert all(list(block[: len(keys)]) == keys for block in found)
    rest = [each for block in found for each in block[len(keys) :]]
    assert rest == [each for each in laid if not each.column.is_key]


def test_what_is_the_same_in_a_row_is_told_once(found: EvaluationTable) -> None:
    both = next(row for row in found.rows if row.roughing and row.finishing)
    text = table_text(replace(found, rows=(both,)), width=ENDLESS)
    rough, fine = text.splitlines()[3:5]
    assert rough.split()[1] == both.key.machine
    assert both.key.machine not in fine
    assert fine.split()[0] == "finish"


def test_lines_are_coloured_by_their_grade(found: EvaluationTable) -> None:
    count = sum(grade is EvaluationGrade.VIOLATED for grade in grades(found))
    red = [text for text, colour in lines(found, ENDLESS) if colour == RED]
    assert len(red) == count > 0
    assert all("violated" in text for text in red)


def grades(found: EvaluationTable) -> list[EvaluationGrade]:
    """Grade of each line of a table."""
    return [line.side.grade for line in lines_of(found.rows)]


def test_a_name_cannot_steer_the_terminal(found: EvaluationTable) -> None:
    evil = replace(found.rows[0].key, machine="a\x1b[2J\nb")
    rows = (replace(found.rows[0], key=evil),)
    text = table_text(replace(found, rows=rows), width=ENDLESS)
    assert "a�[2J b" in text
    assert one_line(" \n ") == "–"


def test_a_table_without_rows_says_so(found: EvaluationTable) -> None:
    text = table_text(replace(found, rows=(), left_out=24), width=ENDLESS)
    assert "outcomes 1200, rows 0 and 24 not shown, violated 0" in text
    assert "Machine_ID" not in text


def test_a_pipe_has_no_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert screen_width() > ENDLESS
    monkeypatch.setenv("COLUMNS", "100")
    assert screen_width() == 100
