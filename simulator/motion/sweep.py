"""Fastest motion along a path within its limits and the permitted corner speeds.

In b = v² an acceleration limit reads ``|Δb| ≤ 2·a·L``, so that a backward and a forward sweep
over the corners give the greatest b at each, [2]_. The speed on each segment is a trapezoid or
a triangle between the speeds at its ends, [1]_.

A segment has up to three phases of constant acceleration along the path: speeding up, constant
speed, slowing down. Within a phase the station is a parabola in time, so that position,
velocity and acceleration are exact at any time. Units mm, s.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (1)-(4),
   doi:10.1080/00207543.2015.1064182. Printed from rest to rest, without the triangle of moves
   too short to reach their speed, and with v where the deceleration needs its own symbol.
.. [2] D. Verscheure et al., "Time-optimal path tracking for robots: a convex optimization
   approach", IEEE Trans. Autom. Control 54 (2009) 2318-2327: b = v² over the station.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.path_limits import PathLimits
from simulator.motion.segments import Floats, Ints, Kinematics, Segments


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Phases:
    """Motion in P phases of constant acceleration along the path, ascending in time."""

    segments: Segments
    ends: Floats
    """End time of each segment, (N,), s."""
    segment: Ints
    """Row of the segment, (P,)."""
    start: Floats
    """Start time of the phase, (P,), s."""
    time: Floats
    """Duration of the phase, (P,), s."""
    station: Floats
    """Position along the segment at the start of the phase, (P,), mm."""
    speed: Floats
    """Speed at the start of the phase, (P,), mm/s."""
    acceleration: Floats
    """Acceleration along the path, (P,), mm/s²."""

    @property
    def duration(self) -> float:
        """Duration of the whole stretch, s."""
        return float(self.ends[-1])

    @property
    def knots(self) -> Floats:
        """Times at which phases begin and end, (P+1,), s."""
        return np.append(self.start, self.duration)

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) times in s, between 0 and the duration."""
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


