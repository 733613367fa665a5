"""Geometric program of one workingstep: the general solver, and a check of the closed form.

For a given number of passes every limit is a posynomial in the feed per tooth f and the spindle
speed n, and so are machining time, Taylor tool changes and energy. In logarithms the program is
convex, so what the solver finds is the optimum, and its dual variables are the marginal prices
of the limits: the relative rise of the cost for a relative fall of the bound. The program is
compiled once with parameters; a solve only sets them.

S. Boyd, S.-J. Kim, L. Vandenberghe, A. Hassibi, "A tutorial on geometric programming", Optim.
Eng. 8 (2007) 67–127, §§ 2 and 3.3. Only the programs of the optimiser use cvxpy: this one,
:mod:`optimiser.feed_profile.profile_program` and :mod:`optimiser.feed_profile.jerk_program`.
"""

import warnings
from dataclasses import dataclass, replace
from functools import cache
from math import inf

import cvxpy as cp

from optimiser.errors import Infeasible, OptimisationError, SolverFailed
from optimiser.modes import Mode
from optimiser.solver.convex import TIE
from optimiser.solver.least_cost import least_cost
from optimiser.solver.problem import BoundSide, Limit, LimitName, Monomial, Problem, Setting
from optimiser.solver.workingstep import conflict, is_posynomial, limits_at

ROWS = (8, 24)
"""Sizes of compiled programs, in limits; a smaller one is faster to set and solve."""

ABSENT = 1e-12
"""Weight of an absent term: a posynomial has no zero."""

PRECISION = {"tol_gap_abs": 1e-7, "tol_gap_rel": 1e-7, "tol_feas": 1e-8, "max_iter": 200}
"""Solver tolerances, relative, for the logarithm of the cost; Clarabel reaches them."""

UNIT_FEEDS = (1.0, 3.0, 0.3)
"""Units of the feed tried in turn, relative to the programmed feed, if ill-conditioned."""

