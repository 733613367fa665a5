"""Readings and revolutions for the tests of the stages before the law."""

import numpy as np

from controller.signals.ports import Floats, Reading
from controller.signals.signal import Revolution

SPINDLE_SPEED = 50.0
"""rev/s"""

REVOLUTION = Revolution(
    time=0.02,
    period=0.02,
    force=400.0,
    peak=600.0,
    tooth_peaks=np.full(4, 600.0),
    tooth_means=np.full(4, 400.0),
    tooth_feeds=np.full(4, 20.0),
    tooth_overrides=np.ones(4),
    samples=8,
    first=0,
    coverage=1.0,
    power=1000.0,
    feed=20.0,
    override=1.0,
    spindle_speed=SPINDLE_SPEED,
    progress=0.02,
    progress_before=0.0,
    workingstep=1,
    tooth_passing=0.0,
    once_per_revolution=0.0,
)
"""of four teeth at 0.1 mm each"""


def turn(forces: Floats, *, start: float = 0.0, first: int = 0) -> list[Reading]:
    """Readings of one tooth period each from (M, K) forces; as many teeth as periods."""
    teeth = len(forces)
    period = 1.0 / (SPINDLE_SPEED * teeth)
    return [
        Reading(
            time=start + period * (row + 1),
            period=period,
            force=force,
            power=1000.0,
            feed=20.0,
            override=1.0,
            spindle_speed=SPINDLE_SPEED,
            teeth=teeth,
            tooth=(first + row) % teeth,
            progress=start + period * (row + 1),
            workingstep=1,
            can_override=True,
        )
        for row, force in enumerate(forces)
    ]
