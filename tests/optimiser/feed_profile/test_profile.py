"""What is no problem of a feed profile is refused with place, value and bound."""

from dataclasses import replace

import numpy as np
import pytest

from optimiser.errors import Infeasible
from optimiser.feed_profile.profile import (
    AxisLimit,
    ProfileProblem,
    interval_times,
    smooth_limit,
    tangential_limit,
)
from optimiser.feed_profile.sweep import sweep
from tests.every_case import every_case


def line() -> tuple[ProfileProblem, AxisLimit]:
    """Two millimetres along X."""
    limit = smooth_limit(
        np.full(3, 100.0),
        tangent=np.tile([1.0, 0.0, 0.0], (3, 1)),
        curvature=np.zeros((3, 3)),
    )
    return ProfileProblem(lengths=np.ones(2), caps=np.full(3, 100.0)), limit


@every_case(
    ("lengths", "caps", "message"),
    [
        ([1.0, 0.0], [1.0, 1.0, 1.0], "interval 1: length 0 mm must be positive and finite"),
        ([-1.0, 1.0], [1.0, 1.0, 1.0], "interval 0: length -1 mm"),
        ([1.0, np.nan], [1.0, 1.0, 1.0], "interval 1: length nan mm"),
        ([1.0, 1.0], [1.0, 1.0, -2.0], "station 2: cap -2 mm²/s² must not be negative"),
        ([1.0, 1.0], [1.0, np.nan, 1.0], "station 1: cap nan"),
        ([1.0, 1.0], [1.0, np.inf, 1.0], "station 1: cap inf"),
        ([1.0], [1.0, 1.0, 1.0], "lengths must have shape"),
        ([1.0], [1.0, 1.0], "both at rest"),
    ],
)
def test_what_is_no_path_is_refused(
    lengths: list[float], caps: list[float], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        ProfileProblem(lengths=np.array(lengths), caps=np.array(caps))


def test_a_cap_of_zero_without_stop_is_infeasible() -> None:
    caps = np.array([100.0, 100.0, 0.0, 100.0, 100.0])
    message = r"station 2 \(1 mm\): a cap of 0 mm/s forbids motion"
    with pytest.raises(Infeasible, match=message) as caught:
        ProfileProblem(lengths=np.full(4, 0.5), caps=caps)
    assert caught.value.station == 2
    assert caught.value.limits == ("cap",)


def test_limits_that_are_none_are_refused() -> None:
    problem, limit = line()
    with pytest.raises(ValueError, match="accelerating in interval 0: -1 mm/s² must be posit"):
        tangential_limit(-1.0)
    bad = limit.start_curvature.copy()
    bad[1, 1] = np.nan
    with pytest.raises(ValueError, match=r"interval 1: start_curvature .* must be finite"):
        replace(limit, start_curvature=bad)
    with pytest.raises(ValueError, match="axis 2: acceleration 0 mm/s² must be positive"):
        replace(limit, acceleration=np.array([1.0, 1.0, 0.0]))
    with pytest.raises(ValueError, match="end of -1 mm²/s² must not be negative"):
        replace(problem, end=-1.0)
    with pytest.raises(ValueError, match="stops must lie between station 0 and 2"):
        replace(problem, stops=np.array([3]))
    with pytest.raises(ValueError, match=r"end_tangent must have shape \(2, 3\), got \(1, 3\)"):
        replace(limit, end_tangent=np.ones((1, 3)))
    with pytest.raises(ValueError, match=r"acceleration of the axes must have shape \(3,\)"):
        replace(limit, acceleration=np.ones(2))


def test_time_is_the_sum_of_the_intervals() -> None:
    random = np.random.default_rng(1)
    lengths, caps = random.uniform(0.1, 1.0, 5000), random.uniform(1.0, 900.0, 5001)
    profile = sweep(ProfileProblem(lengths=lengths, caps=caps), tangential_limit(90.0))
    times = interval_times(lengths, profile.squares)
    assert profile.time == pytest.approx(float(times.sum()), rel=1e-13)
    assert profile.feeds**2 == pytest.approx(profile.squares)


def test_bounds_hold_the_ends() -> None:
    problem = ProfileProblem(lengths=np.ones(2), caps=np.full(3, 9.0), start=4.0, end=16.0)
    assert problem.bounds().tolist() == [4.0, 9.0, 9.0]
    assert problem.stations.tolist() == [0.0, 1.0, 2.0]
