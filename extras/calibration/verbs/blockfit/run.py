"""Block time of a control, fitted to a log of the test program or to a table."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa

from extras.calibration.length_unit import LengthUnit
from extras.calibration.model.block_feed import (
    BlockCircle,
    CircleFeed,
    MissedCircle,
    PositionLog,
    circle_feeds,
    circles_of,
    zero_of_log,
)
from extras.calibration.model.block_fit import BlockFit, SpacingFeed, fitted_block_time
from extras.calibration.verbs.blockfit.request import BlockFitFiles, BlockFitRequest
from extras.calibration.verbs.blockfit.result import BlockFitResult
from service.files import open_lines, require_place, write_atomically
from service.inputs.numbers import numbers_in
from service.progress import Tell, silent
from service.recording.logged_run import read_logged_run
from service.recording.table import TABLES, batches, headings
from service.simulation.code_simulation import dialect_of
from simulator.errors import CalibrationError
from simulator.files.machine_file import BlockTime, machine_toml
from simulator.files.toml_file import complaint
from simulator.library import load_machine
from stepnc_model.errors import Finding, PostError, Severity, StepNcError
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.plurals import counted
from stepnc_model.post.blocks import MachineType
from stepnc_model.units import mm_from_inches, ms_from_seconds, speed_from_mm_min

COLUMNS = {
    LengthUnit.INCH: ("spacing_in", "feed_in_min", "radius_in", "commanded_in_min"),
    LengthUnit.MILLIMETRE: ("spacing_mm", "feed_mm_min", "radius_mm", "commanded_mm_min"),
}
"""Columns of a table by unit; the first two are needed."""

LEAST_IN_TABLE = 1e-6
"""Least number in such a table, far below any control; its square stays a number."""


def run(
    request: BlockFitRequest, files: BlockFitFiles, *, tell: Tell = silent
) -> BlockFitResult:
    """Fit the block time, and write it into a copy of a machine file if an output is named.

    Raises
    ------
    StepNcError
        When the log, the program or an option is invalid; nothing is written.
    """
    _require_machine(request, files)
    path = Path(files.log)
    is_table = "://" not in files.log and path.suffix.lower() in TABLES
    unit = _unit(headings(path)) if is_table else None
    feeds: tuple[CircleFeed, ...] = ()
    findings: tuple[Finding, ...] = ()
    if unit is not None:
        points = _table_points(path, unit)
    else:
        feeds, findings = _logged_circles(request, files, tell)
        points = [_point(each) for each in feeds]
    try:
        fit = fitted_block_time(points)
    except CalibrationError as error:
        raise CalibrationError(str(error), path=files.log) from error
    if files.output is not None:
        _write_machine(request.machine, files.log, fit, files.output)
        tell(f"machine file: {files.output}")
    return BlockFitResult(log=files.log, fit=fit, circles=feeds, findings=findings)


def _require_machine(request: BlockFitRequest, files: BlockFitFiles) -> None:
    """Require a machine and a place for its file together."""
    if files.output is None:
        if request.machine:
            raise StepNcError("--machine is written with its block time: name a file with -o")
        return
    if not request.machine:
        raise StepNcError("-o writes a machine file: name the machine with --machine")
    if "://" not in files.log:
        require_place(files.output, apart_from=Path(files.log))


# Tables


def _unit(names: Sequence[str]) -> LengthUnit | None:
    """Unit of a table of spacings; None if it is no such table."""
    return next((unit for unit, each in COLUMNS.items() if each[0] in names), None)


def _table_points(path: Path, unit: LengthUnit) -> list[SpacingFeed]:
    """Points of a table of spacings and feeds."""
    names = headings(path)
    if COLUMNS[unit][1] not in names:
        raise StepNcError(f"{path}: no column {COLUMNS[unit][1]} beside {COLUMNS[unit][0]}")
    kinds = {name: pa.float64() for name in COLUMNS[unit] if name in names}
    rows = [row for batch in batches(path, kinds) for row in batch.to_pylist()]
    points = []
    for number, row in enumerate(rows, start=2):
        for name, value in row.items():
            if value is None or not LEAST_IN_TABLE <= value < 1e6:
                shown = "empty" if value is None else f"{value:g}"
                raise StepNcError(
                    f"{path}: row {number}: {name} {shown}: expected {LEAST_IN_TABLE:g} to 1e6"
                )
        spacing, feed, radius, commanded = (row.get(name) for name in COLUMNS[unit])
        points.append(
            SpacingFeed(
                spacing=unit.to_mm(spacing),
                feed=speed_from_mm_min(unit.to_mm(feed)),
                radius=None if radius is None else unit.to_mm(radius),
                commanded=None
                if commanded is None
                else speed_from_mm_min(unit.to_mm(commanded)),
            )
        )
    return points


# Logs


def _logged_circles(
    request: BlockFitRequest, files: BlockFitFiles, tell: Tell
) -> tuple[tuple[CircleFeed, ...], tuple[Finding, ...]]:
    """Circles of the test program with their feeds in the log, and what the log lacks."""
    if files.program is None:
        raise StepNcError(
            f"{files.log}: name the test program that was run with --program; a table needs "
            f"the columns {' and '.join(COLUMNS[LengthUnit.INCH][:2])}, or "
            f"{' and '.join(COLUMNS[LengthUnit.MILLIMETRE][:2])}"
        )
    circles = _circles(files.program, request.dialect)
    run = read_logged_run(files.log, tell=tell)
    log = _from_zero(request, PositionLog(time=run.time, position=run.position), circles, tell)
    found = list(circle_feeds(log, circles))
    feeds = tuple(each for each in found if isinstance(each, CircleFeed))
    if not feeds:
        raise StepNcError(_nothing(files, log, circles, found))
    missed = [each for each in found if isinstance(each, MissedCircle)]
    return feeds, tuple(_missing(each) for each in missed)


def _from_zero(
    request: BlockFitRequest, log: PositionLog, circles: Sequence[BlockCircle], tell: Tell
) -> PositionLog:
    """The log with positions from the program's zero: as typed, 0,0,0, or found and told."""
    if request.zero:
        zero = np.array(numbers_in(request.zero, "zero", counts=(3,)))
        return replace(log, position=log.position - zero)
    if any(isinstance(each, CircleFeed) for each in circle_feeds(log, circles)):
        return log
    found = zero_of_log(log, circles)
    if found is None:
        return log
    tell(f"zero of the program found at {', '.join(f'{each:.3f}' for each in found)} mm")
    return replace(log, position=log.position - found)


