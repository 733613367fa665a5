"""View of a result: what it says, in order, declared once for text, JSON, HTML and tables.

An item with a key is a member of the JSON object; an item with a text, a heading or columns is
shown to people. So most items are both.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from textwrap import wrap
from typing import Any, TypeVar

from service.rendering.columns import Column, bare, finding_record, record, records, visible
from service.rendering.text import finding_lines, one_line, table
from stepnc_model.errors import Finding, Severity, StepNcError

R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class TextLine:
    """Line of text for people."""

    text: str
    colour: str = ""
    """ANSI colour on terminals."""
    is_reported: bool = False
    """True if it was told while the work was done; shown where messages were not."""
    is_wrapped: bool = False
    """True for a sentence that goes on in the next line where the terminal ends."""

    def lines(self, width: int) -> Iterator[str]:
        """Yield the lines of a terminal of some width."""
        if not self.is_wrapped:
            yield self.text
            return
        yield from wrap(one_line(self.text), width=max(width, 20), subsequent_indent="   ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """Value for programs: a member of the JSON object."""

    key: str
    value: Any
    """Value, or a function without arguments that makes it where it takes time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows with their columns, and a row of totals."""

    columns: Sequence[Column[Any]]
    rows: Sequence[Any]
    key: str = ""
    """Key of the rows in JSON; empty: for people only."""
    total: Any = None
    """Row of totals, shown below the others; None without one."""
    total_key: str = "total"
    heading: str = ""
    """Line above the table."""
    nothing: str = ""
    """Text of unknown values."""
    foot: Mapping[str, str] | None = None
    row_of: Callable[[Any], object] = id
    colour: Callable[[Any], str] | None = None
    record: Callable[[Any], dict[str, Any]] | None = None
    """Function that returns the JSON object of a row; None: the columns with a key."""
    is_shown: bool = True
    """False for rows that only JSON and tables of other programs get."""
    is_in_json: bool = True
    """False where another member of the JSON object holds the rows."""

    @property
    def shown_rows(self) -> Sequence[Any]:
        """Rows with the totals."""
        return self.rows if self.total is None else [*self.rows, self.total]


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """Errors, warnings and notes."""

    findings: Sequence[Finding]
    reported: Sequence[Finding] = ()
    """Those that were told while the work was done."""
    key: str = "findings"


Item = TextLine | Fact | Table | Findings


@dataclass(frozen=True, slots=True)
class ResultView:
    """Items of a result in the order in which they are shown."""

    items: Sequence[Item] = field(default=())

    def lines(self, *, width: int, is_reported: bool = True) -> Iterator[tuple[str, str]]:
        """Yield lines of text with their ANSI colours.

        Parameters
        ----------
        width : int
            Characters per line.
        is_reported : bool
            Whether messages were shown while the work was done, and are left out.
        """
        for item in self.items:
            match item:
                case TextLine() if not (item.is_reported and is_reported):
                    yield from ((line, item.colour) for line in item.lines(width))
                case Table() if item.is_shown:
                    yield from _table_lines(item, width)
                case Findings():
                    yield from finding_lines(
                        item.findings, reported=item.reported if is_reported else ()
                    )

    def record(self) -> dict[str, Any]:
        """Return the JSON object."""
        found: dict[str, Any] = {}
        for item in self.items:
            match item:
                case Fact():
                    found[item.key] = bare(item.value() if callable(item.value) else item.value)
                case Table() if item.key and item.is_in_json:
                    found[item.key] = (
                        records(item.columns, item.rows)
                        if item.record is None
                        else [bare(item.record(row)) for row in item.rows]
                    )
                    if item.total is not None:
                        found[item.total_key] = record(item.columns, item.total)
                case Findings() if item.key:
                    found[item.key] = [finding_record(each) for each in item.findings]
        return found

    def table(self, key: str = "") -> Table:
        """Return the table of a key; without one, the first that has a key.

        Raises
        ------
        StepNcError
            When there is no such table.
        """
        keyed = {item.key: item for item in self.items if isinstance(item, Table) and item.key}
        wanted = key or next(iter(keyed), "")
        if wanted not in keyed:
            raise StepNcError(f"no table '{wanted}'; there are: {', '.join(keyed) or 'none'}")
        return keyed[wanted]

    def html(self) -> str:
        """Return a fragment of HTML for notebooks."""
        parts: list[str] = []
        for item in self.items:
            match item:
                case TextLine():
                    parts.append(f"<p>{escape(item.text)}</p>")
                case Table() if item.is_shown and item.rows:
                    parts.append(_html_table(item))
                case Findings() if item.findings:
                    parts.append(_html_findings(item.findings))
        return "\n".join(parts)


def _html_findings(findings: Sequence[Finding]) -> str:
    """Return findings folded under their numbers; open where one is an error."""
    counts = Counter(each.severity for each in findings)
    summary = ", ".join(f"{severity}: {counts[severity]}" for severity in counts)
    is_open = " open" if Severity.ERROR in counts else ""
    texts = "".join(
        f"<p><small>{escape(text)}</small></p>" for text, _ in finding_lines(findings)
    )
    return f"<details{is_open}><summary>{summary}</summary>{texts}</details>"


def _table_lines(item: Table, width: int) -> Iterator[tuple[str, str]]:
    if item.heading and item.rows:
        yield item.heading, ""
    if item.heading and not item.rows:
        return
    lines = table(
        item.columns, item.shown_rows, width=width, nothing=item.nothing, foot=item.foot,
        row_of=item.row_of, colour=item.colour,
    )  # fmt: skip
    yield from lines


def _html_table(item: Table) -> str:
    rows = item.shown_rows
    columns = visible(item.columns, rows)
    head = "".join(f"<th>{escape(each.heading)}</th>" for each in columns)
    body = "\n".join(
        "<tr>"
        + "".join(f"<td>{escape(each.text(row, arrow='→'))}</td>" for each in columns)
        + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table>"
