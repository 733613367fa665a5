"""Axis-parallel lines in a sequence of rounded positions.

A line is where two coordinates stay while the third goes on; where a coordinate lies near the
edge of its rounding step, a line shows as several stretches side by side. Units mm.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmarks.logged_path.sampled_path import PathSamples
from simulator.motion.segments import Floats

SHORTEST = 0.85  # mm that a coordinate changes along a line, beyond its rounding
FEWEST = 5
"""samples on a line"""
NEVER = 1e-9  # mm, lengths below this are none
UP = 2
"""axis Z"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisLine:
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


def straight_lines(samples: PathSamples) -> list[AxisLine]:
    """Longest stretches in which two coordinates stay, in the order of the samples."""
    found = [line for axis in range(3) for line in _stretches(samples, axis)]
    kept: list[AxisLine] = []
    for line in sorted(found, key=lambda line: line.rows):
        if kept and _is_same(kept[-1], line, samples.half_step):
            if line.length > kept[-1].length:
                kept[-1] = line
        else:
            kept.append(line)
    return _with_crossings(kept, samples)


def _with_crossings(lines: list[AxisLine], samples: PathSamples) -> list[AxisLine]:
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
            path.append(AxisLine(axis=1 - line.axis, first=first, last=last, rows=rows))
        path.append(line)
    return path


def _stretches(samples: PathSamples, axis: int) -> list[AxisLine]:
    """Stretches along one axis."""
    position = samples.position
    others = [other for other in range(3) if other != axis]
    breaks = np.abs(np.diff(position[:, others], axis=0)).max(axis=1) > NEVER
    edges = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(position)]])
    lines = [
        AxisLine(axis=axis, first=position[low], last=position[high - 1], rows=(low, high - 1))
        for low, high in pairwise(edges.tolist())
    ]
    rounding = samples.half_step[:, axis]
    return [
        line
        for line in lines
        if line.rows[1] - line.rows[0] >= FEWEST - 1
        and line.length >= SHORTEST + rounding[list(line.rows)].sum()
    ]


def _is_same(before: AxisLine, after: AxisLine, half_step: Floats) -> bool:
    """True if two stretches are one line, cut where its rounded coordinate flips."""
    step = 2.0 * half_step[after.rows[0]] + NEVER
    step[after.axis] = np.inf
    return before.axis == after.axis and bool((np.abs(after.first - before.last) <= step).all())
