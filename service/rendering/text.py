"""Tables and findings as text, as wide as the terminal.

On a narrow screen, columns are arranged in blocks below each other, each block with the columns
that identify a line; a group of columns stays together where possible.
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
from stepnc_model.plurals import counted

GAP = "  "

RED, GREEN, YELLOW, CYAN = "31", "32", "33", "36"
"""ANSI colour codes."""

COLOURS = {Severity.ERROR: RED, Severity.WARNING: YELLOW, Severity.NOTE: CYAN}
"""Colours of findings by severity."""

MOST_FINDINGS = 40
"""Most findings that a text table shows; --json has all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TextColumn:
    """Column with the texts of its cells."""

    column: Column[Any]
    cells: tuple[str, ...]
    width: int

    def with_foot(self, cell: str) -> "TextColumn":
        """Return the column with one more cell at its end."""
        return replace(self, cells=(*self.cells, cell), width=max(self.width, len(cell)))

    def place(self, text: str) -> str:
        """Return a cell text padded to the width of the column."""
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
) -> Iterator[tuple[str, str]]:
    """Yield the lines of a table with their ANSI colours: header, rule, rows.

    A table that is too wide is yielded in blocks.

    Parameters
    ----------
    rows : sequence
    width : int
        Characters per line.
    nothing : str
        Text for unknown values.
    row_of : callable
        Function with an equal result for lines that belong to one row and share cells.
    colour : callable, optional
        Function that returns the ANSI colour of a line.
    foot : mapping, optional
        Cells of an additional last line, by column heading.
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
            yield "", ""
        yield from _block(block, colours)


def print_line(text: str, colour: str = "") -> None:
    """Print a line of data to stdout; coloured only on a terminal that allows colours."""
    shown = clean(text)
    if colour and wants_colours():
        shown = f"\x1b[{colour}m{shown}\x1b[0m"
    sys.stdout.write(f"{shown}\n")


def finding_lines(
    findings: Sequence[Finding], *, reported: Sequence[Finding] = ()
) -> Iterator[tuple[str, str]]:
    """Yield findings with their colours: without duplicates and what was told, errors first."""
    said = {str(finding) for finding in reported}
    order = list(Severity)[::-1]
    ranked = sorted(findings, key=lambda finding: order.index(finding.severity))
    unique = {str(finding): COLOURS[finding.severity] for finding in ranked}
    unique = {text: colour for text, colour in unique.items() if text not in said}
    yield from list(unique.items())[:MOST_FINDINGS]
    if len(unique) > MOST_FINDINGS:
        yield (
            f"... and {counted(len(unique) - MOST_FINDINGS, 'more finding')} (--json has all)",
            "",
        )


def one_line(text: str) -> str:
    """Return a name on one line without control characters; a dash where it is empty."""
    return clean(" ".join(text.split())) or "–"


def screen_width() -> int:
    """Characters per line of the terminal; unlimited for a pipe."""
    if not sys.stdout.isatty() and "COLUMNS" not in os.environ:
        return sys.maxsize
    return shutil.get_terminal_size().columns


def wants_colours() -> bool:
    """True if stdout is a terminal and colours are not disabled."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def blocks(laid: Sequence[TextColumn], *, width: int) -> Iterator[tuple[TextColumn, ...]]:
    """Yield blocks of columns that fit side by side, each with the key columns."""
    keys = tuple(each for each in laid if each.column.is_key) or tuple(laid[:1])
    rest = [each for each in laid if each not in keys]
    block = keys
    for name, members in groupby(rest, key=lambda each: each.column.group):
        group = tuple(members)
        # A group stays together unless it is wider than the screen.
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
    """Return a column with its cells; a cell shared by the lines of a row is shown once."""
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
    """Widen the last column of each group so that the name of the group fits."""
    wide = []
    for name, members in groupby(laid, key=lambda each: each.column.group):
        group = list(members)
        lacking = len(name) - sum(each.width for each in group) - len(GAP) * (len(group) - 1)
        last = group.pop()
        wide += [*group, replace(last, width=last.width + max(0, lacking))]
    return wide


def _block(laid: Sequence[TextColumn], colours: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield a block: header (of two levels if columns are grouped), rule, lines."""
    laid = _widened(laid)
    if any(each.column.group for each in laid):
        names = (
            (name, list(members))
            for name, members in groupby(laid, key=lambda each: each.column.group)
        )
        over = GAP.join(
            name.ljust(sum(each.width for each in group) + len(GAP) * (len(group) - 1))
            for name, group in names
        )
        yield over.rstrip(), ""
    yield GAP.join(each.place(each.column.heading) for each in laid).rstrip(), ""
    yield GAP.join("-" * each.width for each in laid), ""
    for row, colour in enumerate(colours):
        yield GAP.join(each.place(each.cells[row]) for each in laid).rstrip(), colour
