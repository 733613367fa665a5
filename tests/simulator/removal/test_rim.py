"""Look-up at the rim where no outline is exact: rounded tools, slopes, forgotten moves."""

from math import acos, pi, sqrt

import numpy as np
import pytest

from simulator.motion.segments import lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.rim import FORGETTING, SLIVERS
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -12.0), high=(60.0, 40.0, 0.0))
BALL = Cutter(diameter=10.0, corner_radius=5.0)


def test_ball_beside_a_slot_of_its_own() -> None:
    work = MillingStock(BOX, cell=0.1)
    for y in (20.0, 21.0):
        found = work.cut(lines([(-8.0, y, -2.0), (68.0, y, -2.0)], speed=1.0), BALL)
    inside = (found.station > 20.0) & (found.station < 50.0)
    # A slice of radius r lies within that of the first pass where r·cos φ < r − 1; the lowest
    # of six slices has its middle at a twelfth of the depth.
    height = 2.0 / 12.0
    radius = sqrt(height * (10.0 - height))
    assert found.entry_angle[inside] == pytest.approx(0.0, abs=1e-3)
    assert found.exit_angle[inside] == pytest.approx(acos(1.0 - 1.0 / radius), abs=1e-3)
    assert found.section[inside] == pytest.approx(2.0, rel=0.01)


def test_flat_tool_on_a_ramp_has_a_slot_around_it() -> None:
    work = MillingStock(BOX, cell=0.1)
    found = work.cut(
        lines([(-8.0, 20.0, 0.0), (68.0, 20.0, -6.0)], speed=1.0), Cutter(diameter=10.0)
    )
    inside = (found.station > 25.0) & (found.station < 60.0)
    assert found.contact_angle[inside] == pytest.approx(pi, abs=1e-3)
    depth = 6.0 / 76.0 * (found.station[inside] * 76.0 / np.hypot(76.0, 6.0))
    assert found.axial_depth[inside] == pytest.approx(depth, abs=0.15)
    assert (found.section * np.diff(found.station, prepend=0.0)).sum() == pytest.approx(
        work.volume
    )


def test_forgotten_move_is_read_from_the_map() -> None:
    work = MillingStock(BOX, cell=0.1)
    first = lines([(-8.0, 20.0, -2.0), (68.0, 20.0, -2.0)], speed=1.0)
    second = lines([(-8.0, 24.0, -2.0), (68.0, 24.0, -2.0)], speed=1.0)
    flat = Cutter(diameter=10.0)
    work.cut(first, flat)
    work._past.next[0] += FORGETTING
    found = work.cut(second, flat)
    inside = (found.station > 20.0) & (found.station < 50.0)
    assert found.contact_angle[inside] == pytest.approx(acos(1.0 - 4.0 / 5.0), abs=0.1)
    assert found.section[inside] == pytest.approx(8.0, rel=0.03)


@pytest.mark.parametrize("corner", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("cell", [0.2, 0.5])
def test_small_corner_has_exact_sections_whatever_the_cells(corner: float, cell: float) -> None:
    """Beside a pass of its own: 4 mm wider at every height, 2 mm deep."""
    work = MillingStock(BOX, cell=cell)
    rounded = Cutter(diameter=10.0, corner_radius=corner)
    for y in (20.0, 24.0):
        found = work.cut(lines([(-8.0, y, -2.0), (68.0, y, -2.0)], speed=1.0), rounded)
    inside = (found.station > 20.0) & (found.station < 50.0)
    assert found.section[inside] == pytest.approx(8.0, rel=1e-6)
    assert found.axial_depth[inside] == pytest.approx(2.0, abs=1e-9)


def test_levels_over_a_small_corner_are_told_apart() -> None:
    """A step of 3 mm under a pass of 5 mm: 5 mm of width above it, 10 mm below."""
    work, flat = MillingStock(BOX, cell=0.25), Cutter(diameter=10.0)
    rounded = Cutter(diameter=10.0, corner_radius=1.0)
    work.cut(lines([(-8.0, 25.0, -3.0), (68.0, 25.0, -3.0)], speed=1.0), flat)
    found = work.cut(lines([(-8.0, 20.0, -5.0), (68.0, 20.0, -5.0)], speed=1.0), rounded)
    inside = (found.station > 20.0) & (found.station < 50.0)
    corner = 2.0 * (1.0 - 0.25 * pi)
    # Six slices of the corner err by its last bit of area.
    assert found.section[inside] == pytest.approx(3.0 * 5.0 + 2.0 * 10.0 - corner, rel=2e-3)


@pytest.mark.parametrize(("left", "deep"), [(0.2, 1.0), (0.5, 1.0), (0.6, 2.0), (1.0, 2.0)])
def test_a_sliver_on_a_wall_counts_for_the_section_and_not_for_the_depth(
    left: float, deep: float
) -> None:
    """Of 10 mm a step of 1 mm has left a strip: a depth from a twentieth of the section on."""
    work, flat = MillingStock(BOX, cell=0.1), Cutter(diameter=10.0)
    work.cut(lines([(-8.0, 20.0 + left, -1.0), (68.0, 20.0 + left, -1.0)], speed=1.0), flat)
    found = work.cut(lines([(-8.0, 20.0, -2.0), (68.0, 20.0, -2.0)], speed=1.0), flat)
    inside = (found.station > 20.0) & (found.station < 50.0)
    assert found.section[inside] == pytest.approx(10.0 + left, rel=1e-6)
    share = left / (10.0 + left)
    assert deep == (2.0 if share > SLIVERS else 1.0)
    assert found.axial_depth[inside] == pytest.approx(deep, abs=1e-9)
