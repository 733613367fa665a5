"""Feed profiles by general convex solvers: the judge of the sweep, and the smoothest profile.

The fastest profile is a second-order cone program, [1]_ section IV: with ``c ≤ √b`` the time
``Σ 2·Δs·d``, ``d ≥ 1 / (cᵢ + cᵢ₊₁)``, is convex in b, and every limit is linear in b. Clarabel,
an interior-point solver, finds its optimum within about 1e-7. It takes thousands of times as
long as :mod:`optimiser.feed_profile.sweep` and judges it in tests and benchmarks.

The smoothest profile within a time budget has the least sum of squared changes of the
acceleration per length, a quadratic program. The time is convex in b, so that tangents to it
are cuts which never exclude a profile within the budget; each round adds one. OSQP, a
first-order solver, stops at a rough answer, so its answer is only a cap for one more sweep, and
the result is a mean of that profile and the fastest one, which keeps all limits and the budget
exactly. Units mm, s.

References
----------
.. [1] D. Verscheure et al., "Time-optimal path tracking for robots: a convex optimization
   approach", IEEE Trans. Autom. Control 54 (2009) 2318-2327, doi:10.1109/TAC.2009.2028959.
"""

import warnings
from dataclasses import dataclass, replace

import cvxpy as cp
import numpy as np
from scipy import sparse

from optimiser.errors import Infeasible, SolverFailed
from optimiser.feed_profile.profile import (
    AxisLimit,
    Floats,
    PathProfile,
    ProfileProblem,
    TangentialLimit,
    interval_times,
    profile_of,
)
from optimiser.feed_profile.sweep import sweep, sweep_axes

ROUNDS = 4
"""Number of quadratic programs, each with one more cut of the time."""

MOST_STATIONS = 20_000
"""Largest number of stations that a general solver is given."""

HALVINGS = 50
"""Number of halvings of a bisection."""

ALMOST_NOTHING = 1e-9
"""Share of a cap below which no profile is taken."""

AccelerationLimit = TangentialLimit | AxisLimit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SmoothProfile:
    """Smoothest profile within a time budget."""

    profile: PathProfile
    unevenness: float
    """Sum of squared changes of the acceleration over the distance between them, mm/s⁴."""
    fastest: PathProfile
    """Fastest profile within the same limits."""
    fastest_unevenness: float
    """The same sum of the fastest profile, mm/s⁴."""


@dataclass(frozen=True, slots=True, eq=False)
class Scale:
    """Units that make the variables of a program of order one."""

    length: float
    """Mean length of an interval, mm."""
    square: float
    """Greatest cap on b, mm²/s²."""

    @property
    def acceleration(self) -> float:
        """Unit of acceleration, mm/s²."""
        return self.square / self.length


def scale_of(problem: ProfileProblem) -> Scale:
    """Units of a problem."""
    return Scale(float(problem.lengths.mean()), float(problem.caps.max()))


def fastest(problem: ProfileProblem, limit: AccelerationLimit) -> PathProfile:
    """Fastest profile by the sweep that suits the limit."""
    if isinstance(limit, TangentialLimit):
        return sweep(problem, limit)
    return sweep_axes(problem, limit)


def solver_profile(problem: ProfileProblem, limit: AccelerationLimit) -> PathProfile:
    """Fastest profile by the interior-point solver.

    Parameters
    ----------
    problem : ProfileProblem
        At most ``MOST_STATIONS`` stations.
    limit : TangentialLimit or AxisLimit

    Returns
    -------
    PathProfile
        It may exceed limits by the tolerance of the solver, about 1e-8.

    Raises
    ------
    SolverFailed
        If the solver finds no optimum.
    """
    _require_size(problem)
    scale = scale_of(problem)
    square = cp.Variable(len(problem))
    feed = cp.Variable(len(problem))
    lengths = problem.lengths / scale.length
    time = 2.0 * lengths @ cp.inv_pos(feed[1:] + feed[:-1])
    program = cp.Problem(
        cp.Minimize(time),
        [
            cp.square(feed) <= square,
            *bounds(problem, square, scale),
            *acceleration_limits(problem.lengths, limit, square, scale),
        ],
    )
    run(program, cp.CLARABEL)
    squares = np.maximum(square.value, 0.0) * scale.square
    squares[problem.bounds() == 0.0] = 0.0
    return profile_of(problem.lengths, squares)


def smoothest_profile(
    problem: ProfileProblem, limit: AccelerationLimit, *, budget: float
) -> SmoothProfile:
    """Smoothest profile that takes no longer than a budget.

    Parameters
    ----------
    problem : ProfileProblem
        At most ``MOST_STATIONS`` stations.
    limit : TangentialLimit or AxisLimit
    budget : float, s

    Returns
    -------
    SmoothProfile
        It keeps limits and budget to rounding; it is as smooth as the solver found.

    Raises
    ------
    Infeasible
        If the fastest profile takes longer than the budget.
    SolverFailed
        If the solver finds nothing.
    """
    _require_size(problem)
    quickest = fastest(problem, limit)
    if not quickest.time <= budget:
        over = quickest.time - budget
        raise Infeasible(
            f"the fastest profile takes {quickest.time:.6g} s, {over:.3g} s more than the "
            f"budget of {budget:.6g} s",
            limits=("time",),
        )
    scale = scale_of(problem)
    # In units of the fastest profile the variables are of order one, at stops too.
    unit = np.where(quickest.squares > 0.0, quickest.squares, scale.square)
    ratio = cp.Variable(len(problem))
    square = cp.multiply(unit / scale.square, ratio)
    rough = _changes(problem.lengths / scale.length) @ square
    rules = [
        *bounds(problem, square, scale),
        *acceleration_limits(problem.lengths, limit, square, scale),
    ]
    best, least = quickest, unevenness(problem.lengths, quickest.squares)
    of_fastest, at = least, quickest.squares
    for _ in range(ROUNDS):
        slope = time_slope(problem.lengths, at)
        time = float(interval_times(problem.lengths, at).sum())
        rules.append((slope * unit) @ ratio <= budget - time + float(slope @ at))
        run(cp.Problem(cp.Minimize(cp.sum_squares(rough)), rules), cp.OSQP)
        wanted = np.clip(ratio.value * unit, 0.0, problem.caps)
        wanted[0] = problem.start
        at = _within(problem, limit, wanted, quickest, budget)
        value = unevenness(problem.lengths, at)
        if value < least:
            best, least = profile_of(problem.lengths, at), value
    return SmoothProfile(
        profile=best, unevenness=least, fastest=quickest, fastest_unevenness=of_fastest
    )


