"""A program's blocks rebuilt from where it was seen: positions and block numbers, no times.

Holds for programs of axis-parallel lines that arcs join, as pockets and outlines are made, with
slanted lines between them in rapid. One run gives the order; samples of other runs of the same
program, which may be out of order, are threaded onto it and make it denser. Lines are where two
coordinates stay; corners are where successive lines meet; the arcs that round them are fitted.
Units mm, mm/s.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from simulator.calibration.corners import Corners, CornerSamples, fitted
from simulator.calibration.rounded import rounded
from simulator.calibration.thread import (
    SPACING,
    Course,
    PathSamples,
    course_of,
    course_of_samples,
    joined,
    shifted,
    stations,
)
from simulator.errors import CalibrationError
from simulator.motion.segments import Bools, Floats, Ints, Segments

SHORTEST = 0.85  # mm that a coordinate changes along a line, beyond its rounding
FEWEST = 5
"""samples on a line"""
NEVER = 1e-9  # mm, lengths below this are none
HALF = 0.5
UP = 2
"""axis Z"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Line:
    """An axis-parallel line, by the samples on it."""

    axis: int
    """that changes"""
    first: Floats
    """(3,) mm, position of its first sample"""
    last: Floats
    rows: tuple[int, int]
    """of its first and its last sample"""

    @property
    def length(self) -> float:
        """Between its outermost samples, mm."""
        return float(np.abs(self.last - self.first)[self.axis])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rebuilt:
    """A program as it was seen to run."""

    segments: Segments
    """N lines and arcs, each a block of its own numbered from 0; feeds are 1 mm/s"""
    seen_block: Floats
    """(N,) number of the program's block that the runs show most often on each"""

    def course(self) -> Course:
        """Points along it, with the numbers of the program's blocks."""
        return course_of(self.segments, self.seen_block)

    def at_feed(self, feed: float) -> Segments:
        """Its segments at a feed in mm/s; rapids keep their speed."""
        speed = np.where(self.segments.is_rapid, self.segments.speed, feed)
        return replace(self.segments, speed=speed)


def rebuilt(samples: PathSamples, others: Sequence[PathSamples], *, rapid: float) -> Rebuilt:
    """Lines and arcs of the program that some runs followed.

    Parameters
    ----------
    samples : PathSamples
        Of one whole run, in order.
    others : sequence of PathSamples
        Of other runs, in any order.
    rapid : float, mm/s
        Speed along the path in rapid.

    Raises
    ------
    CalibrationError
        No line was found.
    """
    course = course_of_samples(samples)
    every = joined([samples, *(shifted(other, course) for other in others)])
    station = stations(every, course)
    order = np.argsort(station, kind="stable")
    every, station = every[order], station[order]
    lines = _lines(every)
    if not lines:
        raise CalibrationError(f"no axis-parallel line of {SHORTEST} mm in {len(every)} samples")
    vertices, radius = _path(lines, every)
    return _labelled(rounded(vertices, radius), every, station=station, rapid=rapid)


def _lines(samples: PathSamples) -> list[Line]:
    """Longest stretches in which two coordinates stay, in order, alternating in direction."""
    found = [line for axis in range(3) for line in _stretches(samples, axis)]
    kept: list[Line] = []
    for line in sorted(found, key=lambda line: line.rows):
        if kept and _is_same(kept[-1], line, samples.half_step):
            if line.length > kept[-1].length:
                kept[-1] = line
        else:
            kept.append(line)
    return _with_crossings(kept, samples)


def _with_crossings(lines: list[Line], samples: PathSamples) -> list[Line]:
    """Lines, with one across between two that are parallel and level.

    An arc that is all there is between them may be too short to show one.
    """
    path = lines[:1]
    for line in lines[1:]:
        before = path[-1]
        if before.axis == line.axis != UP and before.first[UP] == line.first[UP]:
            rows = (before.rows[1], line.rows[0])
            level = samples.position[rows[0] : rows[1] + 1, line.axis].mean()
            first, last = before.last.copy(), line.first.copy()
            first[line.axis] = last[line.axis] = level
            path.append(Line(axis=1 - line.axis, first=first, last=last, rows=rows))
        path.append(line)
    return path


