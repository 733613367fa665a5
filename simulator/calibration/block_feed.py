"""Feed along the circles of a block test, from sampled positions.

A feed that is the distance of two samples over their time is wrong twice on a circle: the
chord is shorter than the arc (1 % at half a radian between samples), and the jitter of a stamp
becomes an error of the feed. So the angle about the centre is followed instead, over several
turns, and the feed is the slope of a line of angle over time in the middle of the circle, by
the median of all pairs of samples, [1]_ and [2]_. Up to 29 % of the samples may be wrong
without harm. A control that cuts the corner runs a smaller circle at the same angle, and so
shows the right feed along the programmed lines.

A circle begins at the last sample at its start and ends where the machine stands at its end.
Units mm, s, rad.

References
----------
.. [1] H. Theil, "A rank-invariant method of linear and polynomial regression analysis",
   Proc. Kon. Ned. Akad. Wet. 53 (1950).
.. [2] P. K. Sen, "Estimates of the regression coefficient based on Kendall's tau", J. Amer.
   Stat. Assoc. 63 (1968) 1379-1389: its interval.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import theilslopes

from simulator.calibration.block_circles import DWELL, BlockCircle
from simulator.motion.segments import Floats

NEAR = 0.02
"""Distance within which a sample is at the start or the end of a circle, mm."""

STANDING = 0.7 * DWELL
"""Time near the end after which the machine stands there, s."""

MIDDLE = (0.15, 0.85)
"""Part of the angle in which the feed is taken: away from the ramps."""

FEWEST = 5
"""Samples in the middle part of a circle."""

MOST_SAMPLES = 600
"""Samples of a circle that are compared in pairs; of more, every second or third is taken."""

CLOSED = 0.2
"""Greatest difference between the followed and the programmed angle, rad."""

MOST_RESTS = 8
"""Places where the machine stands that are tried as the start of the first circle."""

TRIES = (1.0, 1.05, 1.1, 1.15, 1.2, 0.95, 0.9)
"""Ratios of the feed with which turns are counted to the mean feed over the whole circle."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PositionLog:
    """Sampled positions of a machine."""

    time: Floats
    """Times, (N,), s, ascending."""
    position: Floats
    """Positions of X, Y and Z, (N, 3), mm."""

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleFeed:
    """Feed that a machine reached on a circle."""

    circle: BlockCircle
    feed: float
    """Feed along the lines, mm/s."""
    low: float
    """Lower end of its 95 % interval, mm/s."""
    high: float
    """Upper end of its 95 % interval, mm/s."""
    samples: int
    """Number of samples from which it follows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MissedCircle:
    """Circle whose feed a log does not show."""

    circle: BlockCircle
    reason: str


def circle_feeds(
    log: PositionLog, circles: Sequence[BlockCircle]
) -> Iterator[CircleFeed | MissedCircle]:
    """Yield the feed of each circle of a test program, in its order.

    Parameters
    ----------
    log : PositionLog
        Samples without a position are left out before; the program's zero is that of the log.
    circles : sequence of BlockCircle
    """
    at = 0
    for circle in circles:
        span = _span(log, circle, at)
        if span is None:
            yield MissedCircle(circle=circle, reason="no samples at its start and its end")
            continue
        at = span[1]
        part = PositionLog(time=log.time[slice(*span)], position=log.position[slice(*span)])
        yield _feed(part, circle)


def zero_of_log(log: PositionLog, circles: Sequence[BlockCircle]) -> Floats | None:
    """Position of the program's zero in a log, where machine coordinates are logged.

    The first places where the machine stands are taken for the start of the first circle in
    turn; that with which most circles are found is it. Circles differ in the angle that they
    turn, so that none is taken for another.

    Returns
    -------
    (3,) array, mm, or None
        None where no place shows a circle.
    """
    best, most = None, 0
    for place in _rests(log):
        zero = place - circles[0].points[0]
        moved = replace(log, position=log.position - zero)
        found = sum(isinstance(each, CircleFeed) for each in circle_feeds(moved, circles))
        if found > most:
            best, most = zero, found
    return best


def _rests(log: PositionLog) -> list[Floats]:
    """First places where the machine stands as long as before a circle, each (3,), mm."""
    places: list[Floats] = []
    row, count = 0, len(log)
    while row < count and len(places) < MOST_RESTS:
        after = row + 1
        while after < count and np.linalg.norm(log.position[after] - log.position[row]) <= NEAR:
            after += 1
        is_long = after < count and log.time[after] - log.time[row] >= STANDING
        if is_long:
            places.append(log.position[row])
        row = after if is_long else row + 1
    return places


def _span(log: PositionLog, circle: BlockCircle, begin: int) -> tuple[int, int] | None:
    """Rows from the last sample at the start of a circle to the first at rest at its end."""
    away = np.linalg.norm(log.position[begin:] - circle.points[0], axis=1) > NEAR
    if away.all():
        return None
    first = begin + int(np.argmin(away))
    leaves = np.flatnonzero(away[first - begin :])
    if not len(leaves):
        return None
    first += int(leaves[0]) - 1
    near = np.linalg.norm(log.position[first:] - circle.points[-1], axis=1) <= NEAR
    edges = np.flatnonzero(np.diff(np.concatenate([[False], near, [False]]).astype(np.int8)))
    for low, high in edges.reshape(-1, 2).tolist():
        left = log.time[first + high] if first + high < len(log) else np.inf
        if low > 0 and left - log.time[first + low] >= STANDING:
            return first, first + low + 1
    return None


def _feed(part: PositionLog, circle: BlockCircle) -> CircleFeed | MissedCircle:
    """Feed from the samples of one circle."""
    angle = _followed(part, circle)
    if angle is None:
        text = f"{len(part)} samples are too far apart to count its turns"
        return MissedCircle(circle=circle, reason=text)
    inside = (angle > MIDDLE[0] * circle.turn) & (angle < MIDDLE[1] * circle.turn)
    rows = np.flatnonzero(inside)
    if len(rows) < FEWEST:
        text = f"{len(rows)} samples in its middle; at least {FEWEST} are needed"
        return MissedCircle(circle=circle, reason=text)
    rows = rows[:: -(-len(rows) // MOST_SAMPLES)]
    slope, _, low, high = theilslopes(angle[rows], part.time[rows], alpha=0.95)
    scale = circle.length / circle.turn
    return CircleFeed(
        circle=circle,
        feed=float(scale * slope),
        low=float(scale * low),
        high=float(scale * high),
        samples=len(rows),
    )


def _followed(part: PositionLog, circle: BlockCircle) -> Floats | None:
    """Angle from the start of a circle at each sample, with its turns; None: ambiguous.

    Between two samples the angle grows as the mean feed says, to less than half a turn. Counted
    with the right feed, the angles end where the circle does.
    """
    moved = np.linalg.norm(part.position - part.position[0], axis=1) > NEAR
    part = replace(part, time=part.time - part.time[0])
    wrapped = np.diff(circle.angle(part.position))
    steps = np.diff(part.time)
    mean = circle.turn / max(part.time[-1], 1e-9)
    best, least = None, CLOSED
    for ratio in TRIES:
        expected = ratio * mean * steps * moved[1:]
        grown = expected + np.remainder(wrapped - expected + np.pi, 2.0 * np.pi) - np.pi
        angle = np.concatenate([[0.0], np.cumsum(grown)])
        missing = abs(float(angle[-1]) - circle.turn)
        if missing < least:
            best, least = angle, missing
    return best
