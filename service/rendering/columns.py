"""Columns of a result: written once, rendered as text, HTML, CSV, Parquet and JSON.

A result is a sequence of rows, which are frozen dataclasses. A column says how one value of a
row is named and shown: its key in files, its heading on screens, its format, and a help text
with the symbol of the papers.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from math import isfinite
from typing import Generic, TypeVar

R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A value before and after; shown once where both look the same."""

    before: "Cell"
    after: "Cell"


Cell = str | float | int | bool | datetime | Change | Sequence[object] | None
"""value of a column in a row; None: there is none"""

BLANK = " "
"""a cell that stays empty, because the column does not apply to the row"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column(Generic[R]):
    """One column of a result.

    Examples
    --------
    >>> time = Column(key="time_s", heading="time s", form=".1f", value=lambda row: row)
    >>> time.text(Change(before=12.04, after=9.5))
    '12.0 -> 9.5'
    >>> time.text(None)
    ''
    """

    value: Callable[[R], Cell]
    """Value of a row, in the user's unit"""
    key: str = ""
    """in files and JSON, with the unit; dots nest in JSON; empty: not written"""
    heading: str = ""
    """on screens, with the unit; empty: not shown"""
    form: str = ""
    """format of numbers"""
    scale: float = 1.0
    """of numbers on screens, whose unit may be another than in files"""
    kind: type = float
    """type in files: str, float, int, bool or datetime"""
    group: str = ""
    """upper level of the header"""
    help: str = ""
    """what it is, with the symbol of the papers"""
    is_right: bool = False
    """whether text tables align it to the right"""
    is_words: bool = False
    """whether pages align it to the left"""
    is_of_row: bool = False
    """whether all lines of one row share the cell"""
    is_key: bool = False
    """whether it is repeated where a table is broken into blocks"""
    is_optional: bool = False
    """whether it is left out where no row has a value"""
    css: Callable[[R], str] | None = None
    """class of the cell on pages"""

    def text(self, row: R, *, arrow: str = "->", nothing: str = "") -> str:
        """Cell as shown."""
        value = _scaled(self.value(row), self.scale)
        return shown(value, self.form, arrow=arrow, nothing=nothing)


def _scaled(value: Cell, scale: float) -> Cell:
    """A number, or a change of one, in another unit."""
    if scale == 1.0 or value is None:
        return value
    if isinstance(value, Change):
        return Change(before=_scaled(value.before, scale), after=_scaled(value.after, scale))
    return value * scale if isinstance(value, int | float) else value


def shown(value: Cell, form: str = "", *, arrow: str = "->", nothing: str = "") -> str:
    """A value as people read it; times in the zone of this computer.

    Parameters
    ----------
    value : Cell
    form : str
        Format of numbers.
    arrow : str
        Between a value before and after.
    nothing : str
        For what is not known, or not finite.

    Examples
    --------
    >>> shown([0.03, 1234.6], ".3g")
    '0.03, 1235'
    >>> shown(None, nothing="–")
    '–'
    """
    if isinstance(value, Change):
        pair = [shown(each, form) for each in (value.before, value.after)]
        known = list(dict.fromkeys(each for each in pair if each))
        return f" {arrow} ".join(known) or nothing
    if value is None or (isinstance(value, float) and not isfinite(value)):
        return nothing
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value, form)
    if isinstance(value, datetime):
        return f"{value.astimezone():%Y-%m-%d %H:%M}"
    if isinstance(value, list | tuple):
        return ", ".join(shown(each, form) for each in value) or nothing
    return str(value) or nothing


def _number(value: float, form: str) -> str:
    """In its format; large numbers of so many significant digits without an exponent."""
    text = format(value, form)
    return f"{value:.0f}" if form.endswith("g") and "e+" in text else text


def visible(columns: Sequence[Column[R]], rows: Sequence[R]) -> list[Column[R]]:
    """Columns with a heading, without optional ones that are empty in all rows."""
    return [
        column
        for column in columns
        if column.heading
        and not (column.is_optional and not any(column.text(row) for row in rows))
    ]


def grouped(columns: Sequence[Column[R]]) -> list[tuple[str, list[Column[R]]]]:
    """Columns below the name of their group each."""
    groups = groupby(columns, key=lambda column: column.group)
    return [(name, list(members)) for name, members in groups]


def clock(seconds: float) -> str:
    """Time as people say it."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"
