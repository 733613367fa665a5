"""NC program that tests the block rate of a control."""

from math import isfinite

from extras.calibration.length_unit import LengthUnit
from extras.calibration.model.block_feed import (
    DWELL,
    LEAST_INCREMENTS,
    BlockTest,
    program_blocks,
    written_spacings,
)
from extras.calibration.verbs.blocktest.request import BlockTestFiles, BlockTestRequest
from extras.calibration.verbs.blocktest.result import BlockTestResult
from service.files import write_lines
from service.progress import Tell, silent
from service.simulation.code_simulation import dialect_of
from simulator.library import load_machine
from simulator.spec import Machine, MachineKind
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import coordinate_increment, write
from stepnc_model.units import mm_from_inches, speed_from_mm_min, um_from_mm

SPACINGS_IN = (0.0001, 0.00025, 0.0005, 0.00075, 0.001, 0.0025, 0.005, 0.0075, 0.01)
RADII_IN = (0.5, 1.0, 2.0)
"""Spacings and radii of paper 004, in."""

MOST_RADIUS = 1_000.0
"""Largest radius of a circle, mm."""

MOST_CIRCLES = 500


def run(
    request: BlockTestRequest, files: BlockTestFiles, *, tell: Tell = silent
) -> BlockTestResult:
    """Write the test program for a control, and tell which spacings it leaves out.

    Raises
    ------
    StepNcError
        When a number is out of its bounds, no spacing is left, or the file cannot be written.
    """
    if not request.machine:
        raise StepNcError("name the machine with --machine: its kind and greatest feed count")
    machine = load_machine(request.machine)
    output = files.output
    dialect = dialect_of(output, request.dialect)
    increment = coordinate_increment(dialect)
    test, left_out = _test(request, machine, increment)
    for each in left_out:
        tell(_left_out(each, dialect, increment))
    if not test.spacings:
        raise StepNcError(
            f"no spacing is left: {dialect.value} writes steps of {um_from_mm(increment):g} µm "
            f"and needs at least {LEAST_INCREMENTS * increment:g} mm"
        )
    blocks = program_blocks(test, name=output.stem)
    count = write_lines(output, write(blocks, dialect))
    duration = _duration(test, machine)
    took = "" if duration is None else f", about {duration:.0f} s"
    circles = len(test.radii) * len(test.spacings)
    tell(f"written: {output} ({counted(count, 'line')}, {counted(circles, 'circle')}{took})")
    return BlockTestResult(
        file=output, test=test, left_out=left_out, lines=count, duration=duration
    )


def _test(
    request: BlockTestRequest, machine: Machine, increment: float
) -> tuple[BlockTest, tuple[float, ...]]:
    """Test in canonical units, and the spacings that it leaves out."""
    radii = _lengths(request.radius, RADII_IN, "radius", unit=request.unit)
    spacings = _lengths(request.spacing, SPACINGS_IN, "spacing", unit=request.unit)
    for each in spacings:
        if each > 0.5 * min(radii):
            raise StepNcError(
                f"spacing {each:g} mm: must be at most half of the smallest radius, "
                f"{0.5 * min(radii):g} mm"
            )
    if len(radii) * len(spacings) > MOST_CIRCLES:
        raise StepNcError(
            f"{len(radii) * len(spacings)} circles: at most {MOST_CIRCLES} allowed"
        )
    fit, left_out = written_spacings(spacings, increment=increment)
    is_lathe = machine.kind is MachineKind.LATHE
    test = BlockTest(
        radii=radii,
        spacings=fit,
        feed=_feed(request, machine),
        lines=request.lines,
        machine=MachineType.LATHE if is_lathe else MachineType.MILL,
    )
    return test, left_out


def _lengths(
    typed: tuple[float, ...] | None, usual: tuple[float, ...], what: str, *, unit: LengthUnit
) -> tuple[float, ...]:
    """Lengths in mm, ascending: as typed, or those of the paper."""
    if typed is None:
        return tuple(mm_from_inches(each) for each in usual)
    for each in typed:
        if not isfinite(each) or not 0.0 < unit.to_mm(each) <= MOST_RADIUS:
            bound = f"must be above 0 and at most {unit.from_mm(MOST_RADIUS):g} {unit.value}"
            raise StepNcError(f"{what} {each:g} {unit.value}: {bound}")
    return tuple(sorted({unit.to_mm(each) for each in typed}))


def _feed(request: BlockTestRequest, machine: Machine) -> float:
    """Commanded feed, mm/s: as typed, or the greatest of the machine's axes."""
    if request.feed is not None:
        return speed_from_mm_min(request.unit.to_mm(request.feed))
    feeds = [axis.max_feed for axis in machine.axes if axis.name in {"X", "Y", "Z"}]
    if not feeds:
        raise StepNcError(
            f"machine '{machine.name}' has no data for its axes: give the feed with --feed"
        )
    return min([*feeds, *([machine.max_feed] if machine.max_feed else [])])


def _duration(test: BlockTest, machine: Machine) -> float | None:
    """Time of all blocks at the machine's block time and the commanded feed, s."""
    if machine.block_time is None:
        return None
    times = (max(machine.block_time, each / test.feed) for each in test.spacings)
    return len(test.radii) * sum(test.lines * each + 2.0 * DWELL for each in times)


def _left_out(spacing: float, dialect: Dialect, increment: float) -> str:
    return (
        f"left out: spacing {um_from_mm(spacing):g} µm: {dialect.value} writes steps of "
        f"{um_from_mm(increment):g} µm, and {LEAST_INCREMENTS} of them are the least"
    )
