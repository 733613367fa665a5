"""One declaration of a result gives text, JSON, tables and HTML."""

from dataclasses import dataclass

import pytest

from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from stepnc_model.errors import Finding, Severity, StepNcError


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    name: str
    time: float


COLUMNS: tuple[Column[Part], ...] = (
    Column(key="name", heading="part", value=lambda row: row.name),
    Column(key="time_s", heading="time s", form=".1f", value=lambda row: row.time),
)
TOLD = Finding(severity=Severity.WARNING, message="told before")
VIEW = ResultView([
    TextLine(text="two parts <1>", colour="31"),
    Fact(key="count", value=2),
    Table(
        key="parts", columns=COLUMNS, rows=[Part(name="a", time=1.0), Part(name="b", time=2.0)],
        total=Part(name="total", time=3.0),
    ),
    Table(key="none", columns=COLUMNS, rows=[], heading="nothing of this:"),
    Findings(
        findings=[TOLD, Finding(severity=Severity.NOTE, message="a note")], reported=[TOLD]
    ),
])  # fmt: skip


def test_text_has_totals_and_leaves_out_what_was_told() -> None:
    lines = list(VIEW.lines(width=80))
    assert lines[0] == ("two parts <1>", "31")
    assert [text for text, _ in lines[1:]] == [
        "part   time s", "-----  ------", "a      1.0", "b      2.0", "total  3.0",
        "note: a note",
    ]  # fmt: skip
    assert "warning: told before" in dict(VIEW.lines(width=80, is_reported=False))


def test_a_sentence_goes_on_in_the_next_line() -> None:
    view = ResultView([TextLine(text="one two  three four five six", is_wrapped=True)])
    assert [text for text, _ in view.lines(width=20)] == ["one two three four", "   five six"]


def test_a_row_has_its_colour() -> None:
    rows = [Part(name="a", time=1.0), Part(name="b", time=2.0)]
    table = Table(columns=COLUMNS, rows=rows, colour=lambda row: "31" if row.time > 1 else "")
    lines = list(ResultView([table]).lines(width=80))
    assert [colour for _, colour in lines] == ["", "", "", "31"]


def test_json_has_every_member_with_a_key() -> None:
    record = VIEW.record()
    assert list(record) == ["count", "parts", "total", "none", "findings"]
    assert record["parts"][1] == {"name": "b", "time_s": 2.0}
    assert record["total"] == {"name": "total", "time_s": 3.0}
    assert [each["message"] for each in record["findings"]] == ["told before", "a note"]


def test_html_is_escaped() -> None:
    html = VIEW.html()
    assert "two parts &lt;1&gt;" in html
    assert "<td>2.0</td>" in html
    assert "<details><summary>warning: 1, note: 1</summary>" in html


def test_a_table_is_found_by_its_key() -> None:
    assert VIEW.table() is VIEW.table("parts")
    with pytest.raises(StepNcError, match="no table 'x'; there are: parts, none"):
        VIEW.table("x")