def unevenness(lengths: Floats, squares: Floats) -> float:
    """Sum of squared changes of the acceleration over the distance between them, mm/s⁴."""
    return float(np.sum((_changes(lengths) @ squares) ** 2))


def _require_size(problem: ProfileProblem) -> None:
    """Refuse what would take a solver hours."""
    if len(problem) > MOST_STATIONS:
        raise ValueError(f"{len(problem)} stations: a solver takes at most {MOST_STATIONS}")


def bounds(problem: ProfileProblem, square: cp.Variable, scale: Scale) -> list[cp.Constraint]:
    """Caps and ends of a problem."""
    top = problem.bounds() / scale.square
    return [square >= 0.0, square <= top, square[0] == problem.start / scale.square]


def acceleration_limits(
    lengths: Floats, limit: AccelerationLimit, square: cp.Variable, scale: Scale
) -> list[cp.Constraint]:
    """Limits of the acceleration in all intervals."""
    half = 0.5 * scale.length / lengths
    along = cp.multiply(half, square[1:] - square[:-1])
    unit = scale.acceleration
    if isinstance(limit, TangentialLimit):
        return [along <= limit.accelerating / unit, along >= -limit.braking / unit]
    rules = []
    for axis in range(3):
        most = limit.acceleration[axis] / unit
        for tangent, curvature, ends in (
            (limit.start_tangent, limit.start_curvature, square[:-1]),
            (limit.end_tangent, limit.end_curvature, square[1:]),
        ):
            share, bend = tangent[:, axis], curvature[:, axis] * scale.length
            if share.any() or bend.any():
                felt = cp.multiply(share, along) + cp.multiply(bend, ends)
                rules += [felt <= most, felt >= -most]
    return rules


def run(program: cp.Problem, solver: str) -> None:
    """Solve a program; where the solver fails, a linear one is given to HiGHS.

    An interior-point solver may make too little progress on one processor and not on another,
    as sums are rounded differently.

    Raises
    ------
    SolverFailed
        If no solver finds anything.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Solution may be inaccurate")
        try:
            program.solve(solver=solver)
        except cp.error.SolverError:
            _solve_by_simplex(program)
    if program.status not in {cp.OPTIMAL, cp.OPTIMAL_INACCURATE, cp.USER_LIMIT}:
        raise SolverFailed(program.status, program="feed profile")


def _solve_by_simplex(program: cp.Problem) -> None:
    """Solve a linear program by HiGHS, which SciPy brings."""
    try:
        program.solve(solver=cp.SCIPY)
    except cp.error.SolverError:
        raise SolverFailed("solver_error", program="feed profile") from None


def second_differences(lengths: Floats) -> sparse.csc_array:
    """Matrix of b'' at all stations but the first and the last, (N−2, N), 1/mm²."""
    middle = 0.5 * (lengths[1:] + lengths[:-1])
    before, after = 1.0 / (lengths[:-1] * middle), 1.0 / (lengths[1:] * middle)
    rows = np.arange(len(middle))
    return sparse.csc_array(
        (
            np.concatenate((before, -before - after, after)),
            (np.tile(rows, 3), np.concatenate((rows, rows + 1, rows + 2))),
        ),
        shape=(len(middle), len(lengths) + 1),
    )


def _changes(lengths: Floats) -> sparse.csc_array:
    """Matrix of the changes of acceleration at stations over the root of the distance."""
    root = np.sqrt(0.5 * (lengths[1:] + lengths[:-1]))
    return sparse.diags_array(0.5 * root) @ second_differences(lengths)


def time_slope(lengths: Floats, squares: Floats) -> Floats:
    """Derivative of the time by b at each station, (N,), s³/mm²; 0 at rest."""
    feed = np.sqrt(squares)
    part = lengths / (feed[1:] + feed[:-1]) ** 2
    slope = -np.append(part, 0.0) - np.append(0.0, part)
    result: Floats = np.zeros(len(feed))
    np.divide(slope, feed, out=result, where=feed > 0.0)
    return result


def _within(
    problem: ProfileProblem,
    limit: AccelerationLimit,
    wanted: Floats,
    quickest: PathProfile,
    budget: float,
) -> Floats:
    """Profile nearest to a wanted one, among means with the fastest, within the budget."""
    # The solver may have left almost a stop where there is none.
    caps = np.maximum(wanted, ALMOST_NOTHING * problem.caps)
    repaired = fastest(replace(problem, caps=caps), limit)
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (low + high)
        mean = (1.0 - share) * quickest.squares + share * repaired.squares
        if interval_times(problem.lengths, mean).sum() <= budget:
            low = share
        else:
            high = share
    return (1.0 - low) * quickest.squares + low * repaired.squares
