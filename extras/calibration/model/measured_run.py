"""Measured run: sensor values of a machine, one row per sample.

The file is CSV with the column names of the virtual machine's timeline; a machine need not have
all columns. Cells are separated by comma, semicolon or tab. Unusable data raise a
:class:`CalibrationError`; problems that do not prevent a fit are reported as a
:class:`~stepnc_model.errors.Finding`. Units mm, s, W.
"""

import csv
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from io import TextIOWrapper
from itertools import chain
from pathlib import Path

import numpy as np

from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Ints
from stepnc_model.errors import Finding, Severity
from stepnc_model.regular_file import open_regular

TIME = "time_s"
POSITIONS = tuple(f"{axis}_axis_position_actual" for axis in "xyz")
SEPARATORS = ",;\t"
"""Separators of cells; the first one found in the heading is used. With a semicolon or tab,
numbers may have a decimal comma."""
FEWEST_SAMPLES = 10
GAP = 3.0
"""Sampling interval over its median from which it counts as a gap."""
AXIS_SPEED = 5_000.0  # mm/s: several times the rapid speed of the fastest machine tools
PEAK_POWER = (30.0, 1e6)  # W: range for a spindle or machine; 30 kW is rarely exceeded
INTERVAL = (1e-5, 60.0)  # s between samples: 100 kHz to one per minute


class Component(StrEnum):
    """Component whose power is measured, by its column in :mod:`simulator.machine.timeline`."""

    X = "x_axis_wattage"
    Y = "y_axis_wattage"
    Z = "z_axis_wattage"
    SPINDLE = "c_axis_wattage"
    COOLANT = "coolant_wattage"
    BASE = "load_wattage"
    TOTAL = "electric_wattage"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredRun:
    """Position and power at N samples of one measured run."""

    name: str
    time: Floats
    """Time of each sample, (N,), s, ascending."""
    position: Floats
    """Position of the axes, (N, 3), mm; NaN for an axis without a column."""
    power: Mapping[Component, Floats]
    """Power of each measured component, each (N,), W."""
    findings: tuple[Finding, ...] = ()

    def __len__(self) -> int:
        return len(self.time)

    @property
    def durations(self) -> Floats:
        """Time represented by each sample, (N,), s: up to the next one, 0 before a gap."""
        steps = np.diff(self.time)
        usual = float(np.median(steps))
        return np.append(np.where(steps > GAP * usual, 0.0, steps), usual)


def read_run(path: Path) -> MeasuredRun:
    """Read and check a measured run from a CSV file.

    Rows with an empty cell are skipped and leave a gap.

    Raises
    ------
    CalibrationError
        If a column is missing or has non-numeric cells, time does not ascend, a value is
        implausible for a machine tool in the unit of its column, or no power ever changes.
    """
    columns, lines = read_columns(path, wanted=(TIME, *POSITIONS, *Component))
    if TIME not in columns:
        raise CalibrationError(
            "column is missing; it must hold the time in s", path=str(path), column=TIME
        )
    power = {part: columns[part] for part in Component if part in columns}
    if not power:
        names = ", ".join(Component)
        raise CalibrationError(
            f"no column with a power in W; one of {names} is needed", path=str(path)
        )
    absent = np.full(len(lines), np.nan)
    run = MeasuredRun(
        name=path.stem,
        time=columns[TIME],
        position=np.stack([columns.get(name, absent) for name in POSITIONS], axis=1),
        power=power,
    )
    return checked(run, lines=lines, path=str(path))


