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

Test program of the block rate: circles of short lines, each with one spacing of its points.

After [3]_, which runs circles of radius 0.5, 1 and 2 in at nine spacings, at the greatest feed
of the machine. Here each circle has the same number of lines, so that each takes about as long:
coarse ones go round several times, fine ones remain an arc. Before and after each circle the
machine stands for a second, which marks the circle in a log. On a mill each circle has a level
of its own, on a lathe a place of its own along the axis. Units mm, mm/s, s.

A control that rounds coordinates makes lines of uneven length; spacings below 20 of its
increments are left out, and the lengths that count are those of the written points.

References
----------
.. [1] H. Theil, "A rank-invariant method of linear and polynomial regression analysis",
   Proc. Kon. Ned. Akad. Wet. 53 (1950).
.. [2] P. K. Sen, "Estimates of the regression coefficient based on Kendall's tau", J. Amer.
   Stat. Assoc. 63 (1968) 1379-1389: its interval.
.. [3] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009, "Methodology" and Table 2.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import asin, cos, sin

import numpy as np
from scipy.stats import theilslopes

from simulator.motion.segments import Floats
from stepnc_model.post.blocks import (
    Block,
    Comment,
    Linear,
    MachineType,
    Pause,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
)
from stepnc_model.toolpath.path import Point

LEAST_INCREMENTS = 20
"""Smallest spacing in increments of the control's output; finer lines are too uneven."""

DWELL = 1.0
"""Pause before and after each circle, s."""

LEVEL = 0.5
"""Distance between two circles: of their levels on a mill, along the axis on a lathe, mm."""

CLEARANCE = 10.0
"""Smallest distance of a circle from the axis of a lathe, mm."""

FEWEST_LINES = 20
"""Consecutive feed moves that count as a circle when a program is read."""

ROUND = 0.01
"""Greatest spread of the radii of the points of a circle, mm: several increments."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTest:
    """Test program: all radii at all spacings."""

    radii: tuple[float, ...]
    """Radii of the circles, mm."""
    spacings: tuple[float, ...]
    """Nominal distances between two points of a circle, mm."""
    feed: float
    """Commanded feed, mm/s."""
    lines: int
    """Number of lines of each circle."""
    machine: MachineType = MachineType.MILL


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockCircle:
    """Circle of a test program, as it was written."""

    points: Floats
    """Start and the ends of its lines, (N + 1, 3), mm."""
    feed: float
    """Commanded feed, mm/s."""
    centre: Floats
    """Centre, (3,), mm."""
    axes: tuple[int, int]
    """Axes of its plane, so that it turns from the first to the second."""

    @property
    def lines(self) -> int:
        """Number of lines."""
        return len(self.points) - 1

    @property
    def length(self) -> float:
        """Length of all lines, mm."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    @property
    def spacing(self) -> float:
        """Mean length of a line as written, mm."""
        return self.length / self.lines

    @property
    def radius(self) -> float:
        """Mean distance of the points from the centre, mm."""
        return float(np.linalg.norm(self.points - self.centre, axis=1).mean())

    @property
    def turn(self) -> float:
        """Angle that it turns, rad; more than 2π for several turns."""
        return float(np.unwrap(self.angle(self.points))[-1] - self.angle(self.points)[0])

    def angle(self, position: Floats) -> Floats:
        """Angle of positions about the centre, (M,), rad."""
        arm = position - self.centre
        angle: Floats = np.arctan2(arm[:, self.axes[1]], arm[:, self.axes[0]])
        return angle


def written_spacings(
    spacings: Sequence[float], *, increment: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Split spacings into those that a control can write, and those that it cannot.

    Parameters
    ----------
    spacings : sequence of float, mm
    increment : float, mm
        Smallest step of a written coordinate.
    """
    least = LEAST_INCREMENTS * increment
    fit = tuple(each for each in spacings if each >= least * (1.0 - 1e-9))
    return fit, tuple(each for each in spacings if each not in fit)


def program_blocks(test: BlockTest, *, name: str) -> Iterator[Block]:
    """Neutral blocks of the test program."""
    yield ProgramStart(name=name, machine=test.machine)
    yield Comment(text="block rate test: runs in air, without tool and spindle")
    pairs = [(radius, spacing) for radius in test.radii for spacing in test.spacings]
    for number, (radius, spacing) in enumerate(pairs):
        points = _points(test, number, radius, spacing)
        yield Comment(text=f"radius {radius:.4g} mm, spacing {spacing:.4g} mm")
        yield Rapid(end=points[0])
        yield Pause(seconds=DWELL)
        for point in points[1:]:
            yield Linear(end=point, rate=Rate(value=test.feed))
        yield Pause(seconds=DWELL)
    yield ProgramEnd()


def _points(test: BlockTest, number: int, radius: float, spacing: float) -> list[Point]:
    """Start of a circle and the ends of its lines."""
    step, shift = 2.0 * asin(min(1.0, 0.5 * spacing / radius)), LEVEL * number
    angles = [step * row for row in range(test.lines + 1)]
    if test.machine is MachineType.MILL:
        return [(radius * cos(angle), radius * sin(angle), shift) for angle in angles]
    away = max(test.radii) + CLEARANCE
    return [(away + radius * cos(each), 0.0, shift + radius * sin(each)) for each in angles]


def circles_of(blocks: Iterable[Block]) -> tuple[BlockCircle, ...]:
    """Circles of a test program, from the blocks of its NC code.

    A circle is a sequence of at least 20 feed moves of one feed whose points have one distance
    from a centre; other moves are passed over.
    """
    found: list[BlockCircle] = []
    points: list[Point] = []
    feed = 0.0
    for block in (*blocks, ProgramEnd()):
        if isinstance(block, Linear) and points:
            points.append(block.end)
            feed = block.rate.value
            continue
        if len(points) > FEWEST_LINES:
            found += _circle(np.array(points), feed)
        points = [points[-1]] if points else []
        if isinstance(block, Rapid | Linear):
            points = [block.end]
    return tuple(found)


def _circle(points: Floats, feed: float) -> list[BlockCircle]:
    """The circle through some points, as a list of one; empty if they lie on none."""
    level = int(np.argmin(np.ptp(points, axis=0)))
    first, second = (axis for axis in range(3) if axis != level)
    columns = np.column_stack([points[:, first], points[:, second], np.ones(len(points))])
    squares = (columns[:, :2] ** 2).sum(axis=1)
    (a, b, _), *_ = np.linalg.lstsq(columns, squares, rcond=None)
    centre = points[0].copy()
    centre[first], centre[second] = 0.5 * a, 0.5 * b
    distances = np.linalg.norm(points - centre, axis=1)
    if np.ptp(distances) > ROUND:
        return []
    circle = BlockCircle(points=points, feed=feed, centre=centre, axes=(first, second))
    turns_back = circle.turn < 0.0
    axes = (second, first) if turns_back else (first, second)
    return [BlockCircle(points=points, feed=feed, centre=centre, axes=axes)]


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
