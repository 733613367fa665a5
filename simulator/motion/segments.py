"""Lines and arcs of a path as arrays, and motion along them: position and speed by time.

One row a segment, each beginning where the one before it ends. Units mm, mm/s, rad.

A control model plans one stretch of path that begins and ends at rest. What it returns is
closed form in time: any sampling rate is exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.spec import Machine

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

FIRST, SECOND = (1, 2, 0), (2, 0, 1)
"""axes that span the plane whose normal is axis 0, 1 or 2: YZ, ZX, XY"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segments:
    """N lines and arcs, one after another.

    Raises
    ------
    ValueError
        When shapes differ or a number is not finite; a rapid's speed may be infinite.
    """

    start: Floats
    """Start, (N, 3), mm"""
    end: Floats
    """End, (N, 3), mm"""
    speed: Floats
    """Speed, (N,) commanded along the path, mm/s; infinite: as fast as the axes go"""
    is_rapid: Bools
    """(N,)"""
    centre: Floats
    """Centre, (N, 3), mm, of arcs; its coordinate along the normal means nothing"""
    turn: Floats
    """Turn, (N,) rad about the normal, positive counter-clockwise; 0: a line"""
    normal: Ints
    """Normal, (N,) axis of the plane's normal: 0, 1 or 2"""
    block: Ints
    """Block, (N,) number of the block from which a segment comes"""

    def __post_init__(self) -> None:
        count = len(self.turn)
        for name, shape in (
            ("start", (count, 3)),
            ("end", (count, 3)),
            ("centre", (count, 3)),
            ("turn", (count,)),
        ):
            value = getattr(self, name)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(f"{name} must be finite and of shape {shape}")
        for name in ("speed", "is_rapid", "normal", "block"):
            if getattr(self, name).shape != (count,):
                raise ValueError(f"{name} must have shape {(count,)}")
        if not (self.speed > 0.0).all():
            raise ValueError("speed must be positive")
        if not ((self.normal >= 0) & (self.normal <= 2)).all():
            raise ValueError("normal must be 0, 1 or 2")

    def __len__(self) -> int:
        return len(self.turn)

    def __getitem__(self, rows: slice | Ints | Bools) -> "Segments":
        """Some of the rows, which need no check again, with what is known of them."""
        part = object.__new__(Segments)
        vars(part).update((name, column[rows]) for name, column in vars(self).items())
        return part

    @cached_property
    def length(self) -> Floats:
        """(N,) mm along the path."""
        rows = np.arange(len(self))
        straight = np.linalg.norm(self.end - self.start, axis=1)
        rise = (self.end - self.start)[rows, self.normal]
        return np.where(self.turn == 0.0, straight, np.hypot(self.radius * self.turn, rise))

    @cached_property
    def radius(self) -> Floats:
        """(N,) mm, of arcs; 0 for lines."""
        first, second = self._plane(np.arange(len(self)))
        return np.where(self.turn == 0.0, 0.0, np.hypot(first, second))

    @cached_property
    def _along(self) -> Floats:
        """(N, 3) way of each axis per length of path, of arcs on the mean; 0 without length."""
        length = np.where(self.length > 0.0, self.length, 1.0)
        return (self.end - self.start) / length[:, None]

    @cached_property
    def _turn_rate(self) -> Floats:
        """(N,) rad/mm; 0 for lines."""
        return np.divide(
            self.turn, self.length, out=np.zeros(len(self)), where=self.length > 0.0
        )

    @cached_property
    def _start_angle(self) -> Floats:
        """(N,) rad, of the arm from the centre to the start."""
        first, second = self._plane(np.arange(len(self)))
        return np.arctan2(second, first)

    def _plane(self, rows: Ints) -> tuple[Floats, Floats]:
        """Arm from centre to start in its plane."""
        arm = self.start[rows] - self.centre[rows]
        order = np.arange(len(rows))
        normal = self.normal[rows]
        return arm[order, _FIRST[normal]], arm[order, _SECOND[normal]]

    def position(self, rows: Ints, station: Floats) -> Floats:
        """Position at a share of each segment.

        Parameters
        ----------
        rows : (M,) array of int
            Which segments.
        station : (M,) array, mm
            Along each of them, from 0 to its length.

        Returns
        -------
        (M, 3) array, mm
        """
        point = self.start[rows] + station[:, None] * self._along[rows]
        bent = self._bent(rows)
        if len(bent):
            row = rows[bent]
            normal, size = self.normal[row], self.radius[row]
            angle = self._angle(row, station[bent])
            first, second = _FIRST[normal], _SECOND[normal]
            point[bent, first] = self.centre[row, first] + size * np.cos(angle)
            point[bent, second] = self.centre[row, second] + size * np.sin(angle)
        return point

    def direction(self, rows: Ints, station: Floats) -> Floats:
        """Unit vectors along the path; zero where a segment has no length.

        Returns
        -------
        (M, 3) array
        """
        along = self._along[rows]
        bent = self._bent(rows)
        if len(bent):
            row = rows[bent]
            normal, angle = self.normal[row], self._angle(row, station[bent])
            rate = self.radius[row] * self._turn_rate[row]
            along[bent, _FIRST[normal]] = -rate * np.sin(angle)
            along[bent, _SECOND[normal]] = rate * np.cos(angle)
        return along

    def curvature(self, rows: Ints, station: Floats) -> Floats:
        """Change of direction along the path, a vector towards the centre; 0 on lines.

        Returns
        -------
        (M, 3) array, 1/mm
        """
        bend = np.zeros((len(rows), 3))
        bent = self._bent(rows)
        if len(bent):
            row = rows[bent]
            normal, angle = self.normal[row], self._angle(row, station[bent])
            rate = -self.radius[row] * self._turn_rate[row] ** 2
            bend[bent, _FIRST[normal]] = rate * np.cos(angle)
            bend[bent, _SECOND[normal]] = rate * np.sin(angle)
        return bend

    def _bent(self, rows: Ints) -> Ints:
        """Mask of the rows that are arcs."""
        return np.flatnonzero(self.turn[rows])

    def _angle(self, rows: Ints, station: Floats) -> Floats:
        """Angle of the arm from the centre of arcs, rad."""
        return self._start_angle[rows] + station * self._turn_rate[rows]


