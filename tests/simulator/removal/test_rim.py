"""Look-up at the rim where no outline is exact: rounded tools, slopes, forgotten moves."""

from math import acos, pi, sqrt

import numpy as np
import pytest

from simulator.motion.segments import lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.rim import FORGETTING
from stepnc_model.toolpath.job import Stock

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
