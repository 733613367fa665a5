"""What a control makes of a path: position, speed and acceleration by time.

A control model plans one stretch of path that begins and ends at rest. What it returns is
closed form in time: any sampling rate is exact. Units mm, s.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from simulator.motion.segments import Floats, Ints, Segments
from simulator.spec import Machine

AXES = ("X", "Y", "Z")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisLimits:
    """What the axes can do; an axis that the machine has not is not limited.

    Raises
    ------
    ValueError
        When a limit of an axis is not positive, or the block time is negative.
    """

    acceleration: Floats
    """(3,) mm/s²"""
    rapid: Floats
    """(3,) mm/s"""
    feed: Floats
    """(3,) mm/s, greatest feed"""
    block_time: float = 0.0
    """s, the control's processing time of one block"""
    jerk: Floats = field(default_factory=lambda: np.full(3, np.inf))
    """(3,) mm/s³"""

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
    """(M, 3) mm"""
    velocity: Floats
    """(M, 3) mm/s"""
    acceleration: Floats
    """(M, 3) mm/s²"""
    segment: Ints
    """(M,) row of the segment that runs"""
    station: Floats
    """(M,) mm along that segment"""


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
    """How a control runs a path."""

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
