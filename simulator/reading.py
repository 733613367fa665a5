"""Readings of a machine's sensors, one a tooth period, for the closed loop.

Units mm, s, N, W, rev/s.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reading:
    """Sensor values of one tooth period, or of a stretch without chips to come."""

    time: float
    """Time, s, at its end"""
    period: float
    """Period, s that it covers"""
    force: Floats
    """(K,) N, tangential force of all teeth together (torque over radius), evenly spaced over
    the period; NaN: a sample was lost; empty: nothing was sampled"""
    power: float
    """Power, W of the main drive, mean over the period; NaN: lost"""
    feed: float
    """Feed, mm/s along the path, mean over the period"""
    override: float
    """feed over programmed feed, as the axes really ran"""
    spindle_speed: float
    """Spindle speed, rev/s, magnitude"""
    teeth: int
    tooth: int
    """which of the teeth the period belongs to, 0 to teeth − 1"""
    progress: float
    """Progress, s of the program at an override of 1, at the period's end"""
    workingstep: int
    """which of the program's, counted from 1; 0: none"""
    can_override: bool
    """whether the feed override acts: not in rapid, in a dwell, at a tool change"""
