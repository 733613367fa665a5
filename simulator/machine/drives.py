"""Electrical power of the machine's components, as arrays over time.

Units mm, s, N, W, rev/s.
"""

import numpy as np

from simulator.machine.samples import Condition
from simulator.motion.motion import AXES
from simulator.motion.segments import Floats, Ints
from simulator.physics.axis import axis_power
from simulator.physics.spindle import curve_segments
from simulator.physics.spindle_motion import spindle_power
from simulator.spec import Machine

FAULT_SHARE = 1.5
"""of the continuous power: what a drive gives for a minute at most, customary"""


def axes_power(
    machine: Machine, velocity: Floats, acceleration: Floats, *, feed_force: Floats
) -> Floats:
    """Power of the axes X, Y and Z.

    Parameters
    ----------
    machine : Machine
        An axis without a known drive draws nothing of its own.
    velocity, acceleration : (M, 3) array, mm/s and mm/s²
    feed_force : (M,) array, N
        Against the path; each axis bears its share of the direction.

    Returns
    -------
    (M, 3) array, W
    """
    power = np.zeros_like(velocity)
    speed = np.linalg.norm(velocity, axis=1)
    moving = np.where(speed > 0.0, speed, 1.0)
    for axis in machine.axes:
        if axis.drive is not None and axis.name in AXES:
            row = AXES.index(axis.name)
            share = np.abs(velocity[:, row]) / moving
            power[:, row] = axis_power(
                axis.drive,
                velocity[:, row],
                acceleration[:, row],
                feed_force=feed_force * share,
            )
    return power


def main_power(
    machine: Machine, speed: Floats, acceleration: Floats, *, cutting_power: Floats
) -> Floats:
    """Power of the spindle drive, W, for speeds in rev/s and the power at the edge in W."""
    return np.asarray(
        spindle_power(machine.spindle, speed, acceleration, cutting_power=cutting_power)
    )


def continuous_power(machine: Machine, speed: Floats) -> Floats:
    """Power that the spindle drive gives continuously at speeds in rev/s, W."""
    power = np.full(len(speed), np.inf)
    around = np.abs(speed)
    for part in curve_segments(machine.spindle):
        inside = (around > 0.0) & (around >= part.min_speed) & (around <= part.max_speed)
        power[inside] = part.power_coefficient * around[inside] ** part.power_exponent
    return power


def overload(machine: Machine, cutting_power: Floats, speed: Floats, *, force: Floats) -> Ints:
    """Condition of the spindle drive and the force on the machine.

    As the optimiser counts it: the power at the edge over the efficiency, which holds the
    losses, against the continuous power. Ramps take a drive no longer than it bears.
    """
    power = cutting_power / machine.spindle.efficiency
    share = power / continuous_power(machine, speed)
    if machine.max_cutting_force is not None:
        share = np.maximum(share, force / machine.max_cutting_force)
    return np.where(
        share > FAULT_SHARE,
        int(Condition.FAULT),
        np.where(share > 1.0, int(Condition.WARNING), int(Condition.NORMAL)),
    )
