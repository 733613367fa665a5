"""Power and torque curve of a spindle as monomials of the speed.

Scalars in W, N·mm and rev/s. Monomials are used because the feed optimiser works in logarithms.

Torque and power of a spindle that accelerates, rotates, cuts and stops.

Functions evaluated at every sample use arithmetic only, so that speeds may be floats or arrays.
Units rev/s, rev/s², N·mm, W, kg·m². The sign of a speed is its direction of rotation.


Corrections: [1]_ has the acceleration in rev/s² with ``T = J·2πα``, [2]_ in rad/s² with the
same torque (here always rev/s²); cutting power is force times speed without 2π; braking power
is not divided by the efficiency; the oil film follows Petroff in the speed's own unit.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (12)-(16),
   doi:10.1080/00207543.2015.1064182.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018, eq. (4) and Table 1.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, log, pi, pow

from simulator.physics.domain import require_positive
from simulator.physics.drive import FloatOrArray, Value, electrical_power
from simulator.spec import Spindle, SpindlePoint
from stepnc_model.units import NMM_PER_NM, NMM_S_PER_WATT

_STEEPEST = 50.0  # exponent beyond which coefficients at 1 rev/s exceed the range of floats


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveSegment:
    """Segment of a spindle's curve: ``P = c·n^γ`` and, where known, ``M = d·n^δ``."""

    min_speed: float
    """Lowest speed, rev/s; 0 if the curve has no lower end."""
    max_speed: float
    """Highest speed, rev/s; ``inf`` if the curve has no upper end."""
    power_coefficient: float
    """Coefficient c: motor power at 1 rev/s, W."""
    power_exponent: float
    """Exponent γ: 0 for constant power, 1 for constant torque."""
    torque_coefficient: float | None
    """Coefficient d: torque at 1 rev/s, N·mm; ``None`` if the source gives no torque."""
    torque_exponent: float
    """Exponent δ of the torque."""

    def power(self, spindle_speed: float) -> float:
        """Motor power at a spindle speed, W."""
        return self.power_coefficient * pow(spindle_speed, self.power_exponent)

    def torque(self, spindle_speed: float) -> float | None:
        """Torque at a spindle speed, N·mm."""
        if self.torque_coefficient is None:
            return None
        return self.torque_coefficient * pow(spindle_speed, self.torque_exponent)


def curve_segments(spindle: Spindle) -> tuple[CurveSegment, ...]:
    """Convert a spindle's curve to monomials, one per segment, ascending in speed.

    Below the first point the torque is constant where it is known (power proportional to
    speed), otherwise the power is constant. Between two points both are linear in logarithms.
    Above the last point the power is constant and the torque falls as ``1/n``. Torque is known
    between two points if both have it. The segments cover the range from the spindle's lowest
    to its highest speed, or from 0 and to infinity.

    Returns
    -------
    tuple of CurveSegment
        At least one; each ends where the next begins.

    Raises
    ------
    ValueError
        If the curve is empty, does not ascend, has a value that is not positive, or jumps: a
        gear change must be a short segment, not a step (5 % of power need 0.1 % of speed).

    Examples
    --------
    >>> from simulator.spec import Spindle, SpindlePoint
    >>> base = SpindlePoint(speed=25.0, power=7500.0, torque=47_700.0)
    >>> spindle = Spindle(
    ...     curve=(base,), efficiency=0.9, min_speed=None, max_speed=100.0, acceleration=None
    ... )
    >>> [(s.min_speed, s.max_speed, s.power_exponent) for s in curve_segments(spindle)]
    [(0.0, 25.0, 1.0), (25.0, 100.0, 0.0)]
    """
    least = 0.0 if spindle.min_speed is None else spindle.min_speed
    greatest = inf if spindle.max_speed is None else spindle.max_speed
    if not 0.0 <= least < greatest:
        raise ValueError(
            f"lowest spindle speed {least:g} rev/s must be less than the highest, "
            f"{greatest:g} rev/s"
        )
    clipped = (_clipped(part, least, greatest) for part in _stretches(spindle))
    return tuple(part for part in clipped if part.min_speed < part.max_speed)


def available_power(spindle: Spindle, spindle_speed: float) -> float:
    """Motor power that the spindle gives continuously at a speed.

    Interpolated as in :func:`curve_segments`, also beyond the speed range of the spindle, which
    is a separate limit.

    Parameters
    ----------
    spindle_speed : float, rev/s

    Returns
    -------
    float, W

    Raises
    ------
    ValueError
        If the speed is not positive or the curve unusable.
    """
    return _stretch_at(spindle, spindle_speed).power(spindle_speed)


