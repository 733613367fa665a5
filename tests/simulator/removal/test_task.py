"""Paths and room to work in, as kernels take them."""

from math import pi

import numpy as np
import pytest

from simulator.motion.segments import arc, lines
from simulator.removal.cutter import Cutter, profile_of
from simulator.removal.ring import ROUND_SAMPLES, SAMPLES, RimTool
from simulator.removal.trial import desk_for, rows_of


def test_a_row_has_ends_centre_radius_angle_and_turn() -> None:
    quarter = arc((20.0, 10.0, -1.0), (10.0, 10.0, -1.0), 0.5 * pi, rise=2.0)
    ends = [20.0, 10.0, -1.0, 10.0, 20.0, 1.0]
    expected = [*ends, 10.0, 10.0, -1.0, 10.0, 0.0, 0.5 * pi, 2.0]
    assert rows_of(quarter)[0] == pytest.approx(expected)
    assert rows_of(lines([(0, 0, 0), (3, 4, 5)]))[0, :6].tolist() == [0, 0, 0, 3, 4, 5]


@pytest.mark.parametrize(("corner", "samples"), [(0.0, SAMPLES), (2.0, ROUND_SAMPLES)])
def test_a_rounded_tool_looks_at_more_rings_of_fewer_samples(
    corner: float, samples: int
) -> None:
    cutter = Cutter(diameter=8.0, corner_radius=corner)
    desk = desk_for(RimTool(profile_of(cutter, reach=20.0), 1.0, 1.0))
    assert len(desk.rim.wide.heights) == samples
    assert desk.raised.dtype == np.float64
