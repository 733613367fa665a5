"""Readings of a machine's sensors for the closed loop, usually one per tooth period.

Units mm, s, N, W, rev/s.
"""

from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepnc_model.tuples import quick_replace

Floats = NDArray[np.float64]


@quick_replace
class Reading(NamedTuple):
    """Sensor values of one tooth period or any other, or of a time without feed override.

    A tuple and not a dataclass, as several are made in each tooth period.
    """

    time: float
    """Time at the end of the period, s."""
    period: float
    """Duration of the period, s."""
    force: Floats
    """Tangential force of all teeth together (torque over radius), (K,), N, evenly spaced over
    the period; NaN if a sample was lost; empty if nothing was sampled."""
    power: float
    """Mean power of the main drive over the period, W; NaN if lost."""
    feed: float
    """Mean feed along the path over the period, mm/s."""
    override: float
    """Actual feed of the axes over the programmed feed."""
    spindle_speed: float
    """Magnitude of the spindle speed, rev/s."""
    teeth: int
    tooth: int
    """Index of the tooth to which the period belongs, 0 to teeth − 1."""
    progress: float
    """Program time at an override of 1 at the end of the period, s."""
    workingstep: int
    """Number of the workingstep in the program, counted from 1; 0 for none."""
    can_override: bool
    """Whether the feed override acts: not in rapid, in a dwell or at a tool change."""
    normal: float = nan
    """Mean force normal to the edges over the period, N; NaN: not measured."""
    is_placed: bool = True
    """Whether its place in the program is known as exactly as the expected force needs."""
