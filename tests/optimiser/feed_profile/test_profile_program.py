"""The general solvers as judges of the sweep, and what only they can do."""

import numpy as np
import pytest

from benchmarks.feed_paths import PATHS
from optimiser.errors import Infeasible, SolverFailed
from optimiser.feed_profile import profile_program
from optimiser.feed_profile.certificate import certify
from optimiser.feed_profile.profile import ProfileProblem, interval_times, tangential_limit
from optimiser.feed_profile.profile_program import (
    fastest,
    second_differences,
    smoothest_profile,
    solver_profile,
    time_slope,
    unevenness,
)
from tests.optimiser.profiles import trial

GAP = 1.1e-4
"""Largest gap of the sweep where curvature jumps, at 0.1 mm."""


@pytest.mark.parametrize("name", PATHS)
def test_the_sweep_of_the_axes_is_optimal(name: str) -> None:
    problem, limit, _ = trial(name)
    judged = solver_profile(problem, limit)
    assert -1e-6 < fastest(problem, limit).time / judged.time - 1.0 < GAP


@pytest.mark.parametrize("name", ["raster", "random"])
def test_the_tangential_sweep_is_optimal(name: str) -> None:
    problem, _, _ = trial(name)
    limit = tangential_limit(400.0)
    judged = solver_profile(problem, limit)
    assert fastest(problem, limit).time == pytest.approx(judged.time, rel=2e-6)
    assert fastest(problem, limit).squares == pytest.approx(judged.squares, rel=1e-2, abs=1.0)


def test_a_path_with_a_stop_is_judged() -> None:
    problem, limit, _ = trial("helix", step=1.0)
    caps = problem.caps.copy()
    caps[100] = 0.0
    stopped = ProfileProblem(lengths=problem.lengths, caps=caps, stops=np.array([100]))
    judged = solver_profile(stopped, limit)
    assert fastest(stopped, limit).time == pytest.approx(judged.time, rel=1e-5)


@pytest.mark.parametrize("share", [1.02, 1.2])
def test_the_smoothest_profile_keeps_budget_and_limits(share: float) -> None:
    problem, limit, caps = trial("random")
    budget = share * fastest(problem, limit).time
    found = smoothest_profile(problem, limit, budget=budget)
    assert found.profile.time <= budget * (1.0 + 1e-12)
    assert found.unevenness < 0.2 * found.fastest_unevenness
    assert found.unevenness == unevenness(problem.lengths, found.profile.squares)
    assert certify(problem, found.profile, caps=caps, limit=limit).worst.excess <= 1e-12


def test_more_time_makes_a_smoother_profile() -> None:
    problem, limit, _ = trial("random", step=1.0)
    time = fastest(problem, limit).time
    found = [
        smoothest_profile(problem, limit, budget=share * time).unevenness
        for share in (1.0, 1.03, 1.1, 1.3)
    ]
    assert found == sorted(found, reverse=True)


def test_a_budget_below_the_fastest_is_infeasible() -> None:
    problem, limit, _ = trial("random", step=1.0)
    with pytest.raises(Infeasible, match=r"the fastest profile takes .* more than the budget"):
        smoothest_profile(problem, limit, budget=1.0)


def test_the_slope_of_the_time_is_its_derivative() -> None:
    random = np.random.default_rng(0)
    lengths, squares = random.uniform(0.5, 2.0, 6), random.uniform(1.0, 9.0, 7)
    slope = time_slope(lengths, squares)
    for station in range(7):
        moved = squares.copy()
        moved[station] += 1e-6
        change = interval_times(lengths, moved).sum() - interval_times(lengths, squares).sum()
        assert slope[station] == pytest.approx(change / 1e-6, rel=1e-4)


def test_second_differences_of_a_parabola() -> None:
    lengths = np.array([0.5, 1.5, 1.0, 0.25])
    station = np.append(0.0, np.cumsum(lengths))
    assert second_differences(lengths) @ (3.0 * station**2) == pytest.approx([6.0] * 3)


def test_too_many_stations_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, limit, _ = trial("random", step=1.0)
    monkeypatch.setattr(profile_program, "MOST_STATIONS", 100)
    with pytest.raises(ValueError, match="stations: a solver takes at most 100"):
        solver_profile(problem, limit)


def test_what_no_profile_keeps_fails() -> None:
    """Entered at 20 mm/s with 5 mm to stop: the sweep says why, the solver that it is so."""
    problem = ProfileProblem(lengths=np.ones(5), caps=np.full(6, 400.0), start=400.0)
    with pytest.raises(SolverFailed, match="feed profile has no solution: infeasible"):
        solver_profile(problem, tangential_limit(20.0))
