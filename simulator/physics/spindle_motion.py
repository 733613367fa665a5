"""Torque and power of a spindle that accelerates, rotates, cuts and stops.

Functions evaluated at every sample use arithmetic only, so that speeds may be floats or arrays.
Units rev/s, rev/s², N·mm, W, kg·m². The sign of a speed is its direction of rotation.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (12)-(16),
   doi:10.1080/00207543.2015.1064182.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018, eq. (4) and Table 1.

Corrections: [1]_ has the acceleration in rev/s² with ``T = J·2πα``, [2]_ in rad/s² with the
same torque (here always rev/s²); cutting power is force times speed without 2π; braking power
is not divided by the efficiency; the oil film follows Petroff in the speed's own unit.
"""

from math import pi

from simulator.physics.drive import FloatOrArray, Value, electrical_power
from simulator.spec import Spindle

_NMM_PER_NM = 1000.0
_NMM_S_PER_WATT = 1000.0


def acceleration_torque(inertia: float, acceleration: Value) -> Value:
    """Torque that changes the speed of a rotor, ``T = J·2π·α``, [1]_ (12).

    Parameters
    ----------
    inertia : float, kg·m²
    acceleration : float or array, rev/s²

    Returns
    -------
    float or array, N·mm
    """
    torque: Value = _NMM_PER_NM * inertia * 2.0 * pi * acceleration
    return torque


def idle_power(spindle: Spindle, speed: Value) -> Value:
    """Motor power of a spindle that rotates without cutting; 0 at rest.

    ``P = P_0 + p_1·|n| + p_2·n²``: electronics and fans, constant torque, viscous friction.

    Parameters
    ----------
    spindle : Spindle
    speed : float or array, rev/s

    Returns
    -------
    float or array, W

    Examples
    --------
    >>> from simulator.spec import SpindlePoint
    >>> spindle = Spindle(
    ...     curve=(SpindlePoint(speed=1.0, power=7500.0),), efficiency=0.9, min_speed=None,
    ...     max_speed=None, acceleration=None, idle_power=200.0, idle_power_per_speed=4.0,
    ... )
    >>> idle_power(spindle, -50.0), idle_power(spindle, 0.0)
    (400.0, 0.0)
    """
    pace = abs(speed)
    turning = 1.0 * (pace > 0.0)
    friction = spindle.idle_power_per_speed + spindle.idle_power_per_speed_squared * pace
    power: Value = turning * spindle.idle_power + friction * pace
    return power


def spindle_power(
    spindle: Spindle,
    speed: Value,
    acceleration: FloatOrArray = 0.0,
    *,
    cutting_power: FloatOrArray = 0.0,
) -> Value:
    """Power that the main drive draws from the mains.

    ``P = (J·2πα + T_run)·2πn/η + P_c/η`` while this is positive, otherwise ``η_reg`` times the
    power at the shaft, [1]_ (16) corrected.

    Parameters
    ----------
    spindle : Spindle
        An unknown inertia counts as 0.
    speed, acceleration : float or array, rev/s and rev/s²
        Signed: a spindle brakes if the two differ in sign.
    cutting_power : float or array, W
        Power at the tool, P_c.

    Returns
    -------
    float or array, W
    """
    torque = acceleration_torque(spindle.inertia or 0.0, acceleration)
    change = torque * 2.0 * pi * speed / _NMM_S_PER_WATT
    friction = spindle.efficiency * idle_power(spindle, speed)
    mechanical: Value = change + friction + cutting_power
    return electrical_power(
        mechanical, efficiency=spindle.efficiency, regeneration=spindle.regeneration
    )