def _stretches(samples: PathSamples, axis: int) -> list[Line]:
    """Stretches along one axis."""
    position = samples.position
    others = [other for other in range(3) if other != axis]
    breaks = np.abs(np.diff(position[:, others], axis=0)).max(axis=1) > NEVER
    edges = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(position)]])
    lines = [
        Line(axis=axis, first=position[low], last=position[high - 1], rows=(low, high - 1))
        for low, high in zip(edges[:-1], edges[1:], strict=True)
    ]
    rounding = samples.half_step[:, axis]
    return [
        line
        for line in lines
        if line.rows[1] - line.rows[0] >= FEWEST - 1
        and line.length >= SHORTEST + rounding[list(line.rows)].sum()
    ]


def _is_same(before: Line, after: Line, half_step: Floats) -> bool:
    """Whether two stretches are one line, cut where its rounded coordinate flips."""
    step = 2.0 * half_step[after.rows[0]] + NEVER
    step[after.axis] = np.inf
    return before.axis == after.axis and bool((np.abs(after.first - before.last) <= step).all())


def _corners(lines: Sequence[Line], samples: PathSamples) -> Corners:
    """Corners of successive lines in one plane, fitted to the samples on and between them."""
    along_x = np.array([1 - line.axis for line in lines])
    offset = np.array([line.first[1 - line.axis] for line in lines])
    middle = np.array([_middle(line) for line in lines])
    guess = Corners(
        offset=offset,
        is_along_x=along_x,
        side=np.ones((len(lines) - 1, 2)),
        radius=np.zeros(len(lines) - 1),
    )
    arms = middle[:-1, :2] + middle[1:, :2] - 2.0 * guess.vertex
    guess = replace(guess, side=np.where(arms < 0.0, -1.0, 1.0))
    legs = np.linalg.norm(np.diff(guess.vertex, axis=0), axis=1)
    legs = np.concatenate([[lines[0].length], legs, [lines[-1].length]])
    rows = np.arange(lines[0].rows[0], lines[-1].rows[1] + 1)
    cuts = np.array([sum(line.rows) // 2 for line in lines[1:-1]])
    corner = np.searchsorted(cuts, rows, side="right")
    # Rounded positions repeat, and a box that is seen twice holds the path no better.
    _, once = np.unique(
        np.column_stack([corner, samples.position[rows, :2]]), axis=0, return_index=True
    )
    near = CornerSamples(
        corner=corner[once],
        point=samples.position[rows[once], :2],
        half_step=samples.half_step[rows[once], :2],
    )
    return fitted(guess, near, longest=np.minimum(legs[:-1], legs[1:]))


def _middle(line: Line) -> Floats:
    """Point in the middle of a line."""
    return 0.5 * (line.first + line.last)


def _is_flat(before: Line, after: Line) -> bool:
    """Whether two lines lie in one plane of X and Y and meet at right angles."""
    return before.axis + after.axis == 1 and before.axis != after.axis


def _path(lines: list[Line], samples: PathSamples) -> tuple[Floats, Floats]:
    """Vertices of the path, (K, 3), and the radius of the arc that rounds each, (K,)."""
    fixed = [line.first.copy() for line in lines]
    radius = np.zeros(len(lines))
    first = 0
    for last in range(len(lines)):
        if last + 1 < len(lines) and _is_flat(lines[last], lines[last + 1]):
            continue
        if last > first:
            corners = _corners(lines[first : last + 1], samples)
            for row, offset in enumerate(corners.offset, start=first):
                fixed[row][1 - lines[row].axis] = offset
            radius[first:last] = corners.radius
        first = last + 1
    begin = fixed[0].copy()
    begin[lines[0].axis] = lines[0].first[lines[0].axis]
    vertices, radii = [samples.position[0], begin], [0.0, 0.0]
    for row in range(len(lines) - 1):
        found = _meeting(lines, fixed, row, samples)
        vertices += found
        radii += [radius[row]] * len(found)
    end = fixed[-1].copy()
    end[lines[-1].axis] = samples.position[-1, lines[-1].axis]
    return np.array([*vertices, end]), np.array([*radii, 0.0])


def _meeting(
    lines: list[Line], fixed: list[Floats], row: int, samples: PathSamples
) -> list[Floats]:
    """Where a line and the next one meet; both ends of what joins them if they do not."""
    before, after = lines[row], lines[row + 1]
    if before.axis != after.axis:
        point = fixed[row].copy()
        point[before.axis] = fixed[row + 1][before.axis]
        return [point]
    between = samples.position[before.rows[1] : after.rows[0] + 1, before.axis]
    ends = []
    for here, level in ((fixed[row], between[1]), (fixed[row + 1], between[-2])):
        end = here.copy()
        end[before.axis] = level
        ends.append(end)
    return ends


def _labelled(
    segments: Segments, samples: PathSamples, *, station: Floats, rapid: float
) -> Rebuilt:
    """Segments with their rapids and block numbers, cut where rapid and feed change."""
    row, along = _places(segments, samples, station=station)
    for index in range(len(segments) - 1, -1, -1):
        here = row == index
        cut = _change(samples.is_rapid[here], along[here])
        if cut is not None:
            segments = _cut(segments, index, at=cut)
    row, _ = _places(segments, samples, station=station)
    is_rapid = np.zeros(len(segments), dtype=np.bool_)
    seen = np.zeros(len(segments))
    for index in range(len(segments)):
        here = row == index
        if here.any():
            is_rapid[index] = samples.is_rapid[here].mean() > HALF
            numbers, counts = np.unique(samples.block[here], return_counts=True)
            seen[index] = numbers[np.argmax(counts)]
        elif index:
            is_rapid[index], seen[index] = is_rapid[index - 1], seen[index - 1]
    speed = np.where(is_rapid, rapid, 1.0)
    return Rebuilt(segments=replace(segments, is_rapid=is_rapid, speed=speed), seen_block=seen)


def _places(
    segments: Segments, samples: PathSamples, *, station: Floats
) -> tuple[Ints, Floats]:
    """Segment on which each sample lies, and how far along.

    The share of the way behind a sample stands in for block numbers, which segments do not
    have yet.
    """
    ends = np.cumsum(segments.length)
    share = 100.0 * (ends - 0.5 * segments.length) / ends[-1]
    known = replace(samples, block=100.0 * station / station[-1])
    place = stations(known, course_of(segments, share))
    row = np.minimum(np.searchsorted(ends, place), len(segments) - 1)
    return row, place - (ends - segments.length)[row]


def _change(is_rapid: Bools, along: Floats) -> float | None:
    """Where on a segment rapid and feed change; ``None``: nowhere."""
    if not is_rapid.any() or is_rapid.all():
        return None
    starts_rapid = along[is_rapid].mean() < along[~is_rapid].mean()
    before, after = (is_rapid, ~is_rapid) if starts_rapid else (~is_rapid, is_rapid)
    low, high = float(along[before].max()), float(along[after].min())
    return 0.5 * (low + high) if high - low > -SPACING and before.sum() > 1 < after.sum() else None


def _cut(segments: Segments, row: int, *, at: float) -> Segments:
    """The segments, one line in two."""
    if segments.turn[row] != 0.0:
        return segments
    point = segments.position(np.array([row]), np.array([at]))
    order = np.insert(np.arange(len(segments)), row, row)
    twice = segments[order]
    end, start = twice.end.copy(), twice.start.copy()
    end[row], start[row + 1] = point[0], point[0]
    return replace(twice, start=start, end=end, block=np.arange(len(order)))
