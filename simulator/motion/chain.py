"""Motions one after another, each from rest to rest, as one. Units mm, s."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from simulator.motion.motion import Kinematics, Motion
from simulator.motion.segments import Floats, Ints


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """Motions of consecutive rows of one stretch; a motion.

    Raises
    ------
    ValueError
        When there is no motion.
    """

    motions: Sequence[Motion]

    def __post_init__(self) -> None:
        if not self.motions:
            raise ValueError("a chain needs at least one motion")

    @cached_property
    def starts(self) -> Floats:
        """(K + 1,) s at which motions begin, and the last one ends."""
        durations = [motion.duration for motion in self.motions]
        return np.concatenate(([0.0], np.cumsum(durations)))

    @cached_property
    def first_rows(self) -> Ints:
        """(K,) row with which each motion begins."""
        counts = [len(motion.ends) for motion in self.motions]
        return np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)

    @property
    def duration(self) -> float:
        """Time of all, s."""
        return float(self.starts[-1])

    @cached_property
    def ends(self) -> Floats:
        """(N,) s at which each segment ends."""
        return self._after_one_another([motion.ends for motion in self.motions])

    @cached_property
    def knots(self) -> Floats:
        """(K,) times between which speeds are smooth, s."""
        return np.unique(self._after_one_another([motion.knots for motion in self.motions]))

    def at(self, times: Floats) -> Kinematics:
        """State at (M,) times in s, ascending, between 0 and the duration."""
        which = np.searchsorted(self.starts[1:-1], times, side="right")
        bounds = np.searchsorted(which, np.arange(len(self.motions) + 1))
        parts = [
            self._part(row, times[begin:end])
            for row, (begin, end) in enumerate(pairwise(bounds.tolist()))
            if end > begin
        ]
        return Kinematics(
            position=np.concatenate([part.position for part in parts]),
            velocity=np.concatenate([part.velocity for part in parts]),
            acceleration=np.concatenate([part.acceleration for part in parts]),
            segment=np.concatenate([part.segment for part in parts]),
            station=np.concatenate([part.station for part in parts]),
        )

    def _part(self, row: int, times: Floats) -> Kinematics:
        """State at times that belong to one motion."""
        motion = self.motions[row]
        since = np.clip(times - self.starts[row], 0.0, motion.duration)
        at = motion.at(since)
        return Kinematics(
            position=at.position,
            velocity=at.velocity,
            acceleration=at.acceleration,
            segment=at.segment + self.first_rows[row],
            station=at.station,
        )

    def _after_one_another(self, times: Sequence[Floats]) -> Floats:
        shifted = [start + each for start, each in zip(self.starts[:-1], times, strict=True)]
        # Rounding of a sum must not pass what comes next.
        return np.minimum(np.maximum.accumulate(np.concatenate(shifted)), self.starts[-1])
