"""Exact stop: every block from rest to rest, as the papers on virtual machining model it.

A trapezoid of speed, or a triangle where the block is too short to reach its speed. Pieces of
one block that goes straight on are one move. A feed block without length takes the control's
block time. Units mm, s; references in :mod:`simulator.motion.sweep`.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.motion import AxisLimits
from simulator.motion.path_limits import block_lengths, goes_on, path_limits
from simulator.motion.phases import Phases
from simulator.motion.segments import Segments
from simulator.motion.sweep import swept


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactStop:
    """A control that waits at the end of each block until the axes stand."""

    def plan(self, segments: Segments, limits: AxisLimits) -> Phases:
        """Motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            When there is no segment, or a segment's speed has no bound at all.
        """
        bounds = path_limits(segments, limits)
        is_pause = (block_lengths(segments) == 0.0) & ~segments.is_rapid
        rows = np.flatnonzero((segments.length > 0.0) | is_pause)
        corner = np.where(goes_on(segments[rows]), np.inf, 0.0)
        pause = limits.block_time
        return swept(segments, rows, limits=bounds, corner=corner, pause=pause)