_FIRST = np.array(FIRST)
_SECOND = np.array(SECOND)


def lines(points: Sequence[Sequence[float] | Floats], *, speed: float = np.inf) -> Segments:
    """Straight segments through points, rapid unless a speed in mm/s is given."""
    corners = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    count = max(0, len(corners) - 1)
    return Segments(
        start=corners[:-1],
        end=corners[1:],
        speed=np.full(count, float(speed)),
        is_rapid=np.full(count, not np.isfinite(speed)),
        centre=np.zeros((count, 3)),
        turn=np.zeros(count),
        normal=np.full(count, 2),
        block=np.arange(count),
    )


def arc(
    start: Sequence[float],
    centre: Sequence[float],
    turn: float,
    *,
    normal: int = 2,
    rise: float = 0.0,
    speed: float = np.inf,
) -> Segments:
    """One arc, or a helix when it rises along its normal (axis 0, 1 or 2).

    Parameters
    ----------
    start, centre : sequence of 3 floats, mm
        The centre's coordinate along the normal means nothing.
    turn : float, rad
        Positive counter-clockwise, more than 2π for several turns.
    normal : int
        Axis of the plane's normal.
    rise : float, mm
    speed : float, mm/s
        Infinite: a rapid.
    """
    first, second = FIRST[normal], SECOND[normal]
    end = np.array(start, dtype=np.float64)
    arm = complex(start[first] - centre[first], start[second] - centre[second])
    turned = arm * complex(np.cos(turn), np.sin(turn))
    end[first], end[second] = centre[first] + turned.real, centre[second] + turned.imag
    end[normal] += rise
    return replace(
        lines([start, end], speed=speed),
        centre=np.array([centre], dtype=np.float64),
        turn=np.array([float(turn)]),
        normal=np.array([normal]),
    )


def chained(parts: Sequence[Segments]) -> Segments:
    """Segments of several parts one after another, each segment a block of its own."""
    columns = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Segments)
    }
    columns["block"] = np.arange(len(columns["turn"]))
    return Segments(**columns)


AXES = ("X", "Y", "Z")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisLimits:
    """Limits of the axes; an axis that the machine lacks is not limited.

    Raises
    ------
    ValueError
        When a limit of an axis is not positive, or the block time is negative.
    """

    acceleration: Floats
    """Acceleration, (3,) mm/s²"""
    rapid: Floats
    """Rapid, (3,) mm/s"""
    feed: Floats
    """Feed, (3,) mm/s, greatest feed"""
    block_time: float = 0.0
    """Block time, s, the control's processing time of one block"""
    jerk: Floats = field(default_factory=lambda: np.full(3, np.inf))
    """Jerk, (3,) mm/s³"""

    def __post_init__(self) -> None:
        for name in ("acceleration", "rapid", "feed", "jerk"):
            value = getattr(self, name)
            if value.shape != (3,) or not (value > 0.0).all():
                raise ValueError(f"{name} of X, Y and Z must be positive, got {value}")
        if not 0.0 <= self.block_time < np.inf:
            raise ValueError(f"block time {self.block_time:g} s must not be negative")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Kinematics:
    """State of the axes at M times."""

    position: Floats
    """Position, (M, 3) mm"""
    velocity: Floats
    """Velocity, (M, 3) mm/s"""
    acceleration: Floats
    """Acceleration, (M, 3) mm/s²"""
    segment: Ints
    """Segment, (M,) row of the segment that runs"""
    station: Floats
    """Station, (M,) mm along that segment"""


class Motion(Protocol):
    """A stretch of path by time, from rest to rest."""

    @property
    def duration(self) -> float:
        """Time of the whole stretch, s."""
        ...

    @property
    def ends(self) -> Floats:
        """(N,) time at which each segment ends, s, ascending; the last is the duration."""
        ...

    @property
    def knots(self) -> Floats:
        """(K,) times from 0 to the duration between which speeds are smooth, s."""
        ...

    def at(self, times: Floats) -> Kinematics:
        """State at (M,) times in s, ascending, between 0 and the duration."""
        ...


class ControlModel(Protocol):
    """Control model: makes the motion of a path."""

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Motion along segments, from rest to rest."""
        ...


def axis_limits(machine: Machine) -> AxisLimits:
    """Limits of a machine's axes in the order X, Y, Z."""
    axes = {axis.name: axis for axis in machine.axes}
    acceleration, rapid, feed, jerk = (np.full(3, np.inf) for _ in range(4))
    for row, name in enumerate(AXES):
        if name in axes:
            acceleration[row] = axes[name].acceleration
            rapid[row] = axes[name].rapid
            feed[row] = axes[name].max_feed
            jerk[row] = axes[name].jerk or np.inf
    return AxisLimits(
        acceleration=acceleration,
        rapid=rapid,
        feed=feed,
        block_time=machine.block_time or 0.0,
        jerk=jerk,
    )