def swept(
    segments: Segments, rows: Ints, *, limits: PathLimits, corner: Floats, pause: float = 0.0
) -> Phases:
    """Compute the fastest motion from rest to rest.

    Parameters
    ----------
    segments : Segments
        N segments of the path.
    rows : (R,) array of int
        Rows of the segments that take time, ascending.
    limits : PathLimits
        Limits on all N segments.
    corner : (R−1,) array, mm²/s²
        Greatest squared speed between one row and the next.
    pause : float, s
        Duration of a row without length.

    Returns
    -------
    Phases
    """
    if not len(rows):
        rows, corner, pause = np.array([0]), np.empty(0), 0.0
    length = segments.length[rows]
    profile = profiled(
        length,
        cap=limits.speed[rows] ** 2,
        acceleration=limits.acceleration[rows],
        corner=corner,
        rest=np.where(length > 0.0, 0.0, pause),
    )
    return Phases(
        segments=segments,
        ends=ends_of_all(len(segments), rows, profile.ends),
        segment=rows[profile.row],
        start=profile.start,
        time=profile.time,
        station=profile.station,
        speed=profile.speed,
        acceleration=profile.acceleration,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfileState:
    """State along the path at M times."""

    row: Ints
    station: Floats
    speed: Floats
    acceleration: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpeedProfile:
    """Speed along R rows of path over time, in P phases of constant acceleration."""

    length: Floats
    """Length of each row, (R,), mm."""
    ends: Floats
    """End time of each row, (R,), s."""
    row: Ints
    """Row of each phase, (P,)."""
    start: Floats
    """Start time of the phase, (P,), s."""
    time: Floats
    """Duration of the phase, (P,), s."""
    station: Floats
    """Position along the row at the start of the phase, (P,), mm."""
    speed: Floats
    """Speed at the start of the phase, (P,), mm/s."""
    acceleration: Floats
    """Acceleration along the path, (P,), mm/s²."""

    @property
    def duration(self) -> float:
        """Duration of all rows, s."""
        return float(self.ends[-1])

    def at(self, times: Floats) -> ProfileState:
        """State at (M,) times in s, between 0 and the duration."""
        phase = np.searchsorted(self.start[1:], times, side="right")
        passed = np.clip(times - self.start[phase], 0.0, self.time[phase])
        along = self.acceleration[phase]
        travelled = (self.speed[phase] + 0.5 * along * passed) * passed
        row = self.row[phase]
        return ProfileState(
            row=row,
            station=np.minimum(self.station[phase] + travelled, self.length[row]),
            speed=np.maximum(self.speed[phase] + along * passed, 0.0),
            acceleration=along,
        )

    def time_at(self, row: Ints, station: Floats) -> Floats:
        """Times at which positions along rows are reached, (M,), s."""
        offset = np.append(0.0, np.cumsum(self.length))
        goal = offset[row] + station
        begun = offset[self.row] + self.station
        phase = np.maximum(np.searchsorted(begun, goal, side="left") - 1, 0)
        left = np.maximum(goal - begun[phase], 0.0)
        speed, along = self.speed[phase], self.acceleration[phase]
        # 2·s/(v + √(v² + 2·a·s)) stays accurate where a is 0.
        root = speed + np.sqrt(np.maximum(speed**2 + 2.0 * along * left, 0.0))
        time = np.divide(2.0 * left, root, out=np.zeros(len(left)), where=root > 0.0)
        return self.start[phase] + np.minimum(time, self.time[phase])


def profiled(
    length: Floats, *, cap: Floats, acceleration: Floats, corner: Floats, rest: Floats
) -> SpeedProfile:
    """Fastest trapezoids along rows of path, from rest to rest.

    Parameters
    ----------
    length : (R,) array, mm
    cap : (R,) array, mm²/s²
        Greatest squared speed.
    acceleration : (R,) array, mm/s²
    corner : (R−1,) array, mm²/s²
        Greatest squared speed between one row and the next.
    rest : (R,) array, s
        Wait at the end of a row.
    """
    reach = np.zeros(len(length))
    np.multiply(2.0 * acceleration, length, out=reach, where=length > 0.0)
    squares = _node_squares(np.minimum(corner, np.minimum(cap[1:], cap[:-1])), reach)
    before, after = squares[:-1], squares[1:]
    top = np.minimum(cap, 0.5 * (before + after + reach))
    top = np.maximum(top, np.maximum(before, after))
    entry, peak, leave = np.sqrt(before), np.sqrt(top), np.sqrt(after)
    rise, fall = 0.5 * (top - before) / acceleration, 0.5 * (top - after) / acceleration
    run = np.zeros(len(length))
    np.divide(np.maximum(length - rise - fall, 0.0), peak, out=run, where=peak > 0.0)
    zero = np.zeros(len(length))
    times = _interleaved(
        (peak - entry) / acceleration, run, (peak - leave) / acceleration, rest
    )
    clock = np.append(0.0, np.cumsum(times))
    kept = np.diff(clock) > 0.0
    kept[1] |= not kept.any()  # a path without length has one phase at rest
    return SpeedProfile(
        length=length,
        ends=clock[4::4],
        row=np.repeat(np.arange(len(length)), 4)[kept],
        start=clock[:-1][kept],
        time=times[kept],
        station=_interleaved(zero, rise, length - fall, length)[kept],
        speed=_interleaved(entry, peak, peak, zero)[kept],
        acceleration=_interleaved(acceleration, zero, -acceleration, zero)[kept],
    )


def _node_squares(corner: Floats, reach: Floats) -> Floats:
    """Greatest squared speeds at corners, (R+1,), that accelerations between them permit."""
    squares: list[float] = [0.0, *corner.tolist(), 0.0]
    steps: list[float] = reach.tolist()
    for row in range(len(steps) - 1, -1, -1):
        squares[row] = min(squares[row], squares[row + 1] + steps[row])
    for row, step in enumerate(steps):
        squares[row + 1] = min(squares[row + 1], squares[row] + step)
    return np.array(squares)


def _interleaved(*phases: Floats) -> Floats:
    """Interleave the values of the phases of each row."""
    return np.stack(phases, axis=1).ravel()


def ends_of_all(count: int, rows: Ints, ends: Floats) -> Floats:
    """End time of each segment, (N,); a segment without duration ends with the previous row."""
    known = np.append(0.0, ends)
    return known[np.searchsorted(rows, np.arange(count), side="right")]