def thinned(run: MeasuredRun, *, most: int) -> MeasuredRun:
    """Reduce a run to every second, third … sample if it has more than ``most``."""
    step = -(-len(run) // most)
    if step == 1:
        return run
    text = f"{len(run)} samples: one in {step} is used"
    return replace(
        run,
        time=run.time[::step],
        position=run.position[::step],
        power={part: watts[::step] for part, watts in run.power.items()},
        findings=(*run.findings, Finding(severity=Severity.NOTE, message=text)),
    )


def read_columns(
    path: Path, *, wanted: Sequence[str], spelt: Callable[[str], str] = str
) -> tuple[dict[str, Floats], Ints]:
    """Read the wanted columns that a CSV file has, and the line of each row.

    Parameters
    ----------
    path : Path
    wanted : sequence of str
        Wanted headings.
    spelt : callable
        Function that converts a heading of the file to the spelling of the wanted ones.

    Returns
    -------
    dict of (N,) arrays by heading, (N,) array of int

    Raises
    ------
    CalibrationError
        If the file is not text, has too few rows, a row of another length, or a cell that
        is not a number.
    """
    rows = _rows(path)
    headings = [spelt(heading) for heading in next(rows, [])]
    columns = {name: headings.index(name) for name in wanted if name in headings}
    # A list of a million rows would need gigabytes.
    values, lines = array("d"), array("q")
    for line, row in enumerate(rows, start=2):
        numbers = _numbers(row, columns, width=len(headings), path=str(path), line=line)
        if None not in numbers:
            values.extend(number for number in numbers if number is not None)
            lines.append(line)
    if len(lines) < FEWEST_SAMPLES:
        message = f"{len(lines)} complete samples; at least {FEWEST_SAMPLES} are required"
        raise CalibrationError(message, path=str(path))
    table = np.array(values).reshape(len(lines), len(columns)).T
    return dict(zip(columns, table, strict=True)), np.array(lines)


def _rows(path: Path) -> Iterator[list[str]]:
    """Rows of a CSV file, read lazily; the heading determines the separator."""
    try:
        with TextIOWrapper(open_regular(path), encoding="utf-8-sig", newline="") as stream:
            heading = stream.readline()
            mark = next((each for each in SEPARATORS if each in heading), ",")
            for row in csv.reader(chain((heading,), stream), delimiter=mark):
                # If the separator is not a comma, commas may be decimal commas.
                yield row if mark == "," else [cell.replace(",", ".") for cell in row]
    except OSError as error:
        raise CalibrationError(error.strerror or str(error), path=str(path)) from error
    except UnicodeDecodeError as error:
        raise CalibrationError("not a UTF-8 text file", path=str(path)) from error
    except ValueError as error:
        raise CalibrationError(f"invalid file name: {error}", path=repr(str(path))) from error
    except csv.Error as error:
        raise CalibrationError(str(error), path=str(path)) from error


def _numbers(
    row: list[str], columns: Mapping[str, int], *, width: int, path: str, line: int
) -> list[float | None]:
    """Numbers in the cells of a row; ``None`` for an empty cell."""
    if len(row) != width:
        message = f"{len(row)} values in a table with {width} columns"
        raise CalibrationError(message, path=path, line=line)
    values: list[float | None] = []
    for name, index in columns.items():
        cell = row[index].strip()
        try:
            value = float(cell) if cell else None
        except ValueError:
            value = np.nan
        if value is not None and not np.isfinite(value):
            raise CalibrationError(
                f"'{cell}' is not a number", path=path, line=line, column=name
            )
        values.append(value)
    return values


def checked(run: MeasuredRun, *, lines: Ints, path: str) -> MeasuredRun:
    """Check a run; add findings, and remove powers that are constant.

    Parameters
    ----------
    run : MeasuredRun
    lines : (N,) array of int
        Line of each sample in the file.
    path : str

    Raises
    ------
    CalibrationError
        If time does not ascend, a value is implausible for a machine tool, or no power ever
        changes.
    """
    _check_time(run.time, lines=lines, path=path)
    _check_units(run, lines=lines, path=path)
    constant = [part for part, watts in run.power.items() if float(np.ptp(watts)) == 0.0]
    if len(constant) == len(run.power):
        level = run.power[constant[0]][0]
        message = f"constant at {level:g} W, like all powers; nothing can be fitted"
        raise CalibrationError(message, path=path, column=constant[0])
    findings = (
        *run.findings,
        *_gaps(run.time, lines=lines),
        *(
            _warning(f"constant at {run.power[part][0]:g} W; ignored", part)
            for part in constant
        ),
    )
    kept = {part: watts for part, watts in run.power.items() if part not in constant}
    return replace(run, power=kept, findings=findings)


def _check_time(time: Floats, *, lines: Ints, path: str) -> None:
    """Check that time ascends with plausible sampling intervals."""
    steps = np.diff(time)
    if (steps <= 0.0).any():
        row = int(np.argmax(steps <= 0.0)) + 1
        message = f"{time[row]:g} s after {time[row - 1]:g} s; time must ascend"
        raise CalibrationError(message, path=path, line=int(lines[row]), column=TIME)
    usual = float(np.median(steps))
    low, high = INTERVAL
    if not low <= usual <= high:
        message = (
            f"sampling interval {usual:g} s, expected {low:g} to {high:g} s; "
            "is the time in another unit?"
        )
        raise CalibrationError(message, path=path, column=TIME)


def _check_units(run: MeasuredRun, *, lines: Ints, path: str) -> None:
    """Check that speeds and powers are plausible for a machine tool in mm/s and W."""
    speed = np.abs(np.diff(run.position, axis=0)) / np.diff(run.time)[:, None]
    for axis, name in enumerate(POSITIONS):
        fast = np.flatnonzero(speed[:, axis] > AXIS_SPEED)
        if len(fast):
            message = (
                f"{speed[fast[0], axis]:g} mm/s between two samples, above {AXIS_SPEED:g} mm/s;"
                " are positions in mm and times in s?"
            )
            line = int(lines[fast[0] + 1])
            raise CalibrationError(message, path=path, line=line, column=name)
    low, high = PEAK_POWER
    for part in (Component.SPINDLE, Component.TOTAL):
        peak = float(np.max(np.abs(run.power.get(part, np.full(1, low)))))
        if 0.0 < peak < low or peak > high:
            message = (
                f"peak {peak:g} W, expected {low:g} to {high:g} W; "
                "is the power in another unit, such as kW?"
            )
            raise CalibrationError(message, path=path, column=part)


def _gaps(time: Floats, *, lines: Ints) -> list[Finding]:
    """Findings for intervals far above the median sampling interval."""
    steps = np.diff(time)
    bound = GAP * float(np.median(steps))
    return [
        _warning(
            f"gap of {steps[row]:g} s, above {bound:g} s; its energy is not counted",
            TIME,
            line=int(lines[row + 1]),
        )
        for row in np.flatnonzero(steps > bound)
    ]


def _warning(message: str, column: str, *, line: int = 0) -> Finding:
    """Finding about a column of a measured run."""
    return Finding(
        severity=Severity.WARNING,
        message=message,
        entity="measured run",
        attribute=column,
        line=line,
    )
