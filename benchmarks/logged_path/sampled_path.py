"""Positions threaded onto a path: where along it each sample was taken, without its time.

A sample goes to the nearest point of the path; where the path comes close to itself, the number
of the block that ran decides. Units mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Bools, Floats, Ints, Segments

SPACING = 0.1  # mm between the points of the path that are looked at
BLOCK_STEP = 0.1  # mm that a difference of one block number counts: logs lag by a few blocks


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathSamples:
    """N samples of where a program was, in any order."""

    position: Floats
    """(N, 3) mm, commanded"""
    block: Floats
    """(N,) number of the block that runs"""
    is_rapid: Bools
    """(N,)"""
    half_step: Floats
    """(N, 3) mm, half of the step to which the positions are rounded"""

    def __len__(self) -> int:
        return len(self.block)

    def __getitem__(self, rows: Ints | Bools) -> "PathSamples":
        """Some of the samples."""
        return PathSamples(
            position=self.position[rows],
            block=self.block[rows],
            is_rapid=self.is_rapid[rows],
            half_step=self.half_step[rows],
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledPath:
    """Points along a path, close together."""

    point: Floats
    """(M, 3) mm"""
    block: Floats
    """(M,)"""
    station: Floats
    """(M,) mm from the start of the path, ascending"""


def joined(parts: Sequence[PathSamples]) -> PathSamples:
    """Samples of several runs."""
    return PathSamples(
        position=np.concatenate([part.position for part in parts]),
        block=np.concatenate([part.block for part in parts]),
        is_rapid=np.concatenate([part.is_rapid for part in parts]),
        half_step=np.concatenate([part.half_step for part in parts]),
    )


def course_of_samples(samples: PathSamples) -> SampledPath:
    """The polyline through samples that are in order."""
    steps = np.linalg.norm(np.diff(samples.position, axis=0), axis=1)
    station = np.concatenate([[0.0], np.cumsum(steps)])
    fine = np.linspace(0.0, station[-1], max(2, int(station[-1] / SPACING)))
    point = np.stack(
        [np.interp(fine, station, samples.position[:, axis]) for axis in range(3)], axis=1
    )
    return SampledPath(point=point, block=np.interp(fine, station, samples.block), station=fine)


def course_of(segments: Segments, block: Floats) -> SampledPath:
    """Lines and arcs as points, each with the (N,) block number of its segment."""
    pieces = np.maximum(1, np.ceil(segments.length / SPACING)).astype(np.int64)
    rows = np.repeat(np.arange(len(segments)), pieces)
    order = np.arange(len(rows)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    along = (order + 0.5) / pieces[rows] * segments.length[rows]
    before = np.cumsum(segments.length) - segments.length
    return SampledPath(
        point=segments.position(rows, along),
        block=block[rows],
        station=before[rows] + along,
    )


def stations(samples: PathSamples, course: SampledPath) -> Floats:
    """Station of each sample on a course.

    Returns
    -------
    (N,) array, mm
    """
    return course.station[_nearest(samples, course)]


def shifted(samples: PathSamples, course: SampledPath) -> PathSamples:
    """Samples moved onto a course: work offsets differ from run to run.

    The offset is the median deviation, axis by axis; one below the rounding is none.
    """
    point = course.point[_nearest(samples, course)]
    deviation = np.median(samples.position - point, axis=0)
    coarse = np.median(samples.half_step, axis=0)
    offset = np.where(np.abs(deviation) > coarse, deviation, 0.0)
    return replace(samples, position=samples.position - offset)


def _nearest(samples: PathSamples, course: SampledPath) -> Ints:
    """(N,) which point of a course each sample belongs to."""
    tree = cKDTree(_weighted(course.point, course.block))
    nearest: Ints = tree.query(_weighted(samples.position, samples.block))[1]
    return nearest


def _weighted(point: Floats, block: Floats) -> Floats:
    """Positions and block numbers as points of one space."""
    return np.column_stack([point, BLOCK_STEP * block])
