"""Block time of a control, fitted to the greatest feed at each spacing of points.

A control that takes a time for each block runs at most ``v = s/t_block``, [1]_. Where something
else holds the feed back, it lies below that line, so the line is sought where most points agree
on the time a block takes, and where they tie, at the shortest such time. Three fits describe
it: through the origin and with an intercept, both by least squares, and the mean time of a
block with Tukey's biweight, [2]_, which gives no weight to a point far from the others.

What holds the other points back shows in how their feed varies: the commanded feed stays;
``v²/R`` is the acceleration towards the centre; by junction deviation e, a corner between lines
on a circle passes ``v = √(8·a·e)·R/s``; a control that stops at each block has ``v² = a·s/4``.
Such points leave the fits, those that nothing explains do not. Units mm, mm/s, s.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009, Table 2. Its printed line, 14847 per minute, is no fit of that table.
.. [2] F. Mosteller, J. W. Tukey, "Data analysis and regression", 1977, pp. 205-208: biweight
   with c = 6 and its interval by Student's t with 0.7·(n − 1) degrees of freedom.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.stats import t as student

from simulator.errors import CalibrationError
from simulator.motion.segments import Bools, Floats

CONFIDENCE = 0.95

ON_LINE = 0.05
"""Greatest relative distance from the line of a point that the block rate limits."""

AGREED = 0.03
"""Relative distance within which points agree on the time a block takes."""

SAME = 0.1
"""Relative spread within which a number counts as constant."""

APART = 1.2
"""Least ratio of radii, spacings or both that can tell two causes apart."""

AT_COMMAND = 0.97
"""Share of the commanded feed from which a feed counts as commanded."""

BIWEIGHT = 6.0
"""Distance in medians of the absolute deviation at which a point has no weight, [2]_."""

ROUNDS = 50

FEWEST_POINTS = 3
"""Spacings for a fit with an intercept and an interval."""


class FeedCause(StrEnum):
    """Cause that limits the feed at a spacing."""

    BLOCK_RATE = "block rate"
    COMMANDED = "commanded feed"
    ACCELERATION = "acceleration"
    CORNER = "corner limit"
    STOP = "stop at each block"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpacingFeed:
    """Greatest feed at a spacing."""

    spacing: float
    """Mean distance of two points, mm."""
    feed: float
    """Greatest feed reached, mm/s."""
    radius: float | None = None
    """Radius of the circle, mm."""
    commanded: float | None = None
    """Commanded feed, mm/s."""

    @property
    def time(self) -> float:
        """Time of a block, s."""
        return self.spacing / self.feed


@dataclass(frozen=True, slots=True, kw_only=True)
class IntervalEstimate:
    """Number with its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def inverse(self) -> "IntervalEstimate":
        """One over it; an interval that contains 0 becomes infinite."""
        high = 1.0 / self.low if self.low > 0.0 else float("inf")
        return IntervalEstimate(value=1.0 / self.value, low=1.0 / self.high, high=high)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LineFit:
    """Line of feed over spacing."""

    name: str
    slope: IntervalEstimate
    """Slope, 1/s; one over the block time."""
    intercept: IntervalEstimate | None
    """Feed at no spacing, mm/s; None where it is 0 by choice."""
    residual: Floats
    """Feed less that of the line at each point, (N,), mm/s."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockFit:
    """Fits of a block test."""

    points: tuple[SpacingFeed, ...]
    """Points, ascending by spacing, then radius."""
    causes: tuple[FeedCause, ...]
    """Cause that limits each point."""
    fits: tuple[LineFit, ...]
    """Fits through the origin, with an intercept, and robust, of the points in them."""
    block_time: IntervalEstimate
    """Block time by the robust fit, s."""
    acceleration: float | None
    """Acceleration by the points that it limits, mm/s²."""
    corner: float | None
    """Product a·e of junction deviation by the points that corners limit, mm²/s²."""


def fitted_block_time(points: Sequence[SpacingFeed]) -> BlockFit:
    """Fit the block time to the greatest feed at each spacing.

    Raises
    ------
    CalibrationError
        If there are fewer than three spacings, or the block rate limits fewer than two points.
    """
    found = tuple(sorted(points, key=_order))
    if len({each.spacing for each in found}) < FEWEST_POINTS:
        raise CalibrationError(
            f"{len({each.spacing for each in found})} different spacings: a fit needs at least "
            f"{FEWEST_POINTS}"
        )
    causes = _causes(found)
    if causes.count(FeedCause.BLOCK_RATE) < FEWEST_POINTS - 1:
        raise CalibrationError(
            "the time of a block varies by more than 3 % between all points, so that no block "
            f"time holds them: {_listed(causes)}"
        )
    in_fit = np.array([cause in {FeedCause.BLOCK_RATE, FeedCause.UNKNOWN} for cause in causes])
    robust = _biweight(np.array([each.time for each in found])[in_fit])
    return BlockFit(
        points=found,
        causes=tuple(causes),
        fits=_fits(found, in_fit, robust),
        block_time=robust,
        acceleration=_mean(found, causes, FeedCause.ACCELERATION, _centripetal)
        or _mean(found, causes, FeedCause.STOP, _stopping),
        corner=_mean(found, causes, FeedCause.CORNER, lambda each: _corner(each) ** 2 / 8.0),
    )


def _order(point: SpacingFeed) -> tuple[float, float]:
    """Spacing to three digits, as rounding changes the others, then radius."""
    return float(f"{point.spacing:.3g}"), point.radius or 0.0


def _listed(causes: Sequence[FeedCause]) -> str:
    return ", ".join(f"{causes.count(each)} {each.value}" for each in dict.fromkeys(causes))


def _causes(points: Sequence[SpacingFeed]) -> list[FeedCause]:
    """Cause of each point: first those on the line, then those that the others explain."""
    times = np.array([each.time for each in points])
    is_commanded = [
        each.commanded is not None and each.feed >= AT_COMMAND * each.commanded
        for each in points
    ]
    on_line = np.abs(times / _common(times[~np.array(is_commanded)]) - 1.0) <= ON_LINE
    rest = [
        each
        for each, line, command in zip(points, on_line, is_commanded, strict=True)
        if not line and not command
    ]
    causes = []
    for each, line, command in zip(points, on_line, is_commanded, strict=True):
        if command:
            causes.append(FeedCause.COMMANDED)
        else:
            causes.append(FeedCause.BLOCK_RATE if line else _explained(each, rest))
    return causes


def _common(times: Floats) -> float:
    """Time of a block on which most points agree; the shortest such time."""
    if not len(times):
        return float("nan")
    close = np.abs(times[:, None] / times[None, :] - 1.0) <= AGREED
    counts = close.sum(axis=0)
    best = min(np.flatnonzero(counts == counts.max()), key=lambda row: times[row])
    return float(np.median(times[close[:, best]]))


def _explained(point: SpacingFeed, rest: Sequence[SpacingFeed]) -> FeedCause:
    """Cause by which most points off the line have the same number as a point."""
    counts = {
        FeedCause.ACCELERATION: _agreeing(point, rest, _centripetal, _radius),
        FeedCause.CORNER: _agreeing(point, rest, _corner, _bend),
        FeedCause.STOP: _agreeing(point, rest, _stopping, lambda each: each.spacing),
    }
    best = max(counts, key=lambda cause: counts[cause])
    return best if counts[best] else FeedCause.UNKNOWN


def _agreeing(
    point: SpacingFeed,
    rest: Sequence[SpacingFeed],
    number: Callable[[SpacingFeed], float],
    varied: Callable[[SpacingFeed], float],
) -> int:
    """Number of points with the same number although what it is made of differs.

    A point without a radius has no number that needs one (NaN) and agrees with none.
    """
    own, place = number(point), varied(point)
    return sum(
        max(varied(each) / place, place / varied(each)) >= APART
        and abs(number(each) / own - 1.0) <= SAME
        for each in rest
    )


def _radius(point: SpacingFeed) -> float:
    return point.radius or float("nan")


def _bend(point: SpacingFeed) -> float:
    """Angle between two lines of a circle, rad."""
    return point.spacing / _radius(point)


def _centripetal(point: SpacingFeed) -> float:
    """Acceleration towards the centre, mm/s²."""
    return point.feed**2 / _radius(point)


def _corner(point: SpacingFeed) -> float:
    """Feed times angle between two lines, which junction deviation keeps, mm/s."""
    return point.feed * _bend(point)


def _stopping(point: SpacingFeed) -> float:
    """Acceleration of a triangle of speed over each line, mm/s²."""
    return 4.0 * point.feed**2 / point.spacing


def _mean(
    points: Sequence[SpacingFeed],
    causes: Sequence[FeedCause],
    cause: FeedCause,
    number: Callable[[SpacingFeed], float],
) -> float | None:
    """Median of a number over the points of a cause; None without any."""
    found = [number(each) for each, of in zip(points, causes, strict=True) if of is cause]
    return float(np.median(found)) if found else None


def _fits(
    points: Sequence[SpacingFeed], rows: Bools, robust: IntervalEstimate
) -> tuple[LineFit, ...]:
    """Three lines through some of the points, with residuals of all."""
    spacing = np.array([each.spacing for each in points])
    feed = np.array([each.feed for each in points])
    fits = []
    for name, columns in (
        ("through the origin", [spacing]),
        ("with an intercept", [spacing, np.ones(len(points))]),
    ):
        table = np.stack(columns, axis=1)
        found = _least_squares(table[rows], feed[rows])
        line = table @ np.array([each.value for each in found])
        intercept = found[1] if len(found) > 1 else None
        fits.append(
            LineFit(name=name, slope=found[0], intercept=intercept, residual=feed - line)
        )
    slope = robust.inverse
    fits.append(
        LineFit(
            name="robust", slope=slope, intercept=None, residual=feed - slope.value * spacing
        )
    )
    return tuple(fits)


def _least_squares(table: Floats, values: Floats) -> list[IntervalEstimate]:
    """Coefficients of a linear model with their intervals by Student's t."""
    found, *_ = np.linalg.lstsq(table, values, rcond=None)
    freedom = len(values) - table.shape[1]
    left = float(((values - table @ found) ** 2).sum())
    spread = np.sqrt(np.diag(np.linalg.inv(table.T @ table)) * left / max(freedom, 1))
    reach = _student(freedom) * spread
    return [
        IntervalEstimate(value=float(value), low=float(value - half), high=float(value + half))
        for value, half in zip(found, reach, strict=True)
    ]