TERMS = 4
"""Monomials of the cost: standby, idling, chip and edge energy, or time and tool changes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverOptimum:
    """Optimum found by the solver for one number of passes."""

    setting: Setting
    cost: float
    """Cost of the optimum, s or J."""
    prices: dict[LimitName, float]
    """Shadow price −d ln(cost) / d ln(bound) of each limit; zero when it is not active."""


@dataclass(frozen=True, slots=True)
class _LimitRow:
    """Solver parameters of one limit: ``c·f^α·n^γ + e·n^γ ≤ 1``."""

    coefficient: cp.Parameter
    offset: cp.Parameter
    feed_exponent: cp.Parameter
    speed_exponent: cp.Parameter


@dataclass(frozen=True, slots=True)
class _Unit:
    """Units of the program's variables, in mm and rev/s, that make them of order one.

    A fixed speed gets zero exponents, because an interior-point method needs an interior.
    """

    feed: float
    speed: float
    is_fixed: bool


class GeometricProgram:
    """Compiled geometric program; solving sets its parameters, so threads must not share it."""

    def __init__(self, rows: int) -> None:
        self._feed = cp.Variable(pos=True)
        self._speed = cp.Variable(pos=True)
        self._least_speed = cp.Parameter(pos=True)
        self._greatest_speed = cp.Parameter(pos=True)
        self._terms = [
            (cp.Parameter(pos=True), cp.Parameter(), cp.Parameter()) for _ in range(TERMS)
        ]
        self._rows = [
            _LimitRow(
                cp.Parameter(pos=True), cp.Parameter(pos=True), cp.Parameter(), cp.Parameter()
            )
            for _ in range(rows)
        ]
        cost = sum(
            weight * self._feed**feed * self._speed**speed
            for weight, feed, speed in self._terms
        )
        self._held = [
            row.coefficient * self._feed**row.feed_exponent * self._speed**row.speed_exponent
            + row.offset * self._speed**row.speed_exponent
            <= 1.0
            for row in self._rows
        ]
        self._problem = cp.Problem(
            cp.Minimize(cost),
            [
                *self._held,
                self._speed >= self._least_speed,
                self._speed <= self._greatest_speed,
            ],
        )

    def solve(
        self, problem: Problem, mode: Mode, *, passes: int, depth: float, stretch: int = 0
    ) -> SolverOptimum:
        """Optimum for one number of passes on one stretch of the spindle's curve.

        Parameters
        ----------
        passes : int
        depth : float
            Depth of each pass, mm.
        stretch : int
            Index into ``problem.stretches``.

        Returns
        -------
        SolverOptimum

        Raises
        ------
        Infeasible
            When the limits exclude each other at this depth.
        SolverFailed
            When the solver gives no optimum for another reason.
        """
        limits = _rows_of(problem, stretch)
        terms = _cost_terms(problem, mode, passes=passes, depth=depth)
        speeds = problem.speeds[stretch : stretch + 2]
        for unit_feed in UNIT_FEEDS:
            unit = _Unit(unit_feed * problem.programmed.feed, speeds[0], len(speeds) == 1)
            self._set_speeds(speeds)
            rests = self._set_rows(limits, depth=depth, unit=unit)
            worth = self._set_terms(terms, unit=unit)
            status = self._attempt()
            if status in {cp.INFEASIBLE, cp.INFEASIBLE_INACCURATE}:
                raise conflict(problem)
            if status == cp.OPTIMAL:
                break
        else:
            raise SolverFailed(status)
        setting = Setting(
            feed=unit.feed * float(self._feed.value),
            depth=depth,
            passes=passes,
            speed=unit.speed * (1.0 if unit.is_fixed else float(self._speed.value)),
        )
        standby = problem.cost.standby_power if mode is Mode.EC else 1.0
        programmed = worth * float(self._problem.value)
        cost = programmed + passes * problem.cost.link_time * standby
        # The constant link time is not part of the program: its prices shrink by that share.
        prices = {
            limit.name: float(held.dual_value) / rest * programmed / cost
            for limit, held, rest in zip(limits, self._held, rests, strict=False)
        }
        return SolverOptimum(setting=setting, cost=cost, prices=prices)

    def _attempt(self) -> str:
        """Solve with the current parameters and return the solver's status."""
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Solution may be inaccurate")
            try:
                self._problem.solve(gp=True, solver=cp.CLARABEL, enforce_dpp=True, **PRECISION)
            except cp.error.SolverError:
                return "solver_error"
        return str(self._problem.status)

    def _set_speeds(self, speeds: tuple[float, ...]) -> None:
        """Set the bounds of the relative speed; a fixed speed gets a dummy range."""
        _put(self._least_speed, 1.0)
        _put(self._greatest_speed, speeds[-1] / speeds[0] if len(speeds) > 1 else 2.0)

    def _set_rows(self, limits: list[Limit], *, depth: float, unit: _Unit) -> list[float]:
        """Set one row for each limit; unused rows always hold.

        An offset that does not depend on the speed moves to the other side, ``c·f^α ≤ b − e``,
        because a bound just above its offset would leave the solver no significant digits.
        Return the share of each bound that is left, ``d ln(b − e) = d ln b / share``.
        """
        rests = []
        for row, limit in zip(self._rows, limits, strict=False):
            load, sign = limit.load, 1.0 if limit.sense is BoundSide.AT_MOST else -1.0
            exponent = load.speed_exponent - limit.bound_speed_exponent
            scale = load.depth_factor(depth) * unit.speed**exponent / limit.bound
            chip = unit.feed**load.feed_exponent
            if sign < 0.0 and load.offset:
                raise OptimisationError(f"{limit.name.words} with offset is not a posynomial")
            offset = load.offset * scale
            is_constant = (unit.is_fixed or exponent == 0.0) and offset < 1.0
            rest = 1.0 - offset if is_constant else 1.0
            rests.append(rest)
            _put(row.coefficient, (load.coefficient * scale * chip) ** sign / rest)
            _put(row.offset, ABSENT if is_constant else max(offset, ABSENT))
            _put(row.feed_exponent, sign * load.feed_exponent)
            _put(row.speed_exponent, 0.0 if unit.is_fixed else sign * exponent)
        for row in self._rows[len(limits) :]:
            for weight in (row.coefficient, row.offset):
                _put(weight, ABSENT)
            for power in (row.feed_exponent, row.speed_exponent):
                _put(power, 0.0)
        return rests

    def _set_terms(self, terms: list[tuple[float, float, float]], *, unit: _Unit) -> float:
        """Set the weights and exponents of the cost; return the value of a unit cost."""
        weights = [
            weight * unit.feed**feed * unit.speed**speed for weight, feed, speed in terms
        ]
        worth = float(sum(weights))
        rows = [
            (max(weight / worth, ABSENT), feed, 0.0 if unit.is_fixed else speed)
            for weight, (_, feed, speed) in zip(weights, terms, strict=True)
        ]
        rows += [(ABSENT, 0.0, 0.0)] * (TERMS - len(rows))
        for parameters, values in zip(self._terms, rows, strict=True):
            for parameter, value in zip(parameters, values, strict=True):
                _put(parameter, value)
        return worth