def _circles(program: Path, dialect: str) -> tuple[BlockCircle, ...]:
    """Circles of a test program; read as lathe code, with diameters, if that shows more."""
    control = dialect_of(program, dialect)
    lines = list(open_lines(program))
    found: list[tuple[BlockCircle, ...]] = []
    faults: list[PostError] = []
    for machine in (MachineType.MILL, MachineType.LATHE):
        try:
            found.append(circles_of(read_blocks(lines, control, machine=machine)))
        except PostError as error:
            faults.append(error)
    circles = max(found, key=len, default=())
    if not circles and faults:
        raise StepNcError(f"{program.name}: {faults[0]}") from faults[0]
    if not circles:
        raise StepNcError(
            f"{program}: no circles of short lines; make one with `stepnc blocktest`"
        )
    return circles


def _nothing(
    files: BlockFitFiles,
    log: PositionLog,
    circles: Sequence[BlockCircle],
    feeds: Sequence[CircleFeed | MissedCircle],
) -> str:
    """Probable reason why no circle was found."""
    in_mm = replace(log, position=mm_from_inches(1.0) * log.position)
    if any(isinstance(each, CircleFeed) for each in circle_feeds(in_mm, circles)):
        return f"{files.log}: its positions are in inches; they must be in mm"
    reason = next((each.reason for each in feeds if isinstance(each, MissedCircle)), "")
    low, high = log.position.min(axis=0), log.position.max(axis=0)
    spans = ", ".join(
        f"{axis} {a:g} to {b:g}" for axis, a, b in zip("XYZ", low, high, strict=True)
    )
    return (
        f"{files.log}: none of the {len(circles)} circles of {files.program} is in it "
        f"({reason}); its positions are {spans} mm: was this program run, and where is its "
        "zero (--zero)?"
    )


def _missing(missed: MissedCircle) -> Finding:
    circle = missed.circle
    text = (
        f"circle of radius {circle.radius:.4g} mm, spacing {circle.spacing:.4g} mm left out: "
        f"{missed.reason}"
    )
    return Finding(severity=Severity.WARNING, message=text)


def _point(feed: CircleFeed) -> SpacingFeed:
    circle = feed.circle
    return SpacingFeed(
        spacing=circle.spacing,
        feed=feed.feed,
        radius=circle.radius,
        commanded=circle.feed,
    )


# Machine file


def _write_machine(machine: str, log: str, fit: BlockFit, output: Path) -> None:
    """Write a copy of the machine with the block time and its source."""
    time = fit.block_time
    value = float(f"{time.value:.4g}")
    if refused := complaint(value, BlockTime):
        raise CalibrationError(f"block time: {refused}; check the unit", path=log)
    source = (
        f"stepnc blockfit of {Path(log).name}: {counted(len(fit.points), 'point')}, "
        f"{ms_from_seconds(time.low):.4g} to {ms_from_seconds(time.high):.4g} ms (95 %)"
    )
    found = replace(load_machine(machine), block_time=value, block_time_source=source)
    write_atomically(output, machine_toml(found).encode())
