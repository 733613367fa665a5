"""Test program of the block rate: circles of short lines, each with one spacing of its points.

After [1]_, which runs circles of radius 0.5, 1 and 2 in at nine spacings, at the greatest feed
of the machine. Here each circle has the same number of lines, so that each takes about as long:
coarse ones go round several times, fine ones remain an arc. Before and after each circle the
machine stands for a second, which marks the circle in a log. On a mill each circle has a level
of its own, on a lathe a place of its own along the axis. Units mm, mm/s, s.

A control that rounds coordinates makes lines of uneven length; spacings below 20 of its
increments are left out, and the lengths that count are those of the written points.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009, "Methodology" and Table 2.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import asin, cos, sin

import numpy as np

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
