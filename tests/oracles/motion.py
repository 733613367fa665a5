"""Moves from rest to rest in closed form, mm and s.

Shin et al., 2016, Appendix 1 (1)-(3), with the case of moves too short to reach their speed;
Vijayaraghavan et al., 2009: feed against spacing of points.
"""

from math import sqrt


def peak_speed(length: float, *, speed: float, acceleration: float) -> float:
    """``min(v, √(a·L))``."""
    return min(speed, sqrt(acceleration * length))


def move_time(length: float, *, speed: float, acceleration: float) -> float:
    """``L/v + v/a``, or ``2·√(L/a)`` when ``L < v²/a``."""
    if length < speed**2 / acceleration:
        return 2.0 * sqrt(length / acceleration)
    return length / speed + speed / acceleration


def machining_time(
    length: float, feed: float, *, approach: float = 0.0, overrun: float = 0.0
) -> float:
    """``t = (L + A + O)/v_f``, s."""
    return (length + approach + overrun) / feed


def speed_of_blocks(spacing: float, block_time: float) -> float:
    """``v = s/t_block``."""
    return spacing / block_time


def ramp_time(speed: float, acceleration: float) -> float:
    """``v/a``, or ``n/α``."""
    return speed / acceleration
