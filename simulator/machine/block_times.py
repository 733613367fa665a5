"""Time of each block of a program: as programmed, by the block rate, and by the control.

The time as programmed is length over feed. The block rate and the feed of the axes lower the
feed of a block to ``min(F, s/t_block, v_axes)``, [1]_; this is the estimate of the paper and
what a program with reachable feeds would have. What acceleration, corners and filter add is the
difference to the time of the control's motion. Units mm, mm/s, s.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009, "Methodology": the modified program.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import Any

import numpy as np

from simulator.machine.samples import Episode, EpisodeCourse
from simulator.motion.path_limits import corners, path_limits
from simulator.motion.segments import AxisLimits, Floats, Ints

NOTHING = 1e-9
"""Time below which a block loses none, s."""

LEAST_ANGLE = 1e-4
"""Angle between two lines below which the path counts as straight, rad."""


class LossCause(IntEnum):
    """Cause that makes a block take longer than programmed."""

    NONE = 0
    BLOCK_RATE = 1
    AXES = 2
    """Greatest feed of an axis, or its acceleration on an arc."""
    MOTION = 3
    """Acceleration, corners, and the filter of the control."""

    @property
    def words(self) -> str:
        """Cause in words."""
        return ("", "block rate", "feed of the axes", "acceleration and corners")[self]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockTimes:
    """Times of N blocks in the order of the run, and of waits between them."""

    line: Ints
    """Number of the block in the program, (N,)."""
    workingstep: Ints
    """Number of the workingstep, (N,); 0 before the first."""
    tool: Ints
    """Number of the tool, (N,)."""
    is_rapid: Ints
    """1 for a rapid, 0 for a feed move, −1 for a wait, (N,)."""
    length: Floats
    """Length of the path, (N,), mm."""
    programmed: Floats
    """Length over feed, or the wait, (N,), s."""
    by_rate: Floats
    """Time at the feed that block rate and axes allow, (N,), s."""
    predicted: Floats
    """Time by the model of the control, (N,), s."""
    by_axes: Floats
    """Time at the feed that the axes allow, (N,), s."""
    radius: Floats
    """Radius of the path at the end of the block, (N,), mm; infinite on a straight."""

    def __len__(self) -> int:
        return len(self.line)

    @property
    def lost(self) -> Floats:
        """Time beyond the programmed one, (N,), s."""
        return self.predicted - self.programmed

    @property
    def cause(self) -> Ints:
        """Largest cause of each block's loss, (N,), numbers of :class:`LossCause`."""
        axes = np.maximum(self.by_axes - self.programmed, 0.0)
        rate = np.maximum(self.by_rate - self.by_axes, 0.0)
        motion = np.maximum(self.predicted - self.by_rate, 0.0)
        parts = np.stack([np.full(len(self), NOTHING), rate, axes, motion])
        cause: Ints = np.argmax(parts, axis=0)
        return cause

    @property
    def reached(self) -> Floats:
        """Share of the programmed feed that block rate and axes allow, (N,)."""
        share = np.ones(len(self))
        np.divide(self.programmed, self.by_rate, out=share, where=self.by_rate > 0.0)
        return np.minimum(share, 1.0)


def block_times(episodes: Iterable[Episode], limits: AxisLimits) -> BlockTimes:
    """Times of all blocks of a run.

    Parameters
    ----------
    limits : AxisLimits
        Those of the machine that runs.
    """
    parts = [_none(), *_parts(episodes, limits)]
    columns: dict[str, Any] = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(BlockTimes)
    }
    return BlockTimes(**columns)


def _none() -> BlockTimes:
    """Times of no block."""
    whole, real = np.zeros(0, dtype=np.int64), np.zeros(0)
    return BlockTimes(
        line=whole,
        workingstep=whole,
        tool=whole,
        is_rapid=whole,
        length=real,
        programmed=real,
        by_rate=real,
        by_axes=real,
        predicted=real,
        radius=real,
    )


def _parts(episodes: Iterable[Episode], limits: AxisLimits) -> Iterator[BlockTimes]:
    for episode in episodes:
        if episode.course is not None:
            yield _moves(episode, episode.course, limits)
        elif episode.end > episode.begin:
            yield _wait(episode)


def _wait(episode: Episode) -> BlockTimes:
    """A dwell, tool change or wait for the spindle, which takes as long as it takes."""
    seconds, state = np.array([episode.end - episode.begin]), episode.state
    return BlockTimes(
        line=np.array([state.line]),
        workingstep=np.array([state.workingstep]),
        tool=np.array([state.tool]),
        is_rapid=np.array([-1]),
        length=np.zeros(1),
        programmed=seconds,
        by_rate=seconds,
        by_axes=seconds,
        predicted=seconds,
        radius=np.full(1, np.inf),
    )


def _moves(episode: Episode, course: EpisodeCourse, limits: AxisLimits) -> BlockTimes:
    """Blocks of a stretch; pieces of one block are added up."""
    segments = course.segments
    starts = np.flatnonzero(np.append(True, np.diff(segments.block) != 0))
    within = path_limits(segments, limits).speed
    unhindered = path_limits(segments, replace(limits, block_time=0.0)).speed
    is_rapid = segments.is_rapid.astype(np.int64)
    programmed = np.where(segments.is_rapid, unhindered, segments.speed)

    def summed(values: Floats) -> Floats:
        whole: Floats = np.add.reduceat(values, starts)
        return whole

    def time_at(speed: Floats) -> Floats:
        seconds = np.zeros(len(segments))
        np.divide(segments.length, speed, out=seconds, where=speed > 0.0)
        return summed(seconds)

    count = len(starts)
    return BlockTimes(
        line=segments.block[starts],
        workingstep=np.full(count, episode.state.workingstep),
        tool=np.full(count, episode.state.tool),
        is_rapid=is_rapid[starts],
        length=summed(segments.length),
        programmed=time_at(programmed),
        by_rate=time_at(within),
        by_axes=time_at(unhindered),
        predicted=summed(np.diff(course.motion.ends, prepend=0.0)),
        radius=_radii(course)[np.append(starts[1:], len(segments)) - 1],
    )


def _radii(course: EpisodeCourse) -> Floats:
    """Radius of the circle through the ends of each segment and of the next, (N,), mm."""
    segments = course.segments
    radius = np.full(len(segments), np.inf)
    if len(segments) > 1:
        before, after = corners(segments)
        angle = np.linalg.norm(after - before, axis=1)
        mean = 0.5 * (segments.length[:-1] + segments.length[1:])
        np.divide(mean, angle, out=radius[:-1], where=angle > LEAST_ANGLE)
    return radius
