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

from benchmarks.logged_path.corners import Corners, CornerSamples, fitted
from benchmarks.logged_path.labels import labelled
from benchmarks.logged_path.rounded import rounded
from benchmarks.logged_path.sampled_path import (
    PathSamples,
    SampledPath,
    course_of,
    course_of_samples,
    joined,
    shifted,
    stations,
)
from benchmarks.logged_path.straight import SHORTEST, AxisLine, straight_lines
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Segments


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rebuilt:
    """A program as it was seen to run."""

    segments: Segments
    """N lines and arcs, each a block of its own numbered from 0; feeds are 1 mm/s"""
    seen_block: Floats
    """(N,) number of the program's block that the runs show most often on each"""

    def course(self) -> SampledPath:
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
    lines = straight_lines(every)
    if not lines:
        raise CalibrationError(
            f"no axis-parallel line of {SHORTEST} mm in {len(every)} samples"
        )
    vertices, radius = _path(lines, every)
    found = labelled(rounded(vertices, radius), every, station=station)
    speed = np.where(found.is_rapid, rapid, 1.0)
    return Rebuilt(
        segments=replace(found.segments, is_rapid=found.is_rapid, speed=speed),
        seen_block=found.seen_block,
    )


def _corners(lines: Sequence[AxisLine], samples: PathSamples) -> Corners:
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


def _middle(line: AxisLine) -> Floats:
    """Point in the middle of a line."""
    return 0.5 * (line.first + line.last)


def _is_flat(before: AxisLine, after: AxisLine) -> bool:
    """True if two lines lie in one plane of X and Y and meet at right angles."""
    return before.axis + after.axis == 1


def _path(lines: list[AxisLine], samples: PathSamples) -> tuple[Floats, Floats]:
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
    vertices, radii = [samples.position[0], fixed[0]], [0.0, 0.0]
    for row in range(len(lines) - 1):
        found = _meeting(lines, fixed, row, samples)
        vertices += found
        radii += [radius[row]] * len(found)
    end = fixed[-1].copy()
    end[lines[-1].axis] = samples.position[-1, lines[-1].axis]
    return np.array([*vertices, end]), np.array([*radii, 0.0])


def _meeting(
    lines: list[AxisLine], fixed: list[Floats], row: int, samples: PathSamples
) -> list[Floats]:
    """Intersection of a line with the next one; else both ends of the line that joins them."""
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