def _student(freedom: float) -> float:
    """Quantile of the two-sided interval; infinite without a degree of freedom."""
    if freedom <= 0.0:
        return float("inf")
    return float(student.ppf(0.5 + 0.5 * CONFIDENCE, freedom))


def _biweight(times: Floats) -> IntervalEstimate:
    """Mean of times with Tukey's biweight, and its interval, [2]_."""
    centre = _common(times)
    for _ in range(ROUNDS):
        width = float(np.median(np.abs(times - centre)))
        if width <= 1e-12 * centre:
            break
        share = (times - centre) / (BIWEIGHT * width)
        weight = np.where(np.abs(share) < 1.0, (1.0 - share**2) ** 2, 0.0)
        moved = float((weight * times).sum() / weight.sum())
        if abs(moved - centre) <= 1e-12 * centre:
            break
        centre = moved
    half = _student(0.7 * (len(times) - 1)) * _biweight_error(times, centre)
    return IntervalEstimate(value=centre, low=centre - half, high=centre + half)


def _biweight_error(times: Floats, centre: float) -> float:
    """Standard error of the biweight mean, [2]_, with c = 9 as there for the spread."""
    width = float(np.median(np.abs(times - centre)))
    if width <= 1e-12 * centre:
        return 0.0
    share = (times - centre) / (1.5 * BIWEIGHT * width)
    near = np.abs(share) < 1.0
    part, away = share[near] ** 2, times[near] - centre
    above = float((away**2 * (1.0 - part) ** 4).sum())
    below = abs(float(((1.0 - part) * (1.0 - 5.0 * part)).sum()))
    return float(np.sqrt(above) / max(below, 1e-12))
