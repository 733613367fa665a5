"""Signal conditioning: from sensor readings to cutting force, and a rate-limited set point.

The first two stages of [1]_, Fig. 5. A dynamometer drifts, so its zero is measured again while
nothing is cut; without a dynamometer, the spindle power gives the force; a set point that jumps
is passed to the loop at a limited rate. Units: mm, s, N, W, rev/s.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Process monitoring and control" and Fig. 5; eq. (5) for the power.
"""

from dataclasses import dataclass, field
from math import exp, isnan, pi
from typing import NamedTuple

import numpy as np

from controller.signals.ports import Reading
from simulator.physics.domain import require_at_most, require_positive
from stepnc_model.units import NMM_S_PER_WATT

MEMORY = 10.0
"""Time after which a learnt zero is weighted 1/e, s: noise averages out, drift does not."""

SAME_SPEED = 0.01
"""Relative change of the spindle speed within which the idle power counts as unchanged."""

RISE = 0.1
"""Greatest rise of ln(set point) per revolution.

Doubling takes seven revolutions, about what the loop needs to settle, so that the error never
grows large.
"""


class Tare(NamedTuple):
    """Zero of an instrument: its reading while nothing is cut."""

    offset: float = 0.0
    """Zero reading of the instrument, N or W."""
    seconds: float = 0.0
    """Weighted time over which the zero was learnt, s; 0 before anything was learnt."""
    time: float = 0.0
    """Time when the zero was last learnt, s."""

    @property
    def is_known(self) -> bool:
        """True if a zero has been learnt."""
        return self.seconds > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class IdlePower:
    """Power of the main drive while nothing is cut, at one spindle speed."""

    spindle_speed: float = 0.0
    """Spindle speed at which the idle power holds, rev/s."""
    tare: Tare = field(default_factory=Tare)
    """Learnt idle power of the main drive, W."""


def tared(tare: Tare, reading: Reading, *, has_chips: bool | None = None) -> Tare:
    """Update the zero of a dynamometer with one more reading.

    The zero is the mean of the samples without chips, each weighted ``exp(−age/MEMORY)``; lost
    samples do not count. Drift during a long cut is not seen until the next stretch without
    chips, which then outweighs everything before the cut.

    Parameters
    ----------
    reading : Reading
        Raw sensor reading, with nothing subtracted.
    has_chips : bool, optional
        Whether chips are being cut, if the caller knows. Unknown: no chips while the override
        does not act. Where the program itself inhibits the override in a cut (threads, taps),
        the caller must pass ``True``.
    """
    if _cuts(reading, has_chips) or not len(reading.force):
        return tare
    seen = reading.force
    total = float(np.add.reduce(seen))
    if isnan(total):
        # A single lost sample makes the sum NaN.
        seen = seen[~np.isnan(seen)]
        total = float(np.add.reduce(seen))
    if not len(seen):
        return tare
    seconds = reading.period * len(seen) / len(reading.force)
    return _learnt(tare, total / len(seen), seconds=seconds, time=reading.time)


def without_offset(reading: Reading, tare: Tare) -> Reading:
    """Subtract the zero of the dynamometer from a reading."""
    return reading._replace(force=reading.force - tare.offset)


def idled(idle: IdlePower, reading: Reading, *, has_chips: bool | None = None) -> IdlePower:
    """Update the idle power with one more reading; learnt anew when the spindle speed changes.

    Power while the spindle accelerates is not idle power. Readings with the actual speed avoid
    this error; readings with the commanded speed spoil the first part of a stretch.

    Parameters
    ----------
    has_chips : bool, optional
        As in :func:`tared`.
    """
    if _cuts(reading, has_chips) or isnan(reading.power):
        return idle
    is_same = _is_same_speed(idle.spindle_speed, reading.spindle_speed)
    before = idle.tare if is_same else Tare()
    speed = idle.spindle_speed if is_same else reading.spindle_speed
    tare = _learnt(before, reading.power, seconds=reading.period, time=reading.time)
    return IdlePower(spindle_speed=speed, tare=tare)


def force_from_power(
    reading: Reading, idle: IdlePower, *, tool_diameter: float, efficiency: float
) -> Reading:
    """Derive one force sample from the power of the main drive.

    ``F = 1000 · (P − P_idle) · η / (π · D · n)``, [1]_ eq. (5) solved for the force; the 1000
    converts W into N·mm/s. It is the mean tangential force over the period and does not resolve
    single teeth, since a main drive is slower than they are. Noise is not rectified, so that
    without chips it is as often negative as positive.

    Parameters
    ----------
    tool_diameter : float, mm
        In turning, the diameter of the work.
    efficiency : float
        η of the spindle, above 0, at most 1.

    Returns
    -------
    Reading
        With force of shape (1,), N; NaN where the power was lost, the spindle stands, or the
        idle power at its speed is not known.

    Raises
    ------
    ValueError
        If the diameter is not positive or the efficiency out of range.
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(efficiency, 1.0, thing="efficiency", unit="")
    is_same = _is_same_speed(idle.spindle_speed, reading.spindle_speed)
    if not (is_same and idle.tare.is_known and reading.spindle_speed > 0.0):
        return reading._replace(force=np.array([np.nan]))
    cutting = (reading.power - idle.tare.offset) * efficiency
    around = pi * tool_diameter * reading.spindle_speed
    return reading._replace(force=np.array([NMM_S_PER_WATT * cutting / around]))


def conditioned(set_point: float, wanted: float, *, rise: float = RISE) -> float:
    """Set point of the next revolution, moved towards the wanted one at a limited rate.

    ``min(wanted, set_point · e^rise)``: it rises at a limited rate in logarithms, where the
    plant of the loop is linear, and falls at once, since a lower set point is always urgent.

    Parameters
    ----------
    set_point : float, N
        Of this revolution; 0: there was none, and the wanted one applies at once.
    wanted : float, N
        Above 0.
    rise : float
        Rise of ln(set point) per revolution, above 0.

    Returns
    -------
    float, N

    Examples
    --------
    >>> round(conditioned(400.0, 800.0), 1)
    442.1
    >>> conditioned(800.0, 400.0)
    400.0
    """
    require_positive(wanted, "set point", "N")
    if not set_point > 0.0:
        return wanted
    return min(wanted, set_point * exp(rise))


def _cuts(reading: Reading, has_chips: bool | None) -> bool:
    """True if chips may be forming."""
    return reading.can_override if has_chips is None else has_chips


def _learnt(tare: Tare, value: float, *, seconds: float, time: float) -> Tare:
    """Update a zero with some more seconds; setting the clock back forgets nothing."""
    if not seconds > 0.0:
        return tare
    kept = tare.seconds * exp(-max(0.0, time - tare.time) / MEMORY)
    offset = tare.offset + (value - tare.offset) * seconds / (kept + seconds)
    return Tare(offset=offset, seconds=kept + seconds, time=time)


def _is_same_speed(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_SPEED * max(one, other)