def _put(parameter: cp.Parameter, value: float) -> None:
    """Set a parameter only if it changed, because cvxpy validates each value slowly."""
    if parameter.value is None or float(parameter.value) != value:
        parameter.value = value


@cache
def program(rows: int) -> GeometricProgram:
    """Return the compiled program of this process with a given number of rows."""
    return GeometricProgram(rows)


def program_for(problem: Problem, stretch: int) -> GeometricProgram:
    """Return the smallest program that holds the limits of a stretch."""
    count = len(_rows_of(problem, stretch))
    for rows in ROWS:
        if count <= rows:
            return program(rows)
    raise OptimisationError(f"{count} limits exceed the {ROWS[-1]} that the solver supports")


def _rows_of(problem: Problem, stretch: int) -> list[Limit]:
    """Limits on the feed, each of which becomes a row of the program."""
    return [
        limit
        for limit in problem.limits + problem.stretches[stretch]
        if limit.load.feed_exponent > 0.0
    ]


def solve(problem: Problem, mode: Mode) -> SolverOptimum:
    """Find the optimum over all numbers of passes and all stretches of the spindle's curve.

    Where the cost is convex in the logarithm of the number of passes the search stops at the
    first rise, otherwise where no larger number of passes can cost less.

    Returns
    -------
    SolverOptimum

    Raises
    ------
    Infeasible
        When no number of passes keeps all limits.
    """
    best: SolverOptimum | None = None
    is_convex = is_posynomial(problem) and not problem.is_branched
    bound = least_cost(problem, mode)
    for passes in range(problem.deepest(), problem.passes[1] + 1):
        worse = inf if best is None else best.cost * (1.0 + 100.0 * TIE)
        if not is_convex and bound(passes) > worse:
            break
        depth = problem.depth_at(passes)
        found = _best_stretch(problem, mode, passes=passes, depth=depth)
        if found is None:
            continue
        if is_convex and found.cost > worse:
            break
        if best is None or found.cost < best.cost:
            best = found
    if best is None:
        raise conflict(problem)
    return best


def snapped(problem: Problem, optimum: SolverOptimum) -> Setting:
    """Setting of the solver with its feed set exactly to the nearest cap."""
    at = optimum.setting
    speed = min(max(at.speed, problem.speeds[0]), problem.speeds[-1])
    caps = [
        limit.feed_at_bound(at.depth, speed)
        for limit in limits_at(problem, speed)
        if limit.sense is BoundSide.AT_MOST
    ]
    return replace(at, feed=min(caps), speed=speed)


def _best_stretch(
    problem: Problem, mode: Mode, *, passes: int, depth: float
) -> SolverOptimum | None:
    """Best optimum of the stretches of the spindle's curve, or None if none is feasible."""
    best: SolverOptimum | None = None
    parts = [problem] if len(problem.speeds) == 1 else problem.parts(depth)
    for part in parts:
        try:
            compiled = program_for(part, 0)
            found = compiled.solve(part, mode, passes=passes, depth=depth)
        except Infeasible:
            continue
        low, high = part.speeds[0], part.speeds[-1]
        at = found.setting
        found = replace(found, setting=replace(at, speed=min(max(at.speed, low), high)))
        if best is None or found.cost < best.cost:
            best = found
    return best


def _cost_terms(
    problem: Problem, mode: Mode, *, passes: int, depth: float
) -> list[tuple[float, float, float]]:
    """Monomials (weight, exponent of f, exponent of n) of time or energy."""
    cost = problem.cost
    stroke = cost.travel(passes) / cost.teeth
    wear = cost.wear_rate or Monomial(coefficient=0.0)
    if mode is not Mode.EC:
        changes = stroke * cost.tool_change * wear.coefficient
        return [
            (stroke, -1.0, -1.0),
            (changes, wear.feed_exponent - 1.0, wear.speed_exponent - 1.0),
        ]
    cut = cost.motor_power
    scale = stroke * cut.depth_factor(depth)
    return [
        (stroke * cost.standby_power, -1.0, -1.0),
        (stroke * cost.standby_power_per_speed, -1.0, 0.0),
        (scale * cut.coefficient, cut.feed_exponent - 1.0, cut.speed_exponent - 1.0),
        (scale * cut.offset, -1.0, cut.speed_exponent - 1.0),
    ]
