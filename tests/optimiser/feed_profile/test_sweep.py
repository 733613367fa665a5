"""The fastest profile within caps and accelerations."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from optimiser.errors import Infeasible
from optimiser.feed_profile.profile import (
    AxisLimit,
    PathProfile,
    ProfileProblem,
    TangentialLimit,
    smooth_limit,
    tangential_limit,
)
from optimiser.feed_profile.sweep import sweep, sweep_axes

TOLERANCE = 1e-12


def wavy(seed: int, *, count: int = 300) -> tuple[ProfileProblem, AxisLimit]:
    """A smooth curve in space with random caps and spacing."""
    random = np.random.default_rng(seed)
    lengths = 0.1 * random.uniform(0.5, 1.5, count - 1)
    caps = (50.0 + 40.0 * np.sin(np.arange(count) / 30) + random.uniform(0, 10, count)) ** 2
    problem = ProfileProblem(lengths=lengths, caps=caps)
    station, rise = problem.stations, random.uniform(0.0, 0.6)
    turn = station / 7 + 0.3 * np.sin(station / 5)
    rate = 1 / 7 + 0.06 * np.cos(station / 5)
    level = np.cos(rise)
    zero = np.zeros(count)
    tangent = np.stack((level * np.cos(turn), level * np.sin(turn), zero + np.sin(rise)), 1)
    curvature = np.stack(
        (-level * np.sin(turn) * rate, level * np.cos(turn) * rate, zero), axis=1
    )
    axes = np.array([500.0, 700.0, 300.0])
    return problem, smooth_limit(axes, tangent=tangent, curvature=curvature)


def reversed_(problem: ProfileProblem, limit: AxisLimit) -> tuple[ProfileProblem, AxisLimit]:
    """The same path from its end to its start."""
    return (
        ProfileProblem(lengths=problem.lengths[::-1].copy(), caps=problem.caps[::-1].copy()),
        AxisLimit(
            acceleration=limit.acceleration,
            start_tangent=-limit.end_tangent[::-1],
            end_tangent=-limit.start_tangent[::-1],
            start_curvature=limit.end_curvature[::-1],
            end_curvature=limit.start_curvature[::-1],
        ),
    )


def axis_excess(problem: ProfileProblem, limit: AxisLimit, profile: PathProfile) -> float:
    """Greatest acceleration of an axis at any end of an interval, over its limit."""
    squares = profile.squares
    along = (np.diff(squares) / (2.0 * problem.lengths))[:, None]
    before = limit.start_tangent * along + limit.start_curvature * squares[:-1, None]
    after = limit.end_tangent * along + limit.end_curvature * squares[1:, None]
    return float((np.maximum(abs(before), abs(after)) / limit.acceleration).max())


@st.composite
def tangential(draw: st.DrawFn) -> tuple[ProfileProblem, TangentialLimit]:
    count = draw(st.integers(3, 40))
    seed = draw(st.integers(0, 10_000))
    random = np.random.default_rng(seed)
    problem = ProfileProblem(
        lengths=random.uniform(0.01, 2.0, count - 1),
        caps=random.uniform(0.1, 60.0, count) ** 2,
        end=draw(st.sampled_from((0.0, 100.0))),
    )
    limit = TangentialLimit(
        accelerating=random.uniform(10.0, 900.0, count - 1),
        braking=random.uniform(10.0, 900.0, draw(st.sampled_from((1, count - 1)))),
    )
    return problem, limit


@given(case=tangential())
@settings(max_examples=40, deadline=None)
def test_tangential_sweep_is_the_greatest_feasible_profile(
    case: tuple[ProfileProblem, TangentialLimit],
) -> None:
    """The sum of b is greatest in a linear program of the same limits."""
    problem, limit = case
    squares = sweep(problem, limit).squares
    size = len(problem)
    step = np.diff(np.eye(size), axis=0)
    most = [2.0 * each * problem.lengths for each in (limit.accelerating, limit.braking)]
    bounds = problem.bounds()
    solved = linprog(
        -np.ones(size),
        A_ub=np.vstack((step, -step)),
        b_ub=np.concatenate([np.broadcast_to(each, size - 1) for each in most]),
        bounds=[(0.0, each) for each in bounds],
        method="highs",
    )
    assert squares == pytest.approx(solved.x, rel=1e-6, abs=1e-6)
    assert (squares <= bounds).all()
    rise = np.diff(squares)
    assert (rise <= most[0] * (1.0 + TOLERANCE) + TOLERANCE).all()
    assert (-rise <= most[1] * (1.0 + TOLERANCE) + TOLERANCE).all()


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 8, 9, 50, 403])
def test_quarters_of_a_path_join_without_a_trace(count: int) -> None:
    """The same as station after station, to the last bit; low ends reach across quarters."""
    random = np.random.default_rng(count)
    lengths, caps = random.uniform(0.1, 1.0, count - 1), random.uniform(50.0, 900.0, count)
    caps[random.integers(count)] = 1.0
    squares = caps.copy()
    squares[[0, -1]] = 0.0
    for row in range(count - 2, -1, -1):
        squares[row] = min(squares[row], squares[row + 1] + 2.0 * 2.0 * lengths[row])
    for row in range(count - 1):
        squares[row + 1] = min(squares[row + 1], squares[row] + 2.0 * 3.0 * lengths[row])
    limit = TangentialLimit(accelerating=np.array([3.0]), braking=np.array([2.0]))
    found = sweep(ProfileProblem(lengths=lengths, caps=caps), limit)
    assert found.squares.tolist() == squares.tolist()


@pytest.mark.parametrize("seed", range(4))
def test_profile_of_the_axes_equals_toppra(seed: int) -> None:
    from benchmarks.toppra_peer import toppra_time  # noqa: PLC0415 (loads pyplot)

    problem, limit = wavy(seed)
    assert sweep_axes(problem, limit).time == pytest.approx(
        toppra_time(problem, limit), rel=1e-9
    )


@pytest.mark.parametrize("seed", range(4))
def test_profile_of_the_axes_keeps_every_limit(seed: int) -> None:
    problem, limit = wavy(seed)
    profile = sweep_axes(problem, limit)
    assert (profile.squares <= problem.bounds()).all()
    assert axis_excess(problem, limit, profile) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_reversed_path_takes_the_same_time(seed: int) -> None:
    problem, limit = wavy(seed)
    there, back = sweep_axes(problem, limit), sweep_axes(*reversed_(problem, limit))
    assert back.time == pytest.approx(there.time, rel=1e-4)
    forward = sweep(problem, tangential_limit(300.0))
    backward = sweep(reversed_(problem, limit)[0], tangential_limit(300.0))
    assert backward.squares[::-1] == pytest.approx(forward.squares, rel=1e-12)


@given(seed=st.integers(0, 1000), factor=st.floats(1.0, 3.0), axis=st.integers(0, 2))
@settings(max_examples=25, deadline=None)
def test_a_higher_limit_never_costs_time(seed: int, factor: float, axis: int) -> None:
    problem, limit = wavy(seed, count=80)
    time = sweep_axes(problem, limit).time
    axes = limit.acceleration.copy()
    axes[axis] *= factor
    assert sweep_axes(problem, replace(limit, acceleration=axes)).time <= time * (1 + 1e-6)
    caps = problem.caps.copy()
    caps[10:50] *= factor
    higher = replace(problem, caps=caps)
    slow = sweep(problem, tangential_limit(300.0)).squares
    assert (sweep(higher, tangential_limit(300.0)).squares >= slow).all()
    assert (sweep(problem, tangential_limit(300.0 * factor)).squares >= slow).all()
    assert sweep_axes(higher, limit).time <= time * (1 + 1e-6)


@pytest.mark.parametrize("finer", [2, 5])
def test_a_finer_cut_of_a_line_takes_the_same_time(finer: int) -> None:
    """Caps are constant on the line; the profile is then exact at any spacing."""
    times = []
    for parts in (40, 40 * finer):
        problem = ProfileProblem(
            lengths=np.full(parts, 40.0 / parts), caps=np.full(parts + 1, 30.0**2)
        )
        times.append(sweep(problem, tangential_limit(450.0)).time)
    assert times[1] == pytest.approx(times[0], rel=1e-12)
    assert times[0] == pytest.approx(2 * 30.0 / 450.0 + (40.0 - 30.0**2 / 450.0) / 30.0)


def test_an_axis_without_movement_is_limited_by_curvature_only() -> None:
    """At the top of a circle the axis across feels ``b/r`` alone: b = A·r."""
    problem = ProfileProblem(lengths=np.ones(2), caps=np.full(3, 1e6), start=300.0, end=1e6)
    tangent = np.tile([1.0, 0.0, 0.0], (3, 1))
    curvature = np.tile([0.0, -0.1, 0.0], (3, 1))
    axes = np.array([1e9, 50.0, 1.0])
    profile = sweep_axes(problem, smooth_limit(axes, tangent=tangent, curvature=curvature))
    assert profile.squares == pytest.approx([300.0, 500.0, 500.0])


def test_both_curvatures_hold_where_the_curvature_jumps() -> None:
    problem = ProfileProblem(lengths=np.ones(2), caps=np.full(3, 1e6), start=1.0, end=1e6)
    tangent = np.tile([1.0, 0.0, 0.0], (2, 1))
    line, bend = np.zeros(3), np.array([0.0, 0.1, 0.0])
    limit = AxisLimit(
        acceleration=np.array([1e9, 50.0, 1.0]),
        start_tangent=tangent,
        end_tangent=tangent,
        start_curvature=np.array([line, bend]),
        end_curvature=np.array([line, bend]),
    )
    assert sweep_axes(problem, limit).squares[1] == pytest.approx(500.0)


def test_the_path_stops_where_it_may() -> None:
    caps = np.array([100.0, 100.0, 0.0, 100.0, 100.0])
    problem = ProfileProblem(lengths=np.ones(4), caps=caps, stops=np.array([2]))
    profile = sweep(problem, tangential_limit(20.0))
    assert profile.squares.tolist() == [0.0, 40.0, 0.0, 40.0, 0.0]
    assert profile.time == pytest.approx(8.0 / 40.0**0.5)


def test_an_entry_too_fast_to_brake_is_infeasible() -> None:
    """From 20 mm/s one needs 10 mm at 20 mm/s²; there are 5 mm."""
    problem = ProfileProblem(lengths=np.ones(5), caps=np.full(6, 400.0), start=400.0)
    message = r"entered at 20 mm/s, 5.86 mm/s above the 14.1421 mm/s that the braking permits"
    with pytest.raises(Infeasible, match=message):
        sweep(problem, tangential_limit(20.0))
    tangent = np.tile([1.0, 0.0, 0.0], (6, 1))
    limit = smooth_limit(np.full(3, 20.0), tangent=tangent, curvature=np.zeros((6, 3)))
    with pytest.raises(Infeasible, match="that the acceleration of the axes permits"):
        sweep_axes(problem, limit)
    with pytest.raises(Infeasible, match="that the cap permits"):
        ProfileProblem(lengths=np.ones(2), caps=np.full(3, 100.0), start=121.0)


def test_limits_of_another_path_are_refused() -> None:
    problem, limit = wavy(0)
    with pytest.raises(ValueError, match="must have shape"):
        sweep(problem, TangentialLimit(accelerating=np.ones(7), braking=np.ones(1)))
    short = ProfileProblem(lengths=problem.lengths[:-1], caps=problem.caps[:-1])
    with pytest.raises(ValueError, match="299 intervals of the axes do not fit 298"):
        sweep_axes(short, limit)
