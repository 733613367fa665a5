"""Free profile: the exact optimum within caps and accelerations, with its certificate."""

import numpy as np
import pytest

from optimiser.along_path.free_profile import FreeTask, free_profile
from simulator.motion.segments import Segments, chained, lines
from tests.optimiser.along_path.stretches import FIR, LIMITS, places_of, straight, stretch_of


def test_a_line_is_run_as_a_trapezoid() -> None:
    segments = straight([100.0])
    found = free_profile(
        stretch_of(segments), places_of(segments, [100.0], [40.0]), FIR, FreeTask()
    )
    acceleration = float(LIMITS.acceleration[0])
    assert found.time == pytest.approx(100.0 / 40.0 + 40.0 / acceleration, rel=1e-6)
    assert found.bound <= found.time
    assert found.worst is not None
    assert found.worst.excess <= 1e-9


def test_limited_jerk_takes_longer() -> None:
    segments = straight([30.0])
    found = free_profile(
        stretch_of(segments), places_of(segments, [30.0], [40.0]), FIR, FreeTask(has_jerk=True)
    )
    assert found.jerk_time is not None
    assert found.jerk_time > found.time


def test_the_smoothest_profile_keeps_its_budget_and_is_smoother() -> None:
    segments = straight([60.0])
    places = places_of(segments, [20.0, 40.0, 60.0], [60.0, 20.0, 60.0])
    found = [
        free_profile(stretch_of(segments), places, FIR, FreeTask(smooth_share=share)).smoothest
        for share in (0.02, 0.2)
    ]
    little, much = found
    assert little is not None
    assert much is not None
    for smooth, share in ((little, 0.02), (much, 0.2)):
        assert smooth.fastest_time < smooth.time <= (1.0 + share) * smooth.fastest_time
        assert smooth.fastest_unevenness == little.fastest_unevenness
    assert much.ratio < little.ratio < 1.0
    both = little.plus(much)
    assert both.time == little.time + much.time
    assert little.ratio > both.ratio > much.ratio


def test_a_run_of_too_many_places_keeps_its_fastest_profile() -> None:
    segments = straight([0.02] * 20_001)
    places = places_of(segments, np.cumsum(segments.length).tolist(), [20.0] * 20_001)
    task = FreeTask(smooth_share=0.1)
    found = free_profile(stretch_of(segments), places, FIR, task).smoothest
    assert found is not None
    assert found.time == found.fastest_time
    assert found.ratio == 1.0


def test_the_path_stops_where_it_turns_back() -> None:
    segments = lines([(0, 0, 0), (10, 0, 0), (9.5, 0, 0), (30, 0, 0)], speed=5.0)
    places = places_of(segments, [10.0, 10.5, 31.0], [20.0, 20.0, 20.0])
    found = free_profile(stretch_of(segments), places, FIR, FreeTask())
    alone = sum(
        free_profile(
            stretch_of(part),
            places_of(part, [float(part.length[0])], [20.0]),
            FIR,
            FreeTask(),
        ).time
        for part in (segments[row : row + 1] for row in range(3))
    )
    assert found.time == pytest.approx(alone, rel=1e-6)


def test_rapids_are_left_out() -> None:
    rapid = lines([(0, 0, 0), (50, 0, 0)])
    fed = lines([(50, 0, 0), (80, 0, 0)], speed=5.0)
    both: Segments = chained([rapid, fed])
    places = places_of(both, [50.0, 80.0], [np.inf, 20.0])
    found = free_profile(stretch_of(both), places, FIR, FreeTask())
    assert found.time == pytest.approx(30.0 / 20.0 + 20.0 / 4000.0, rel=5e-3)
