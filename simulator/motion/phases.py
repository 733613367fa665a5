"""Motion whose acceleration along the path is constant by phases.

A segment has up to three: it speeds up, runs, slows down. Between the ends of a phase the
station is a parabola in time, so position, velocity and acceleration are exact at any time.
Units mm, s; references in :mod:`simulator.motion.sweep`.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.motion import Kinematics
from simulator.motion.segments import Floats, Ints, Segments


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Phases:
    """P phases, ascending in time; a motion."""

    segments: Segments
    ends: Floats
    """(N,) time at which each segment ends, s"""
    segment: Ints
    """(P,) row of the segment"""
    start: Floats
    """(P,) s"""
    time: Floats
    """(P,) s"""
    station: Floats
    """(P,) mm along the segment where the phase starts"""
    speed: Floats
    """(P,) mm/s there"""
    acceleration: Floats
    """(P,) mm/s² along the path"""

    @property
    def duration(self) -> float:
        """Time of the whole stretch, s."""
        return float(self.ends[-1])

    @property
    def knots(self) -> Floats:
        """(P+1,) times at which phases begin and end, s."""
        return np.append(self.start, self.duration)

    def at(self, times: Floats) -> Kinematics:
        """State at (M,) times in s between 0 and the duration."""
        phase = np.searchsorted(self.start[1:], times, side="right")
        passed = np.clip(times - self.start[phase], 0.0, self.time[phase])
        along = self.acceleration[phase]
        speed = np.maximum(self.speed[phase] + along * passed, 0.0)
        row = self.segment[phase]
        travelled = (self.speed[phase] + 0.5 * along * passed) * passed
        station = np.minimum(self.station[phase] + travelled, self.segments.length[row])
        direction = self.segments.direction(row, station)
        bend = self.segments.curvature(row, station)
        return Kinematics(
            position=self.segments.position(row, station),
            velocity=direction * speed[:, None],
            acceleration=direction * along[:, None] + bend * (speed**2)[:, None],
            segment=row,
            station=station,
        )