def _stretch_at(spindle: Spindle, spindle_speed: float) -> CurveSegment:
    """Segment of the unlimited curve that contains a speed."""
    require_positive(spindle_speed, "spindle speed", "rev/s")
    return next(part for part in _stretches(spindle) if spindle_speed <= part.max_speed)


def _stretches(spindle: Spindle) -> tuple[CurveSegment, ...]:
    """Segments of a spindle's curve for speeds from 0 to infinity."""
    _require_usable(spindle.curve)
    first, last = spindle.curve[0], spindle.curve[-1]
    between = (_between(low, high) for low, high in pairwise(spindle.curve))
    return (_below(first), *between, _above(last))


def _require_usable(curve: tuple[SpindlePoint, ...]) -> None:
    """Raise an error unless a curve has points, ascends and has positive values."""
    if not curve:
        raise ValueError("spindle curve has 0 points and must have at least 1")
    for point in curve:
        require_positive(point.speed, "spindle curve's speed", "rev/s")
        require_positive(point.power, "spindle curve's power", "W")
        if point.torque is not None:
            require_positive(point.torque, "spindle curve's torque", "N·mm")
    for low, high in pairwise(curve):
        if low.speed >= high.speed:
            raise ValueError(
                f"spindle curve's speed {high.speed:g} rev/s must be greater than the one "
                f"before it, {low.speed:g} rev/s"
            )


def _below(point: SpindlePoint) -> CurveSegment:
    """Segment below the first point: constant torque, or power if torque is unknown."""
    if point.torque is None:
        return CurveSegment(
            min_speed=0.0,
            max_speed=point.speed,
            power_coefficient=point.power,
            power_exponent=0.0,
            torque_coefficient=None,
            torque_exponent=0.0,
        )
    return CurveSegment(
        min_speed=0.0,
        max_speed=point.speed,
        power_coefficient=point.power / point.speed,
        power_exponent=1.0,
        torque_coefficient=point.torque,
        torque_exponent=0.0,
    )


def _between(low: SpindlePoint, high: SpindlePoint) -> CurveSegment:
    """Segment between two points, linear in logarithms."""
    power_exponent = _exponent(low, high, high.power / low.power)
    torque_exponent = 0.0
    torque_coefficient = None
    if low.torque is not None and high.torque is not None:
        torque_exponent = _exponent(low, high, high.torque / low.torque)
        torque_coefficient = low.torque * pow(low.speed, -torque_exponent)
    return CurveSegment(
        min_speed=low.speed,
        max_speed=high.speed,
        power_coefficient=low.power * pow(low.speed, -power_exponent),
        power_exponent=power_exponent,
        torque_coefficient=torque_coefficient,
        torque_exponent=torque_exponent,
    )


def _exponent(low: SpindlePoint, high: SpindlePoint, ratio: float) -> float:
    """Slope in logarithms of a value that changes by a ratio between two points."""
    exponent = log(ratio) / log(high.speed / low.speed)
    if abs(exponent) > _STEEPEST:
        raise ValueError(
            f"spindle curve's slope {exponent:g} between {low.speed:g} rev/s and "
            f"{high.speed:g} rev/s must be at most {_STEEPEST:g} in logarithms: "
            "move the two points apart"
        )
    return exponent


def _above(point: SpindlePoint) -> CurveSegment:
    """Segment above the last point, with constant power."""
    known = point.torque is not None
    return CurveSegment(
        min_speed=point.speed,
        max_speed=inf,
        power_coefficient=point.power,
        power_exponent=0.0,
        torque_coefficient=point.torque * point.speed if point.torque is not None else None,
        torque_exponent=-1.0 if known else 0.0,
    )


def _clipped(part: CurveSegment, least: float, greatest: float) -> CurveSegment:
    """Part of a segment between two speeds; its ends are crossed if it lies outside."""
    return replace(
        part, min_speed=max(part.min_speed, least), max_speed=min(part.max_speed, greatest)
    )


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
    torque: Value = NMM_PER_NM * inertia * 2.0 * pi * acceleration
    return torque


def idle_power(spindle: Spindle, speed: Value) -> Value:
    """Motor power of a spindle that rotates without cutting; 0 at rest.

    ``P = P_0 + p_1·|n| + p_2·n²``: electronics and fans, constant torque, viscous friction.

    Parameters
    ----------
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
    change = torque * 2.0 * pi * speed / NMM_S_PER_WATT
    friction = spindle.efficiency * idle_power(spindle, speed)
    mechanical: Value = change + friction + cutting_power
    return electrical_power(
        mechanical, efficiency=spindle.efficiency, regeneration=spindle.regeneration
    )
