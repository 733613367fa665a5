"""Profiles with a limit on the jerk along the path."""

import numpy as np
import pytest

from optimiser.feed_profile import jerk_program
from optimiser.feed_profile.certificate import JERK, certify
from optimiser.feed_profile.jerk_program import jerk_limited_profile
from optimiser.feed_profile.profile import (
    NamedCaps,
    ProfileProblem,
    TangentialLimit,
    tangential_limit,
)
from optimiser.feed_profile.profile_program import fastest
from tests.optimiser.profiles import trial


@pytest.mark.parametrize("name", ["raster", "helix", "random"])
@pytest.mark.parametrize("jerk", [3e3, 5e4])
def test_every_limit_is_kept_and_time_lies_near_the_fastest(name: str, jerk: float) -> None:
    problem, limit, caps = trial(name, step=1.0)
    profile = jerk_limited_profile(problem, limit, jerk=jerk)
    found = certify(problem, profile, caps=caps, limit=limit, jerk=jerk)
    assert found.worst.excess <= 1e-9
    assert found.time == pytest.approx(profile.time, rel=1e-12)
    assert fastest(problem, limit).time <= profile.time
    assert profile.time <= (1.25 if jerk < 1e4 else 1.02) * fastest(problem, limit).time
    assert JERK in {each.limit for each in found.shares}


def test_more_jerk_costs_no_time_and_much_jerk_is_no_limit() -> None:
    problem, limit, _ = trial("random", step=1.0)
    times = [
        jerk_limited_profile(problem, limit, jerk=each).time for each in (2e3, 2e4, 2e5, 1e9)
    ]
    assert (np.diff(times) <= 1e-6 * times[-1]).all()
    assert times[-1] == pytest.approx(fastest(problem, limit).time, rel=2e-6)


def test_a_line_from_rest_to_rest_takes_the_time_of_its_closed_form() -> None:
    """Four equal phases of constant jerk alone take ``(32·L/J)^(1/3)`` for a length L."""
    length, jerk, count = 40.0, 1000.0, 800
    problem = ProfileProblem(
        lengths=np.full(count, length / count), caps=np.full(count + 1, 1e4)
    )
    profile = jerk_limited_profile(problem, tangential_limit(1e5), jerk=jerk)
    assert profile.time == pytest.approx((32.0 * length / jerk) ** (1 / 3), rel=7e-3)


def test_windows_give_nearly_the_profile_of_one_program(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem, limit, caps = trial("random", step=0.5)
    whole = jerk_limited_profile(problem, limit, jerk=5e3)
    monkeypatch.setattr(jerk_program, "WINDOW", 120)
    monkeypatch.setattr(jerk_program, "KEPT", 60)
    parts = jerk_limited_profile(problem, limit, jerk=5e3)
    assert parts.time == pytest.approx(whole.time, rel=2e-3)
    found = certify(problem, parts, caps=caps, limit=limit, jerk=5e3)
    assert found.worst.excess <= 1e-9


def test_a_stop_on_the_way_is_a_stop_of_the_jerk() -> None:
    caps = np.full(101, 400.0)
    caps[50] = 0.0
    problem = ProfileProblem(lengths=np.full(100, 0.5), caps=caps, stops=np.array([50]))
    limit = TangentialLimit(accelerating=np.full(100, 300.0), braking=np.full(1, 200.0))
    profile = jerk_limited_profile(problem, limit, jerk=2e3)
    named = NamedCaps(names=("cap",), squares=caps[None, :])
    assert certify(problem, profile, caps=named, limit=limit, jerk=2e3).worst.excess <= 1e-9
    assert profile.squares[50] == 0.0


def test_what_the_programs_cannot_plan_is_refused() -> None:
    problem, limit, _ = trial("random", step=1.0)
    with pytest.raises(ValueError, match="jerk of 0 mm/s³ must be positive"):
        jerk_limited_profile(problem, limit, jerk=0.0)
    moving = ProfileProblem(lengths=problem.lengths, caps=problem.caps, start=1.0)
    with pytest.raises(ValueError, match="must begin and end at rest"):
        jerk_limited_profile(moving, limit, jerk=1e3)
