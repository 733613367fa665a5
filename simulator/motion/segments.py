"""Lines and arcs of a path as arrays, and types for motion along them over time.

There is one row per segment; each segment begins where the previous one ends. Units mm, mm/s,
rad.

A control model plans one stretch of path that begins and ends at rest. The resulting motion has
a closed form in time, so that it is exact at any sampling rate.

Legs of a tool path from rest to rest, and the spindle during them. Units s, rev/s.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from simulator.spec import Machine
from stepnc_model.toolpath.arc_columns import FIRST, SECOND, arms, lengths

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

Number = TypeVar("Number", np.float64, np.int64)


@dataclass(frozen=True, kw_only=True, eq=False)
class Segments:
    """Path of N consecutive lines and arcs.

    Raises
    ------
    ValueError
        If shapes differ or a number is not finite; a rapid's speed may be infinite.
    """

    start: Floats
    """Start points, (N, 3), mm."""
    end: Floats
    """End points, (N, 3), mm."""
    speed: Floats
    """Commanded speed along the path, (N,), mm/s; infinite: limited by the axes only."""
    is_rapid: Bools
    """Whether the segment is a rapid, (N,)."""
    centre: Floats
    """Centre points of arcs, (N, 3), mm; the coordinate along the normal is ignored."""
    turn: Floats
    """Angle of the arc about its normal, (N,), rad, counter-clockwise; 0 for a line."""
    normal: Ints
    """Axis normal to the plane of the arc, (N,): 0, 1 or 2."""
    block: Ints
    """Number of the block to which a segment belongs, (N,)."""

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
        """Select rows without checking them again, together with cached properties."""
        part = object.__new__(Segments)
        vars(part).update((name, column[rows]) for name, column in vars(self).items())
        return part

    @cached_property
    def length(self) -> Floats:
        """Length along the path, (N,), mm."""
        return lengths(
            self.start, self.end, radius=self.radius, turn=self.turn, normal=self.normal
        )

    @cached_property
    def radius(self) -> Floats:
        """Radius of arcs, (N,), mm; 0 for lines."""
        first, second = arms(self.start, self.centre, self.normal)
        return np.where(self.turn == 0.0, 0.0, np.hypot(first, second))

    @cached_property
    def _along(self) -> Floats:
        """Mean movement of each axis per length of path, (N, 3); 0 without length."""
        length = np.where(self.length > 0.0, self.length, 1.0)
        return (self.end - self.start) / length[:, None]

    @cached_property
    def _turn_rate(self) -> Floats:
        """Rate of turning along the path, (N,), rad/mm; 0 for lines."""
        return np.divide(
            self.turn, self.length, out=np.zeros(len(self)), where=self.length > 0.0
        )

    @cached_property
    def bend(self) -> Floats:
        """Curvature, (N,), 1/mm; 0 for lines."""
        return self.radius * self._turn_rate**2

    @cached_property
    def in_plane(self) -> Floats:
        """Movement in the plane of arcs per length of path, (N,); 0 for lines."""
        return self.radius * np.abs(self._turn_rate)

    @cached_property
    def greatest_shares(self) -> Floats:
        """Greatest movement of each axis per length of path, (N, 3)."""
        is_in_plane = np.arange(3) != self.normal[:, None]
        is_arc = self.turn[:, None] != 0.0
        return np.where(is_arc & is_in_plane, self.in_plane[:, None], np.abs(self._along))

    @cached_property
    def start_angle(self) -> Floats:
        """Angle of the start point of arcs from the centre, (N,), rad."""
        first, second = arms(self.start, self.centre, self.normal)
        return np.arctan2(second, first)

    def position(self, rows: Ints, station: Floats) -> Floats:
        """Position at a distance along each segment.

        Parameters
        ----------
        rows : (M,) array of int
            Indices of segments.
        station : (M,) array, mm
            Distance along each segment, from 0 to its length.

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
            first, second = FIRST[normal], SECOND[normal]
            point[bent, first] = self.centre[row, first] + size * np.cos(angle)
            point[bent, second] = self.centre[row, second] + size * np.sin(angle)
        return point

    def direction(self, rows: Ints, station: Floats) -> Floats:
        """Unit vectors along the path; zero if a segment has no length.

        Returns
        -------
        (M, 3) array
        """
        along = self._along[rows]
        bent = self._bent(rows)
        if len(bent):
            row = rows[bent]
            normal, angle = self.normal[row], self._angle(row, station[bent])
            rate = np.copysign(self.in_plane[row], self.turn[row])
            along[bent, FIRST[normal]] = -rate * np.sin(angle)
            along[bent, SECOND[normal]] = rate * np.cos(angle)
        return along

    def curvature(self, rows: Ints, station: Floats) -> Floats:
        """Curvature vector of the path, towards the centre; 0 on lines.

        Returns
        -------
        (M, 3) array, 1/mm
        """
        bend = np.zeros((len(rows), 3))
        bent = self._bent(rows)
        if len(bent):
            row = rows[bent]
            normal, angle = self.normal[row], self._angle(row, station[bent])
            rate = -self.bend[row]
            bend[bent, FIRST[normal]] = rate * np.cos(angle)
            bend[bent, SECOND[normal]] = rate * np.sin(angle)
        return bend

    def _bent(self, rows: Ints) -> Ints:
        """Positions in ``rows`` of the segments that are arcs."""
        return np.flatnonzero(self.turn[rows])

    def _angle(self, rows: Ints, station: Floats) -> Floats:
        """Angle of a point on arcs from the centre, rad."""
        return self.start_angle[rows] + station * self._turn_rate[rows]


