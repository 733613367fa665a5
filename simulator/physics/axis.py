"""Torque and power of a feed axis: servomotor, gear, feed screw, guide.

Arithmetic only, so that speeds and forces may be floats or arrays. Units mm, s, N, N·mm, W,
kg·m². The weight of a vertical axis is assumed to be balanced, and the power of a motor that
holds an axis at rest is neglected.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (8)-(11),
   doi:10.1080/00207543.2015.1064182.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018, eq. (3) and Table 1.

Corrections to both: the pitch is a lead per revolution; viscous torque persists at constant
speed; friction helps to brake; braking power is not divided by the efficiency; the inertia of
the motor is included, and a gear divides the inertia behind it by the square of its ratio.
"""

from math import pi

from simulator.physics.drive import FloatOrArray, Value, electrical_power, positive_part
from simulator.spec import AxisDrive
from stepnc_model.units import MM_PER_M, NMM_S_PER_WATT

GRAVITY = 9.81  # m/s², as printed in the sources


def reflected_inertia(drive: AxisDrive) -> float:
    """Inertia of all moving parts, reflected to the motor shaft.

    ``J_e = J_motor + J_coupling + (½·m_s·(d/2)² + m·(lead/2π)²)/r²``.

    Returns
    -------
    float, kg·m²

    Examples
    --------
    >>> screw = AxisDrive(lead=10.0, table_mass=100.0, screw_mass=8.0, screw_diameter=40.0)
    >>> round(reflected_inertia(screw), 7)
    0.0018533
    """
    radius = drive.screw_diameter / 2.0 / MM_PER_M
    arm = drive.lead / (2.0 * pi) / MM_PER_M
    behind = 0.5 * drive.screw_mass * radius**2 + _moved_mass(drive) * arm**2
    return drive.motor_inertia + drive.coupling_inertia + behind / drive.gear_ratio**2


def guide_torque(drive: AxisDrive, *, vertical_force: Value) -> Value:
    """Torque at the screw from guide friction, ``T_gf = lead·μ·(m·g + F_z)/2π``, [1]_ (8).

    Parameters
    ----------
    vertical_force : float or array, N
        Positive when it presses on the guide; a lifting force is ignored.

    Returns
    -------
    float or array, N·mm
    """
    load = _moved_mass(drive) * GRAVITY + positive_part(vertical_force)
    torque: Value = drive.lead * drive.guide_friction * load / (2.0 * pi)
    return torque


def bearing_torque(drive: AxisDrive, *, feed_force: Value) -> Value:
    """Torque at the screw lost in its bearing, ``T_lf = μ_b·d·(|F_f| + F_p)/2``, [1]_ (8).

    Parameters
    ----------
    feed_force : float or array, N
        Either sign loads the bearing.

    Returns
    -------
    float or array, N·mm
    """
    load = abs(feed_force) + drive.preload
    torque: Value = drive.bearing_friction * drive.screw_diameter * load / 2.0
    return torque


def feed_torque(drive: AxisDrive, *, feed_force: Value) -> Value:
    """Torque at the screw from the feed force, ``T_f = lead·F_f/2π``, N·mm, [1]_ (8)."""
    torque: Value = drive.lead * feed_force / (2.0 * pi)
    return torque


def steady_torque(
    drive: AxisDrive, *, feed_force: Value, vertical_force: FloatOrArray = 0.0
) -> Value:
    """Torque at the motor shaft that does not depend on speed.

    ``T_s = (T_gf + T_lf + T_f)/r``, [1]_ (8).

    Parameters
    ----------
    feed_force : float or array, N
        Force against the motion.
    vertical_force : float or array, N
        Force that presses on the guide.

    Returns
    -------
    float or array, N·mm
    """
    friction = guide_torque(drive, vertical_force=vertical_force)
    friction = friction + bearing_torque(drive, feed_force=feed_force)
    torque: Value = (friction + feed_torque(drive, feed_force=feed_force)) / drive.gear_ratio
    return torque


def motor_speed(drive: AxisDrive, velocity: Value) -> Value:
    """Angular motor speed, ``w = 2π·r·v/lead``, rad/s; also converts an acceleration."""
    speed: Value = 2.0 * pi * drive.gear_ratio / drive.lead * velocity
    return speed


def motor_torque(
    drive: AxisDrive,
    velocity: Value,
    acceleration: FloatOrArray = 0.0,
    *,
    feed_force: FloatOrArray = 0.0,
    vertical_force: FloatOrArray = 0.0,
) -> Value:
    """Torque of the motor in the direction of motion, negative when braking.

    ``T = J_e·ẇ + B·w + T_s`` while the speed grows and holds, ``−J_e·|ẇ| + B·w + T_s`` while it
    falls, [1]_ (9), (10) and [2]_ eq. (3) corrected.

    Parameters
    ----------
    velocity, acceleration : float or array, mm/s and mm/s²
        Signed along the axis. At rest there is no motion to oppose: 0.
    feed_force : float or array, N
        Positive against the motion.
    vertical_force : float or array, N
        Positive when it presses on the guide.

    Returns
    -------
    float or array, N·mm
    """
    direction = 1.0 * (velocity > 0.0) - 1.0 * (velocity < 0.0)
    along = direction * motor_speed(drive, acceleration)
    inertia = MM_PER_M * reflected_inertia(drive) * along
    viscous = drive.viscous * motor_speed(drive, abs(velocity))
    steady = steady_torque(drive, feed_force=feed_force, vertical_force=vertical_force)
    torque: Value = inertia + viscous + abs(direction) * steady
    return torque


def axis_power(
    drive: AxisDrive,
    velocity: Value,
    acceleration: FloatOrArray = 0.0,
    *,
    feed_force: FloatOrArray = 0.0,
    vertical_force: FloatOrArray = 0.0,
) -> Value:
    """Power that an axis draws from the mains; 0 at rest.

    ``P = T·w/η`` for ``T·w > 0`` and ``η_reg·T·w`` else, [1]_ (11) corrected.

    Parameters
    ----------
    velocity, acceleration : float or array, mm/s and mm/s²
        Signed along the axis.
    feed_force : float or array, N
        Positive against the motion.
    vertical_force : float or array, N
        Positive when it presses on the guide.

    Returns
    -------
    float or array, W

    Examples
    --------
    >>> slide = AxisDrive(lead=10.0, table_mass=100.0, guide_friction=0.01, efficiency=0.9)
    >>> round(axis_power(slide, 500.0), 2), round(axis_power(slide, -500.0, -2000.0), 1)
    (5.45, 116.6)
    >>> axis_power(slide, 500.0, -2000.0)
    0.0
    """
    torque = motor_torque(
        drive, velocity, acceleration, feed_force=feed_force, vertical_force=vertical_force
    )
    mechanical: Value = torque * motor_speed(drive, abs(velocity)) / NMM_S_PER_WATT
    return electrical_power(
        mechanical, efficiency=drive.efficiency, regeneration=drive.regeneration
    )


def _moved_mass(drive: AxisDrive) -> float:
    """Mass of table and workpiece, kg."""
    return drive.table_mass + drive.workpiece_mass
