"""The evaluation table as a page: whole, self-contained, and no name of it is believed."""

import re
from dataclasses import replace
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path

import pytest

from service.knowledge.evaluation_columns import lines, screen_columns
from service.knowledge.evaluation_table import EvaluationTable, table
from service.rendering.columns import visible
from service.requests.knowledge import EvaluationRequest
from service.verbs.kbe.table.result import EvaluationResult

EVIL = "<script>alert('a & b')</script>"


@pytest.fixture(scope="module")
def found(shop_file: Path) -> EvaluationTable:
    return table(str(shop_file), EvaluationRequest())


def evaluation_page(found: EvaluationTable) -> str:
    """The page of a table."""
    return EvaluationResult(evaluation=found).page()


class Reader(HTMLParser):
    """Columns that the cells of each line of the table take."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.open: list[str] = []
        self.heads: list[int] = []
        self.cells: list[int] = []
        self.spans: list[int] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in {"meta"}:
            self.open.append(tag)
        of = dict(attrs)
        if tag == "tr" and "tbody" in self.open:
            self.cells.append(sum(span > 0 for span in self.spans))
            self.spans = [span - 1 for span in self.spans if span > 1]
        elif tag == "tr":
            self.heads.append(0)
        elif tag == "th":
            self.heads[-1] += int(of.get("colspan") or 1)
        elif tag == "td":
            self.cells[-1] += 1
            if "rowspan" in of:
                self.spans.append(int(of["rowspan"] or 1) - 1)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_every_line_has_every_column(found: EvaluationTable) -> None:
    reader = Reader()
    reader.feed(evaluation_page(found))
    width = len(visible(screen_columns(found.rows), tuple(lines(found.rows))))
    assert reader.heads == [width, width]
    assert reader.cells == [width] * len(list(lines(found.rows)))
    assert reader.open == []


def test_nothing_runs_and_nothing_is_fetched(found: EvaluationTable) -> None:
    page = evaluation_page(found)
    reader = Reader()
    reader.feed(page)
    assert not {"script", "link", "img", "iframe"} & set(reader.tags)
    assert "http" not in page
    assert "url(" not in page


def test_hostile_names_are_only_names(found: EvaluationTable) -> None:
    first = found.rows[0]
    assert first.roughing is not None
    key = replace(first.key, machine=EVIL, feature=EVIL, material=EVIL, program=EVIL)
    context = replace(first.roughing.context, tool=EVIL)
    side = replace(first.roughing, context=context, strategies=(EVIL,))
    rows = (replace(first, key=key, roughing=side), found.rows[1])
    at = datetime(2026, 3, 5, tzinfo=UTC)
    request = EvaluationRequest(machine=EVIL, since=at, until=at)
    page = evaluation_page(replace(found, rows=rows, place=EVIL, request=request))
    assert "<script" not in page
    assert page.count("&lt;script&gt;alert(&#39;a &amp; b&#39;)") >= 7


def test_remarks_lead_to_their_rows(found: EvaluationTable) -> None:
    page = evaluation_page(found)
    wanted = set(re.findall(r'href="#(row\d+)"', page))
    assert wanted
    assert wanted <= set(re.findall(r'id="(row\d+)"', page))


def test_an_empty_table_is_a_page(found: EvaluationTable) -> None:
    reader = Reader()
    reader.feed(evaluation_page(replace(found, rows=(), outcomes=0)))
    assert reader.cells == []
    assert reader.open == []
