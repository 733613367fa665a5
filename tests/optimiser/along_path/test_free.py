"""Free profile: the exact optimum within caps and accelerations, with its certificate."""

import numpy as np
import pytest

from optimiser.along_path.free import free_profile
from simulator.motion.segments import Segments, chained, lines
from tests.optimiser.along_path.stretches import FIR, LIMITS, places_of, straight, stretch_of


def test_a_line_is_run_as_a_trapezoid() -> None:
    segments = straight([100.0])
    found = free_profile(
        stretch_of(segments), places_of(segments, [100.0], [40.0]), FIR, has_jerk=False
    )
    acceleration = float(LIMITS.acceleration[0])
    assert found.time == pytest.approx(100.0 / 40.0 + 40.0 / acceleration, rel=1e-6)
    assert found.bound <= found.time
    assert found.worst is not None
    assert found.worst.excess <= 1e-9


def test_limited_jerk_takes_longer() -> None:
    segments = straight([30.0])
    found = free_profile(
        stretch_of(segments), places_of(segments, [30.0], [40.0]), FIR, has_jerk=True
    )
    assert found.jerk_time is not None
    assert found.jerk_time > found.time


def test_the_path_stops_where_it_turns_back() -> None:
    segments = lines([(0, 0, 0), (10, 0, 0), (9.5, 0, 0), (30, 0, 0)], speed=5.0)
    places = places_of(segments, [10.0, 10.5, 31.0], [20.0, 20.0, 20.0])
    found = free_profile(stretch_of(segments), places, FIR, has_jerk=False)
    alone = sum(
        free_profile(
            stretch_of(part),
            places_of(part, [float(part.length[0])], [20.0]),
            FIR,
            has_jerk=False,
        ).time
        for part in (segments[row : row + 1] for row in range(3))
    )
    assert found.time == pytest.approx(alone, rel=1e-6)


def test_rapids_are_left_out() -> None:
    rapid = lines([(0, 0, 0), (50, 0, 0)])
    fed = lines([(50, 0, 0), (80, 0, 0)], speed=5.0)
    both: Segments = chained([rapid, fed])
    places = places_of(both, [50.0, 80.0], [np.inf, 20.0])
    found = free_profile(stretch_of(both), places, FIR, has_jerk=False)
    assert found.time == pytest.approx(30.0 / 20.0 + 20.0 / 4000.0, rel=5e-3)
