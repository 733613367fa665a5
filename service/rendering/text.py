"""Tables and findings as text; on a terminal, as wide as it is.

Where the screen is too narrow, columns go below each other in blocks, each with the columns
that tell what a line is about; a group of columns stays together where it can.
"""

import os
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from service.rendering.columns import Column, R, visible
from service.terminal import clean
from stepnc_model.errors import Finding, Severity

GAP = "  "

RED, GREEN, YELLOW, CYAN = "31", "32", "33", "36"
"""ANSI colours"""

COLOURS = {Severity.ERROR: RED, Severity.WARNING: YELLOW, Severity.NOTE: CYAN}
"""of findings"""

MOST_FINDINGS = 40
"""findings shown in a table; --json has all"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TextColumn:
    """A column with its cells as they are shown."""

    column: Column[Any]
    cells: tuple[str, ...]
    width: int

    def with_foot(self, cell: str) -> "TextColumn":
        """The column with one more cell at its end."""
        return replace(self, cells=(*self.cells, cell), width=max(self.width, len(cell)))

    def place(self, text: str) -> str:
        """A cell, as wide as the column."""
        return text.rjust(self.width) if self.column.is_right else text.ljust(self.width)


def table(  # noqa: PLR0913 (each is a choice of the caller)
    columns: Sequence[Column[R]],
    rows: Sequence[R],
    *,
    width: int,
    nothing: str = "",
    row_of: Callable[[R], object] = id,
    colour: Callable[[R], str] | None = None,
    foot: Mapping[str, str] | None = None,
) -> Iterator[str]:
    """Lines of a table: header, rule, rows; blocks of columns where it is too wide.

    Parameters
    ----------
    columns : sequence of Column
    rows : sequence
    width : int
        Letters in a line.
    nothing : str
        For what is not known.
    row_of : callable
        The same for lines that belong to one row and share cells.
    colour : callable, optional
        ANSI colour of a line.
    foot : mapping, optional
        Cells of a last line, by the headings of their columns.
    """
    names = [row_of(row) for row in rows]
    is_first = [name != before for before, name in zip([None, *names], names, strict=False)]
    colours = [colour(row) if colour else "" for row in rows]
    laid = [_laid(column, rows, is_first, nothing) for column in visible(columns, rows)]
    if foot is not None:
        laid = [each.with_foot(foot.get(each.column.heading, "")) for each in laid]
        colours.append("")
    for index, block in enumerate(blocks(laid, width=width)):
        if index:
            yield ""
        yield from _block(block, colours)


def print_table(
    columns: Sequence[Column[R]],
    rows: Sequence[R],
    *,
    nothing: str = "",
    foot: Mapping[str, str] | None = None,
) -> None:
    """A table, to stdout."""
    for line in table(columns, rows, width=screen_width(), nothing=nothing, foot=foot):
        print_line(line)


def print_line(text: str, colour: str = "") -> None:
    """One line of data, to stdout; in a colour on a terminal that wants colours."""
    sys.stdout.write(coloured(clean(text), colour if wants_colours() else "") + "\n")


def print_findings(findings: Sequence[Finding]) -> None:
    """Findings, errors first, equal ones once."""
    order = list(Severity)[::-1]
    ranked = sorted(findings, key=lambda finding: order.index(finding.severity))
    unique = {str(finding): COLOURS[finding.severity] for finding in ranked}
    for text, colour in list(unique.items())[:MOST_FINDINGS]:
        print_line(text, colour)
    if len(unique) > MOST_FINDINGS:
        print_line(f"... and {len(unique) - MOST_FINDINGS} more findings (--json has all)")


def one_line(text: str) -> str:
    """A name as one line that cannot steer a terminal; a dash where it is empty."""
    return clean(" ".join(text.split())) or "–"


def coloured(text: str, colour: str) -> str:
    """The text in an ANSI colour; as it is without one."""
    return f"\x1b[{colour}m{text}\x1b[0m" if colour else text


def screen_width() -> int:
    """Letters in a line of the terminal; a pipe has no end."""
    if not sys.stdout.isatty() and "COLUMNS" not in os.environ:
        return sys.maxsize
    return shutil.get_terminal_size().columns


def wants_colours() -> bool:
    """Whether stdout is a terminal and colours are not refused."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def blocks(laid: Sequence[TextColumn], *, width: int) -> Iterator[tuple[TextColumn, ...]]:
    """Columns that have place beside each other, each time with those that are the key."""
    keys = tuple(each for each in laid if each.column.is_key) or tuple(laid[:1])
    rest = [each for each in laid if each not in keys]
    block = keys
    for name, members in groupby(rest, key=lambda each: each.column.group):
        group = tuple(members)
        # A group stays together, unless it has no place of its own.
        whole = bool(name) and _width(keys + group) <= width
        for part in (group,) if whole else [(each,) for each in group]:
            if block != keys and _width(block + part) > width:
                yield block
                block = keys
            block += part
    if block != keys or not rest:
        yield block


def _laid(
    column: Column[R], rows: Sequence[R], is_first: Sequence[bool], nothing: str
) -> TextColumn:
    """Column with its cells; what all lines of a row share is shown in its first."""
    cells = tuple(
        clean(column.text(row, nothing=nothing).replace("\n", " "))
        if first or not column.is_of_row
        else ""
        for row, first in zip(rows, is_first, strict=True)
    )
    return TextColumn(
        column=column, cells=cells, width=max(map(len, (column.heading, *cells)), default=0)
    )


def _width(laid: Sequence[TextColumn]) -> int:
    return sum(each.width for each in _widened(laid)) + len(GAP) * (len(laid) - 1)


def _widened(laid: Sequence[TextColumn]) -> list[TextColumn]:
    """Columns that together have place for the name of their group."""
    wide = []
    for name, members in groupby(laid, key=lambda each: each.column.group):
        group = list(members)
        lacking = len(name) - sum(each.width for each in group) - len(GAP) * (len(group) - 1)
        last = group.pop()
        wide += [*group, replace(last, width=last.width + max(0, lacking))]
    return wide


def _block(laid: Sequence[TextColumn], colours: Sequence[str]) -> Iterator[str]:
    """Header, of two levels where columns have groups, rule, lines."""
    laid = _widened(laid)
    if any(each.column.group for each in laid):
        names = (
            (name, list(members))
            for name, members in groupby(laid, key=lambda each: each.column.group)
        )
        yield GAP.join(
            name.ljust(sum(each.width for each in group) + len(GAP) * (len(group) - 1))
            for name, group in names
        ).rstrip()
    yield GAP.join(each.place(each.column.heading) for each in laid).rstrip()
    yield GAP.join("-" * each.width for each in laid)
    for row, colour in enumerate(colours):
        line = GAP.join(each.place(each.cells[row]) for each in laid).rstrip()
        yield coloured(line, colour)
