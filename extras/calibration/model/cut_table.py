"""Table of measured cuts: one row a cut, of which forces, roughness and tool life are learned.

CSV with the unit in the name of the column; empty cells are unknown. Cells stay in the units of
their columns, because the rows are also kept as text in the material's file.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from math import isfinite
from pathlib import Path

from simulator.errors import CalibrationError
from stepnc_model.errors import Finding, Severity
from stepnc_model.regular_file import open_regular

WORDS = (
    "operation", "tool", "chip_breaker", "edge_material", "coolant", "edge", "use",
)  # fmt: skip
"""Columns of text."""

POSITIVE: Mapping[str, tuple[float, float]] = {
    "cutting_speed_m_min": (0.1, 10_000.0),
    "feed_mm": (1e-4, 20.0),
    "axial_depth_mm": (1e-3, 500.0),
    "radial_width_mm": (1e-3, 2_000.0),
    "cutting_edge_angle_deg": (5.0, 120.0),
    "nose_radius_mm": (0.01, 50.0),
    "tool_diameter_mm": (0.05, 2_000.0),
    "teeth": (1.0, 500.0),
    "cutting_force_n": (0.01, 1e6),
    "specific_cutting_force_n_mm2": (50.0, 100_000.0),
    "ra_um": (1e-3, 500.0),
    "life_min": (1e-2, 1e5),
}
"""Columns of positive numbers, with the range of what is cut; outside is a slip of the unit."""

NOT_NEGATIVE: Mapping[str, tuple[float, float]] = {
    "flank_wear_mm": (0.0, 5.0),
    "time_min": (0.0, 1e5),
}
"""Columns of numbers that may be 0."""

NUMBERS = {**POSITIVE, **NOT_NEGATIVE}
COLUMNS = (*WORDS, *NUMBERS)

SEPARATORS = ",;\t"
MOST_ROWS = 20_000
USES = ("", "fit", "test")


@dataclass(frozen=True, slots=True, kw_only=True)
class CutRow:
    """One row of the table."""

    line: int
    """Line of the file; 0 for a row that a material's file keeps."""
    words: Mapping[str, str]
    numbers: Mapping[str, float]

    def word(self, column: str) -> str:
        """Text of a cell; empty if unknown."""
        return self.words.get(column, "")

    def number(self, column: str) -> float | None:
        """Number of a cell; None if unknown."""
        return self.numbers.get(column)

    @property
    def is_turned(self) -> bool:
        """True for turning and boring; a row that names no operation is turned."""
        name = self.word("operation").lower()
        return not name or "turn" in name or "boring" in name

    @property
    def is_dry(self) -> bool:
        """True if the row says that it was cut dry."""
        return self.word("coolant").lower() == "dry"

    @property
    def key(self) -> str:
        """Tool and conditions that form a level of their own."""
        names = ("tool", "chip_breaker", "edge_material", "coolant")
        return "; ".join(f"{name} {self.word(name)}" for name in names if self.word(name))

    @property
    def text(self) -> tuple[str, ...]:
        """Cells in the order of the columns, without the use."""
        return tuple(
            self.word(name) if name in WORDS else _shown(self.number(name))
            for name in COLUMNS
            if name != "use"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CutTable:
    """Rows of a table, with what was noticed while reading."""

    name: str
    rows: tuple[CutRow, ...]
    findings: tuple[Finding, ...] = field(default=())


def read_cut_table(path: Path) -> CutTable:
    """Read and check a table of cuts.

    Raises
    ------
    CalibrationError
        With the line and column of a cell that is no number, or outside its range.
    """
    try:
        with open_regular(path) as file:
            text = file.read().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CalibrationError("is not UTF-8 text", path=str(path)) from error
    except (OSError, ValueError) as error:
        raise CalibrationError(str(error), path=str(path)) from error
    rows, unknown = _rows(text, str(path))
    if not rows:
        raise CalibrationError("the table has no rows", path=str(path))
    return CutTable(name=path.name, rows=rows, findings=tuple(map(_unused, unknown)))


def kept_text(rows: Sequence[CutRow]) -> str:
    """Rows as CSV, sorted, so that the order of batches does not matter."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([name for name in COLUMNS if name != "use"])
    writer.writerows(sorted(row.text for row in rows))
    return out.getvalue()


def kept_rows(text: str, path: str) -> tuple[CutRow, ...]:
    """Rows of the text that a material's file keeps.

    Raises
    ------
    CalibrationError
        When the text was damaged.
    """
    return _rows(text, path)[0]


def _rows(text: str, path: str) -> tuple[tuple[CutRow, ...], list[str]]:
    head = text.partition("\n")[0]
    separator = next((each for each in SEPARATORS if each in head), ",")
    reader = csv.DictReader(io.StringIO(text), delimiter=separator)
    names = [name.strip() for name in reader.fieldnames or ()]
    reader.fieldnames = names
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise CalibrationError("the column occurs twice", path=path, line=1, column=twice)
    if not set(names) & set(NUMBERS):
        known = ", ".join(NUMBERS)
        raise CalibrationError(
            f"no column of a cut; the columns are {known}", path=path, line=1
        )
    found = []
    for cells in reader:
        if None in cells:
            raise CalibrationError("more cells than columns", path=path, line=reader.line_num)
        if any(cells.values()):
            found.append(_row(cells, path, reader.line_num, separator != ","))
        if len(found) > MOST_ROWS:
            raise CalibrationError(f"more than {MOST_ROWS} rows", path=path)
    return tuple(found), [name for name in names if name not in COLUMNS]


def _row(cells: Mapping[str, str | None], path: str, line: int, has_comma: bool) -> CutRow:
    words = {name: (cells.get(name) or "").strip() for name in WORDS if cells.get(name)}
    numbers = {}
    for name, (low, high) in NUMBERS.items():
        cell = (cells.get(name) or "").strip()
        if not cell:
            continue
        try:
            value = float(cell.replace(",", ".") if has_comma else cell)
        except ValueError:
            raise CalibrationError(
                f"'{cell}' is not a number", path=path, line=line, column=name
            ) from None
        if not (isfinite(value) and low <= value <= high):
            raise CalibrationError(
                f"{value:g} is outside {low:g} to {high:g}", path=path, line=line, column=name
            )
        numbers[name] = value
    if words.get("use", "") not in USES:
        raise CalibrationError(
            f"'{words['use']}' must be fit, test or empty", path=path, line=line, column="use"
        )
    return CutRow(line=line, words=words, numbers=numbers)


def _unused(name: str) -> Finding:
    near = get_close_matches(name, COLUMNS, n=1)
    hint = f"; is {near[0]} meant?" if near else ""
    return Finding(
        severity=Severity.WARNING, message=f"the column is not used{hint}", attribute=name
    )


def _shown(value: float | None) -> str:
    return "" if value is None else repr(value)
