"""Circles of the block test: written by every dialect, and found again in its NC code."""

import pytest

from extras.calibration.model.block_feed import (
    LEVEL,
    BlockTest,
    circles_of,
    program_blocks,
    written_spacings,
)
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.post.blocks import Linear, MachineType, ProgramEnd, Rapid, Rate
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import coordinate_increment, write

PAPER = tuple(
    25.4 * each for each in (0.0001, 0.00025, 0.0005, 0.00075, 0.001, 0.0025, 0.005, 0.01)
)
WRITTEN = [
    (control, machine)
    for control in Dialect
    for machine in MachineType
    if control is not Dialect.CANONICAL
    and (control, machine) != (Dialect.HEIDENHAIN, MachineType.LATHE)
]


def block_test(machine: MachineType, spacings: tuple[float, ...]) -> BlockTest:
    return BlockTest(
        radii=(12.7, 50.8), spacings=spacings, feed=300.0, lines=200, machine=machine
    )


@pytest.mark.parametrize(("control", "machine"), WRITTEN)
def test_each_dialect_writes_circles_that_are_found_again(
    control: Dialect, machine: MachineType
) -> None:
    test = block_test(machine, (0.0254, 0.254))
    code = list(write(program_blocks(test, name="test"), control))
    circles = circles_of(read_blocks(code, control, machine=machine))
    assert [round(each.radius, 1) for each in circles] == [12.7, 12.7, 50.8, 50.8]
    for circle, spacing in zip(circles, (0.0254, 0.254, 0.0254, 0.254), strict=True):
        assert circle.lines == 200
        assert circle.spacing == pytest.approx(spacing, rel=1e-3)
        assert circle.feed == pytest.approx(300.0)
        assert circle.turn == pytest.approx(200 * spacing / circle.radius, rel=2e-3)


def test_lengths_are_those_of_the_rounded_points() -> None:
    """20 steps of 1 µm: a line is up to a step longer or shorter than the next."""
    test = block_test(MachineType.MILL, (0.02,))
    code = list(write(program_blocks(test, name="test"), Dialect.FANUC))
    circle = circles_of(read_blocks(code, Dialect.FANUC))[0]
    assert circle.spacing != 0.02
    assert circle.spacing == pytest.approx(0.02, rel=2e-3)


def test_spacings_below_20_increments_are_left_out() -> None:
    fit, left_out = written_spacings(PAPER, increment=coordinate_increment(Dialect.FANUC))
    assert left_out == PAPER[:4]
    assert fit == PAPER[4:]
    assert written_spacings(PAPER, increment=coordinate_increment(Dialect.LINUXCNC))[1] == ()


def test_circles_of_a_mill_have_levels_and_those_of_a_lathe_places_along_the_axis() -> None:
    mill = circles_of(program_blocks(block_test(MachineType.MILL, (0.1, 0.2)), name=""))
    assert [each.centre[2] for each in mill] == [0.0, LEVEL, 2 * LEVEL, 3 * LEVEL]
    lathe = circles_of(program_blocks(block_test(MachineType.LATHE, (0.1, 0.2)), name=""))
    assert [each.centre[2] for each in lathe] == pytest.approx(
        [0.0, LEVEL, 2 * LEVEL, 3 * LEVEL], abs=1e-9
    )
    assert min(each.points[:, 0].min() for each in lathe) >= 10.0


def test_lines_that_are_no_circle_are_passed_over() -> None:
    rate = Rate(value=10.0)
    zigzag = [Linear(end=(float(x), float(x % 2), 0.0), rate=rate) for x in range(40)]
    assert circles_of([Rapid(end=(0.0, 0.0, 5.0)), *zigzag, ProgramEnd()]) == ()
    assert circles_of([]) == ()
