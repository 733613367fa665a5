"""How long no force was told, so that the loop knows when it is blind.

Either no sample arrives, or what arrives makes no revolution: too few samples, teeth left out,
readings that come again with their old time. Units s, rev/s.
"""

from dataclasses import dataclass
from math import inf

from controller.ports import Reading
from controller.signal import Revolution

REVOLUTIONS = 2.0
"""that may pass besides the time that is allowed, until one tells a force: the first is mostly
begun in its middle"""


IMPLAUSIBLE = 5.0
"""times the force of chips that a force may be below zero: no cut pulls, the zero is wrong"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Silence:
    """Time at feed since a force was told."""

    samples: float = 0.0
    """s since the last sample"""
    revolutions: float = 0.0
    """s since the last revolution with a force"""


HEARD = Silence()


def listened(
    silence: Silence, reading: Reading, revolution: Revolution | None, *, has_force: bool
) -> Silence:
    """The silence after one more reading at feed.

    Parameters
    ----------
    silence : Silence
    reading : Reading
    revolution : Revolution, optional
        That it completed.
    has_force : bool
        Whether it brought a sample.
    """
    if revolution is not None and revolution.is_covered:
        return HEARD
    return Silence(
        samples=0.0 if has_force else silence.samples + reading.period,
        revolutions=silence.revolutions + reading.period,
    )


def is_blind(silence: Silence, *, allowed: float, spindle_speed: float) -> bool:
    """Whether too much time has passed.

    Parameters
    ----------
    silence : Silence
    allowed : float, s
        Without a sample.
    spindle_speed : float, rev/s
        A standing spindle makes no revolution that could be missed.
    """
    turning = REVOLUTIONS / spindle_speed if spindle_speed > 0.0 else inf
    return silence.samples > allowed or silence.revolutions > allowed + turning


def is_implausible(force: float, chips: float) -> bool:
    """Whether a force, N, is none, with chips from so many N on."""
    return force < -IMPLAUSIBLE * chips
