"""What the sensors of the virtual machine show: one row a sample.

Units mm, s, N, W, rev/s; the names that the outside reads, and its units, are those of
:mod:`simulator.timeline`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from simulator.motion.segments import Floats, Ints


class Direction(IntEnum):
    """Which way an axis moves."""

    NEGATIVE = 0
    NONE = 1
    POSITIVE = 2


class Rotation(IntEnum):
    """Which way the spindle turns, as MTConnect names it; M3 is clockwise."""

    COUNTER_CLOCKWISE = 0
    NONE = 1
    CLOCKWISE = 2


class Execution(IntEnum):
    """What the control does, as MTConnect names it."""

    READY = 0
    ACTIVE = 1
    WAIT = 2
    """dwell, tool change, waiting for the spindle"""
    PROGRAM_STOPPED = 3
    PROGRAM_COMPLETED = 4


class PathMode(IntEnum):
    """How the axes move."""

    NONE = 0
    RAPID = 1
    FEED = 2


class Condition(IntEnum):
    """Health of the drives."""

    NORMAL = 0
    WARNING = 1
    """above the continuous power or the permitted force"""
    FAULT = 2
    """half as much again"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """M samples, ascending in time."""

    time: Floats
    """(M,) s from the start of the program"""
    position: Floats
    """(M, 3) mm, of the tool in the program's coordinates"""
    velocity: Floats
    """(M, 3) mm/s"""
    feed_programmed: Floats
    """(M,) mm/s; 0 in rapid and at rest"""
    spindle_programmed: Floats
    """(M,) rev/s, signed: positive clockwise"""
    spindle_speed: Floats
    """(M,) rev/s, signed"""
    axis_power: Floats
    """(M, 3) W"""
    spindle_power: Floats
    """(M,) W, cutting included"""
    coolant_power: Floats
    """(M,) W"""
    base_power: Floats
    """(M,) W"""
    cutting_power: Floats
    """(M,) W at the edge"""
    cutting_force: Floats
    """(M,) N, tangential"""
    feed_force: Floats
    """(M,) N"""
    back_force: Floats
    """(M,) N"""
    removal_rate: Floats
    """(M,) mm³/s"""
    chip_thickness: Floats
    """(M,) mm, mean"""
    thrust: Floats
    """(M,) N, along the axis, of a drill or of a mill that goes straight down"""
    deflection: Floats
    """(M,) mm that an end mill gives way while it makes a wall"""
    axial_depth: Floats
    """(M,) mm"""
    radial_width: Floats
    """(M,) mm"""
    execution: Ints
    """(M,) :class:`Execution`"""
    path_mode: Ints
    """(M,) :class:`PathMode`"""
    coolant: Ints
    """(M,) 0 off, 1 on"""
    overload: Ints
    """(M,) :class:`Condition` of the spindle drive"""
    line: Ints
    """(M,) of the program"""
    tool: Ints
    """(M,) number of the tool, 0: none"""
    workingstep: Ints
    """(M,) which of the program's workingsteps runs, counted from 1; 0: none"""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def direction(self) -> Ints:
        """(M, 3) :class:`Direction` of the axes."""
        return 1 + np.sign(self.velocity).astype(np.int64)

    @property
    def rotation(self) -> Ints:
        """(M,) :class:`Rotation` of the spindle."""
        return 1 + np.sign(self.spindle_speed).astype(np.int64)

    @property
    def program(self) -> Ints:
        """(M,) which program runs: there is one."""
        return np.zeros(len(self), dtype=np.int64)

    @property
    def path_speed(self) -> Floats:
        """(M,) mm/s along the path."""
        speed: Floats = np.linalg.norm(self.velocity, axis=1)
        return speed

    @property
    def total_power(self) -> Floats:
        """(M,) W, of all components."""
        x, y, z = self.axis_power.T
        total: Floats = x + y + z + self.spindle_power + self.coolant_power + self.base_power
        return total


def joined(parts: Sequence[Samples]) -> Samples:
    """Samples one after another."""
    return Samples(**{
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Samples)
    })
