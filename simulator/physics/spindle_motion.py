"""Torque and power of a spindle that speeds up, turns, cuts and stops.

Arithmetic only in what a run asks for at every sample, so that speeds may be floats or arrays.
Units rev/s, rev/s², N·mm, W, kg·m². Signs of speeds are those of the sense of rotation.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (12)-(16),
   doi:10.1080/00207543.2015.1064182.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018, eq. (4) and Table 1.

Corrected: [1]_ has the acceleration in rev/s² with ``T = J·2πα``, [2]_ in rad/s² with the same
torque (here always rev/s²); cutting power is force times speed without a 2π; braking power is
not divided by the efficiency; the oil film follows Petroff in the speed's own unit.
"""

from math import log1p, pi

from simulator.physics.domain import require_not_negative, require_positive
from simulator.physics.drive import Quantity, Value, electrical_power
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
    """Motor power of a spindle that turns without cutting; 0 at rest.

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


def running_torque(spindle: Spindle, speed: float) -> float:
    """Torque of a spindle that turns without cutting, ``T_run = η·P_idle/(2π·n)``, [1]_ (14).

    Parameters
    ----------
    spindle : Spindle
    speed : float, rev/s
        Positive.

    Returns
    -------
    float, N·mm

    Raises
    ------
    ValueError
        If the speed is not positive.
    """
    require_positive(speed, "spindle speed", "rev/s")
    mechanical = spindle.efficiency * idle_power(spindle, speed)
    return _NMM_S_PER_WATT * mechanical / (2.0 * pi * speed)


def spindle_power(
    spindle: Spindle,
    speed: Value,
    acceleration: Quantity = 0.0,
    *,
    cutting_power: Quantity = 0.0,
) -> Value:
    """Power that the main drive draws from the mains.

    ``P = (J·2πα + T_run)·2πn/η + P_c/η`` while that is positive, ``η_reg`` times the power at
    the shaft else, [1]_ (16) corrected.

    Parameters
    ----------
    spindle : Spindle
        An unknown inertia counts as none.
    speed, acceleration : float or array, rev/s and rev/s²
        Signed: a spindle brakes when they differ in sign.
    cutting_power : float or array, W
        At the tool, P_c.

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


def kinetic_energy(inertia: float, speed: Value) -> Value:
    """Energy stored in a rotor, ``½·J·(2πn)²``, J of kg·m² and rev/s."""
    energy: Value = 0.5 * inertia * (2.0 * pi * speed) ** 2
    return energy


def petroff_torque(
    viscosity: float, speed: float, *, diameter: float, length: float, gap: float
) -> float:
    """Torque that shears the film around a turning cylinder, ``(π/4)·μ·D³·L·ω/gap``.

    Petroff's law for a small gap; [1]_ (13) gives 0.658 times that, its speed in rad/s.

    Parameters
    ----------
    viscosity : float, N·s/mm²
        1e-6 of what it is in Pa·s; oil 1e-8 to 1e-7.
    speed : float, rev/s
    diameter, length, gap : float, mm

    Returns
    -------
    float, N·mm

    Raises
    ------
    ValueError
        If a dimension is not positive, or viscosity or speed is negative.

    Examples
    --------
    >>> round(petroff_torque(1e-8, 50.0, diameter=80.0, length=100.0, gap=0.05), 2)
    2526.62
    """
    require_not_negative(viscosity, "viscosity", "N·s/mm²")
    require_not_negative(speed, "spindle speed", "rev/s")
    for size, name in ((diameter, "diameter"), (length, "length"), (gap, "gap")):
        require_positive(size, name, "mm")
    return pi / 4.0 * viscosity * diameter**3 * length * 2.0 * pi * speed / gap


def coast_down_time(
    inertia: float, speed: float, *, dry_torque: float, viscous: float = 0.0
) -> float:
    """Time in which friction alone stops a spindle, ``t = (J/B)·ln(1 + B·ω/T_c)``.

    The solution of ``J·dω/dt = −T_c − B·ω``; minutes for a large spindle, which is why
    machines brake.

    Parameters
    ----------
    inertia : float, kg·m²
    speed : float, rev/s
        At which the motor lets go.
    dry_torque : float, N·mm
        T_c, independent of speed; without one it never stops.
    viscous : float, N·mm·s/rad
        B.

    Returns
    -------
    float, s

    Raises
    ------
    ValueError
        If inertia or dry torque is not positive, or another value negative.

    Examples
    --------
    >>> round(coast_down_time(0.5, 30.0, dry_torque=1000.0), 1)
    94.2
    >>> round(coast_down_time(0.5, 30.0, dry_torque=1000.0, viscous=8.7), 1)
    55.8
    """
    require_positive(inertia, "inertia", "kg·m²")
    require_not_negative(speed, "spindle speed", "rev/s")
    require_positive(dry_torque, "dry torque", "N·mm")
    require_not_negative(viscous, "viscous friction", "N·mm·s/rad")
    angular = 2.0 * pi * speed
    if viscous == 0.0:
        return _NMM_PER_NM * inertia * angular / dry_torque
    return _NMM_PER_NM * inertia / viscous * log1p(viscous * angular / dry_torque)
