"""The certificate tells what holds of a profile, whoever made it."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.feed_paths import PATHS
from optimiser.feed_profile.certificate import JERK, NO_LIMIT, ProfileCertificate, certify
from optimiser.feed_profile.profile import (
    NamedCaps,
    PathProfile,
    ProfileProblem,
    tangential_limit,
)
from optimiser.feed_profile.sweep import sweep, sweep_axes
from tests.every_case import every_case
from tests.optimiser.profiles import trial


def excess_of(certificate: ProfileCertificate, limit: str) -> float:
    (found,) = [each for each in certificate.excesses if each.limit == limit]
    return found.excess


@pytest.mark.parametrize("name", PATHS)
def test_the_sweep_keeps_every_limit_and_some_limit_is_active_nearly_everywhere(
    name: str,
) -> None:
    problem, limit, caps = trial(name)
    profile = sweep_axes(problem, limit)
    found = certify(problem, profile, caps=caps, limit=limit)
    assert found.worst.excess <= 1e-12
    assert found.time == pytest.approx(profile.time, rel=1e-12)
    assert found.bound <= found.time
    assert 0.0 < found.gap < 0.1
    assert sum(each.length for each in found.shares) == pytest.approx(1.0)
    assert sum(each.time for each in found.shares) == pytest.approx(1.0)
    free = [each.time for each in found.shares if each.limit == NO_LIMIT]
    assert sum(free) < 0.03


def test_shares_of_a_trapezoid() -> None:
    """100 mm at 10 mm/s with 10 mm/s²: 5 mm and 1 s at either end."""
    lengths, caps = np.full(200, 0.5), np.full(201, 100.0)
    problem = ProfileProblem(lengths=lengths, caps=caps)
    limit = tangential_limit(10.0)
    named = NamedCaps(names=("force", "power"), squares=np.stack((caps, 2.0 * caps)))
    found = certify(problem, sweep(problem, limit), caps=named, limit=limit)
    assert found.time == pytest.approx(11.0)
    by_name = {each.limit: each for each in found.shares}
    assert set(by_name) == {"force", "accelerating", "braking"}
    assert by_name["force"].length == pytest.approx(0.9, abs=0.006)
    assert by_name["braking"].length == pytest.approx(0.05, abs=0.006)
    assert by_name["braking"].time == pytest.approx(1 / 11, abs=0.006)
    assert found.shares[0].limit == "force"


def test_the_bound_is_the_time_of_the_caps() -> None:
    lengths, caps = np.ones(4), np.array([4.0, 4.0, 16.0, 4.0, 4.0])
    problem = ProfileProblem(lengths=lengths, caps=caps, start=4.0, end=4.0)
    limit = tangential_limit(1.0)
    named = NamedCaps(names=("cap",), squares=caps[None, :])
    found = certify(problem, sweep(problem, limit), caps=named, limit=limit)
    assert found.bound == pytest.approx(0.5 + 1 / 3 + 1 / 3 + 0.5)


@every_case(
    ("scale", "limit_name", "excess"),
    [(1.21, "cap", 0.21), (1.21, "accelerating", 0.21), (1.21, "least cap", 0.21)],
)
def test_an_excess_is_told_with_its_limit(scale: float, limit_name: str, excess: float) -> None:
    lengths, caps = np.ones(10), np.full(11, 16.0)
    problem = ProfileProblem(lengths=lengths, caps=caps)
    limit = tangential_limit(4.0)
    fast = PathProfile(squares=scale * sweep(problem, limit).squares, time=1.0)
    named = NamedCaps(names=("cap",), squares=caps[None, :])
    found = certify(problem, fast, caps=named, limit=limit)
    assert excess_of(found, limit_name) == pytest.approx(excess)
    assert found.worst.excess == pytest.approx(excess)


@pytest.mark.parametrize("axis", range(3))
def test_the_excess_of_an_axis_is_that_of_its_lowered_limit(axis: int) -> None:
    problem, limit, caps = trial("helix")
    profile = sweep_axes(problem, limit)
    before = certify(problem, profile, caps=caps, limit=limit)
    lower = limit.acceleration.copy()
    lower[axis] *= 0.5
    after = certify(problem, profile, caps=caps, limit=replace(limit, acceleration=lower))
    name = f"{'XYZ'[axis]} acceleration"
    assert excess_of(after, name) == pytest.approx(2.0 * excess_of(before, name) + 1.0)


def test_a_start_too_fast_and_a_missing_stop_are_told() -> None:
    caps = np.array([9.0, 9.0, 0.0, 9.0, 9.0])
    problem = ProfileProblem(lengths=np.ones(4), caps=caps, stops=np.array([2]))
    named = NamedCaps(names=("cap",), squares=np.full((1, 5), 9.0))
    still = PathProfile(squares=np.array([1.0, 4.0, 1.0, 4.0, 0.0]), time=1.0)
    found = certify(problem, still, caps=named, limit=tangential_limit(4.0))
    assert excess_of(found, "start") == np.inf
    assert excess_of(found, "end") == -1.0
    assert excess_of(found, "least cap") == np.inf
    (cap,) = [each for each in found.excesses if each.limit == "least cap"]
    assert cap.station == 2


def test_jerk_of_a_parabola() -> None:
    """b = 1 + s²: b'' = 2, so that the jerk is √b."""
    station = np.linspace(0.0, 2.0, 41)
    squares = 1.0 + station**2
    problem = ProfileProblem(
        lengths=np.diff(station), caps=np.full(41, 9.0), start=1.0, end=5.0
    )
    named = NamedCaps(names=("cap",), squares=np.full((1, 41), 9.0))
    profile = PathProfile(squares=squares, time=1.0)
    limit = tangential_limit(10.0)
    found = certify(problem, profile, caps=named, limit=limit, jerk=2.0)
    assert excess_of(found, JERK) == pytest.approx(squares[-2] ** 0.5 / 2.0 - 1.0)


def test_jerk_from_rest_is_that_of_the_cubic() -> None:
    """After 1 s with 6 mm/s³ from rest: 1 mm and 3 mm/s."""
    squares = np.array([0.0, 9.0, 9.0, 9.0, 0.0])
    problem = ProfileProblem(lengths=np.ones(4), caps=np.full(5, 9.0))
    named = NamedCaps(names=("cap",), squares=np.full((1, 5), 9.0))
    profile = PathProfile(squares=squares, time=1.0)
    limit = tangential_limit(10.0)
    alone = ProfileProblem(lengths=np.ones(2), caps=np.full(3, 9.0))
    start = PathProfile(squares=np.array([0.0, 9.0, 0.0]), time=1.0)
    found = certify(problem, profile, caps=named, limit=limit, jerk=6.0)
    assert excess_of(found, JERK) == pytest.approx(9.0 * 3.0 / 2.0 / 6.0 - 1.0)
    slow = PathProfile(squares=start.squares * 1e-6, time=1.0)
    narrow = NamedCaps(names=("cap",), squares=np.full((1, 3), 9.0))
    crept = certify(alone, slow, caps=narrow, limit=limit, jerk=6e-9)
    assert excess_of(crept, JERK) == pytest.approx(18.0 * 3.0 / 2.0 / 6.0 - 1.0)


def test_what_does_not_fit_is_refused() -> None:
    problem, limit, caps = trial("random")
    short = PathProfile(squares=np.ones(3), time=1.0)
    with pytest.raises(ValueError, match=r"profile \(3,\) and caps .* do not fit"):
        certify(problem, short, caps=caps, limit=limit)
    with pytest.raises(ValueError, match="each name needs a row of caps: 1 names"):
        NamedCaps(names=("one",), squares=np.ones((2, 5)))


def test_named_caps_know_the_least_and_whose_it_is() -> None:
    caps = NamedCaps(names=("a", "b"), squares=np.array([[1.0, 5.0], [2.0, np.inf]]))
    assert caps.least.tolist() == [1.0, 5.0]
    assert caps.which.tolist() == [0, 0]
