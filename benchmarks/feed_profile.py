"""Fastest feed along a path: the sweep against toppra, HiGHS, Clarabel and OSQP, in one run.

The path is a pocket of rounded rings, cut at N stations, with caps that vary along it and
accelerations of three axes. The linear programs maximise the sum of b; the cone program
minimises the time itself. toppra knows one curvature at a station, so that where arcs begin and
end its problem lacks the limits of one side: that is its violation. Violations are the greatest
excess over any limit by :mod:`optimiser.feed_profile.certificate`. The sweep with tangential
limits is compared with a streaming read of the same numbers, the least of several runs each.
``python -m benchmarks.feed_profile --stations 1000 10000``
"""

import argparse
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass

import cvxpy as cp
import numpy as np

from benchmarks.feed_paths import AXES, pocket, wavy_caps
from benchmarks.toppra_peer import toppra_squares
from optimiser.feed_profile.certificate import certify
from optimiser.feed_profile.path_grid import path_grid, problem_on
from optimiser.feed_profile.profile import (
    AxisLimit,
    Floats,
    NamedCaps,
    ProfileProblem,
    profile_of,
    tangential_limit,
)
from optimiser.feed_profile.profile_program import (
    acceleration_limits,
    bounds,
    scale_of,
    solver_profile,
)
from optimiser.feed_profile.sweep import sweep, sweep_axes

STATIONS = (1_000, 10_000, 100_000, 1_000_000)

LARGEST = {
    "toppra": 1_000_000,
    "HiGHS LP": 10_000,
    "Clarabel LP": 100_000,
    "Clarabel SOCP": 10_000,
    "OSQP LP 1e-3": 10_000,
}
"""largest number of stations that a peer is given"""

MOST = 10_000_000
"""stations of the largest sweep with tangential limits"""

RUNS = 9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trial:
    """One path."""

    problem: ProfileProblem
    limit: AxisLimit

    def violation(self, squares: Floats) -> float:
        """Greatest relative excess over any limit."""
        caps = NamedCaps(names=("cap",), squares=self.problem.caps[None, :])
        profile = profile_of(self.problem.lengths, np.maximum(squares, 0.0))
        found = certify(self.problem, profile, caps=caps, limit=self.limit)
        # A solver's start and end at almost rest are no excess over anything but 0.
        excesses = [each for each in found.excesses if each.limit not in {"start", "end"}]
        return max(each.excess for each in excesses)


def trial(stations: int) -> Trial:
    """Pocket cut at about as many stations."""
    path = pocket()
    step = float(path.length.sum()) / stations
    grid = path_grid(path, step=step, greatest_turn=max(step / 3.0, 1e-6))
    caps = wavy_caps(np.append(0.0, np.cumsum(grid.lengths)))
    return Trial(problem=problem_on(grid, caps), limit=grid.axis_limit(AXES))


def linear_program(trial: Trial, solver: str, **options: float) -> Floats:
    """Profile of the greatest sum of b."""
    scale = scale_of(trial.problem)
    square = cp.Variable(len(trial.problem))
    rules = [
        *bounds(trial.problem, square, scale),
        *acceleration_limits(trial.problem.lengths, trial.limit, square, scale),
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # inaccurate is what is to be seen
        cp.Problem(cp.Maximize(cp.sum(square)), rules).solve(solver=solver, **options)
    return np.asarray(square.value) * scale.square


PEERS: dict[str, Callable[[Trial], Floats]] = {
    "toppra": lambda each: toppra_squares(each.problem, each.limit),
    "HiGHS LP": lambda each: linear_program(each, cp.HIGHS),
    "Clarabel LP": lambda each: linear_program(each, cp.CLARABEL),
    "Clarabel SOCP": lambda each: solver_profile(each.problem, each.limit).squares,
    "OSQP LP 1e-3": lambda each: linear_program(
        each, cp.OSQP, eps_abs=1e-3, eps_rel=1e-3, time_limit=20.0
    ),
}


def best(function: Callable[[], object]) -> float:
    """Least time of some runs, s."""
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def main(arguments: list[str] | None = None) -> None:
    """Print times, ratios and violations."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stations", type=int, nargs="+", default=STATIONS)
    options = parser.parse_args(arguments)
    print(
        f"{'stations':>9} {'method':16}{'ms':>12}{'ratio':>10}{'time s':>14}{'violation':>11}"
    )
    for stations in options.stations:
        _peers(trial(stations))
    for stations in (*options.stations, MOST):
        _streaming(stations)


def _peers(each: Trial) -> None:
    """Print the sweep and its peers on one path."""
    count = len(each.problem)
    profile = sweep_axes(each.problem, each.limit)
    own = best(lambda: sweep_axes(each.problem, each.limit))
    _row(count, "sweep", own, own, profile.time, each.violation(profile.squares))
    for name, solve in PEERS.items():
        if count > 1.2 * LARGEST[name]:
            continue
        start = time.perf_counter()
        squares = solve(each)
        seconds = time.perf_counter() - start
        taken = profile_of(each.problem.lengths, np.maximum(squares, 1e-9)).time
        _row(count, name, seconds, own, taken, each.violation(squares))
    print(f"{count:9} the sweep takes {own / count * 1e9:.0f} ns a station")


def _row(
    count: int, name: str, seconds: float, own: float, taken: float, violation: float
) -> None:
    """Print one method."""
    print(
        f"{count:9} {name:16}{seconds * 1e3:12.3f}{seconds / own:10.0f}"
        f"{taken:14.6f}{violation:11.1e}"
    )


def _streaming(stations: int) -> None:
    """Print the sweep with tangential limits beside a streaming read of its data."""
    random = np.random.default_rng(0)
    lengths = random.uniform(0.05, 0.15, stations - 1)
    problem = ProfileProblem(
        lengths=lengths, caps=wavy_caps(np.append(0.0, np.cumsum(lengths)))
    )
    limit = tangential_limit(500.0)
    read = best(lambda: (problem.lengths.sum(), problem.caps.sum()))
    own = best(lambda: sweep(problem, limit))
    print(
        f"{stations:9} tangential sweep {own * 1e3:9.3f} ms, {own / stations * 1e9:.1f} ns a "
        f"station, {own / read:.1f} times a streaming read"
    )


if __name__ == "__main__":
    main()