def distinct(values: NDArray[Number]) -> NDArray[Number]:
    """Values in ascending order, each once; ``np.unique`` would import masked arrays first."""
    found = np.sort(values, axis=None)
    return found[np.append(True, found[1:] != found[:-1])] if len(found) else found


def lines(points: Sequence[Sequence[float] | Floats], *, speed: float = np.inf) -> Segments:
    """Create straight segments through points; rapids unless a speed in mm/s is given."""
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
    """Create an arc, or a helix if it rises along its normal (axis 0, 1 or 2).

    Parameters
    ----------
    start, centre : sequence of 3 floats, mm
        The coordinate of the centre along the normal is ignored.
    turn : float, rad
        Positive counter-clockwise; more than 2π for several turns.
    normal : int
        Axis normal to the plane.
    rise : float, mm
    speed : float, mm/s
        Infinite for a rapid.
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
    """Concatenate segments; each segment becomes a block of its own."""
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
        If a limit of an axis is not positive, or the block time is negative.
    """

    acceleration: Floats
    """Greatest acceleration of X, Y and Z, (3,), mm/s²."""
    rapid: Floats
    """Rapid speed of X, Y and Z, (3,), mm/s."""
    feed: Floats
    """Greatest feed of X, Y and Z, (3,), mm/s."""
    block_time: float = 0.0
    """Processing time of the control per block, s."""
    jerk: Floats = field(default_factory=lambda: np.full(3, np.inf))
    """Greatest jerk of X, Y and Z, (3,), mm/s³."""

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
    """Position, (M, 3), mm."""
    velocity: Floats
    """Velocity, (M, 3), mm/s."""
    acceleration: Floats
    """Acceleration, (M, 3), mm/s²."""
    segment: Ints
    """Row of the current segment, (M,)."""
    station: Floats
    """Position along the current segment, (M,), mm."""


class Motion(Protocol):
    """Motion along a stretch of path over time, from rest to rest."""

    @property
    def duration(self) -> float:
        """Duration of the whole stretch, s."""
        ...

    @property
    def ends(self) -> Floats:
        """End time of each segment, (N,), s, ascending; the last is the duration."""
        ...

    @property
    def knots(self) -> Floats:
        """Times from 0 to the duration between which speeds are smooth, (K,), s."""
        ...

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) ascending times in s, between 0 and the duration."""
        ...


class ControlModel(Protocol):
    """Control model that plans the motion along a path."""

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Plan the motion along segments, from rest to rest."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleRamp:
    """Change of the spindle speed that begins with a leg, at constant surface speed."""

    speed: float
    """Speed to be reached, rev/s."""
    acceleration: float
    """Acceleration of the spindle, rev/s²; may be infinite."""
    is_awaited: bool
    """Whether the feed after the leg waits until the speed is reached."""

    def time_from(self, speed: float) -> float:
        """Time that the change takes from a speed in rev/s, s."""
        return abs(self.speed - speed) / self.acceleration

    def after(self, seconds: float, speed: float) -> float:
        """Speed some time after it was a given speed, rev/s."""
        change = self.acceleration * seconds if seconds > 0.0 else 0.0
        return min(max(self.speed, speed - change), speed + change)


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """Part of a run from rest to rest, by its rows, with the wait after it."""

    first: int
    last: int
    """Row after the last row of the leg."""
    wait: float
    """Waiting time after the leg, s."""
    ramp: SpindleRamp | None = None
    """Change of the spindle speed during rapids; None: the spindle follows, or keeps its
    speed."""
    spindle: float | None = None
    """Spindle speed at the end of a leg of feeds at constant surface speed, rev/s."""
