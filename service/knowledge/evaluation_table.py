"""The evaluation table as text, with the two-level header of the paper.

Where the screen is too narrow, groups of columns go below each other in blocks, each with the
columns that tell what a line is about.
"""

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from textwrap import wrap
from typing import TYPE_CHECKING

from kbe.grade import Grade
from service.knowledge.evaluation_cells import (
    LEGEND,
    NOTHING,
    Column,
    Line,
    columns,
    lines,
    remarks,
    summed,
)
from service.terminal import clean

if TYPE_CHECKING:
    from service.knowledge.evaluated import EvaluationTable

GAP = "  "

COLOURS = {Grade.VIOLATED: "31", Grade.WASTED: "33"}
"""ANSI colours of lines"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Laid:
    """A column with its cells as they are shown."""

    column: Column
    cells: tuple[str, ...]
    width: int


def table_text(table: "EvaluationTable", *, width: int, is_coloured: bool = False) -> str:
    """The table, its remarks and its legend.

    Parameters
    ----------
    table : EvaluationTable
    width : int
        Letters in a line; what has no place goes below.
    is_coloured : bool
        Whether the reader's screen shows colours, and wants them.
    """
    found = list(lines(table.rows))
    laid = [_laid(column, found) for column in columns(table.rows)]
    colours = [COLOURS.get(line.side.grade, "") if is_coloured else "" for line in found]
    parts = [_block(block, colours) for block in blocks(laid, width=width)] if found else []
    notes = [f"{number} {which}: {text}" for number, which, text in remarks(table.rows)]
    for texts in (notes, [summed(table)], [LEGEND]):
        told = [part for text in texts for part in _wrapped(text, width)]
        parts += ["\n".join(told)] if told else []
    return "\n\n".join(parts)


def blocks(laid: Sequence[Laid], *, width: int) -> Iterator[tuple[Laid, ...]]:
    """Columns that have place beside each other, each time with those that are the key."""
    keys = tuple(each for each in laid if each.column.is_key)
    rest = [each for each in laid if not each.column.is_key]
    block = keys
    for _, members in groupby(rest, key=lambda each: each.column.group):
        group = tuple(members)
        # A group stays together, unless it has no place of its own.
        whole = _width(keys + group) <= width
        for part in (group,) if whole else [(each,) for each in group]:
            if block != keys and _width(block + part) > width:
                yield block
                block = keys
            block += part
    if block != keys:
        yield block


def screen_width() -> int:
    """Letters in a line of the terminal; a pipe has no end."""
    if not sys.stdout.isatty() and "COLUMNS" not in os.environ:
        return sys.maxsize
    return shutil.get_terminal_size().columns


def wants_colours() -> bool:
    """Whether stdout is a terminal whose user did not refuse colours."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def plain(text: str) -> str:
    """A name as one line, that cannot steer a terminal."""
    return clean(" ".join(text.split())) or NOTHING


def _laid(column: Column, found: Sequence[Line]) -> Laid:
    """What is the same in a row is told in its first line only."""
    cells = tuple(
        "" if column.is_of_row and not line.is_first else _shown(column.cell(line))
        for line in found
    )
    return Laid(
        column=column, cells=cells, width=max(map(len, (column.label, *cells)), default=0)
    )


def _shown(cell: str) -> str:
    return plain(cell) if cell else ""


def _width(laid: Sequence[Laid]) -> int:
    return sum(each.width for each in _widened(laid)) + len(GAP) * (len(laid) - 1)


def _widened(laid: Sequence[Laid]) -> list[Laid]:
    """Columns that together have place for the name of their group."""
    wide = []
    for name, members in groupby(laid, key=lambda each: each.column.group):
        group = list(members)
        lacking = len(name) - sum(each.width for each in group) - len(GAP) * (len(group) - 1)
        last = group.pop()
        wide += [*group, replace(last, width=last.width + max(0, lacking))]
    return wide


def _block(laid: Sequence[Laid], colours: Sequence[str]) -> str:
    """Header of two levels, rule, lines."""
    laid = _widened(laid)
    names = [
        name.ljust(sum(each.width for each in group) + len(GAP) * (len(group) - 1))
        for name, group in (
            (name, list(members))
            for name, members in groupby(laid, key=lambda each: each.column.group)
        )
    ]
    heads = [
        GAP.join(names).rstrip(),
        GAP.join(_placed(each, each.column.label) for each in laid).rstrip(),
        GAP.join("-" * each.width for each in laid),
    ]
    body = [
        _coloured(GAP.join(_placed(each, each.cells[row]) for each in laid).rstrip(), colour)
        for row, colour in enumerate(colours)
    ]
    return "\n".join([*heads, *body])


def _placed(laid: Laid, text: str) -> str:
    return text.ljust(laid.width) if laid.column.is_words else text.rjust(laid.width)


def _coloured(line: str, colour: str) -> str:
    return f"\x1b[{colour}m{line}\x1b[0m" if colour else line


def _wrapped(text: str, width: int) -> list[str]:
    """A sentence in lines, those after the first set in."""
    return wrap(plain(text), width=max(width, 20), subsequent_indent="   ")
