"""Courses made by hand: a slot whose depth changes, with air and a rapid before it."""

from math import pi

import numpy as np

from simulator.motion.segments import Bools, Floats
from simulator.plant.course import NominalCourse, Singles

SPEED = 50.0
"""rev/s: a revolution takes 20 ms"""

EXPONENT = 0.8
TEETH = 2
FEED = 10.0
"""mm/s"""

LAND_SHARE = 1.85
"""1/mm: 1 mm of flank wear adds so much of the force at an override of 1"""


def course(
    force: Floats, *, cell: float = 0.01, can_override: Bools | None = None
) -> NominalCourse:
    """A full slot with a mean force of so many N in each cell, at an override of 1."""
    count = len(force)
    cuts = force > 0.0

    def single(values: Floats | float) -> Singles:
        return np.broadcast_to(np.asarray(values, dtype=np.float32), (count,)).copy()

    return NominalCourse(
        until=cell * np.arange(1.0, count + 1.0),
        can_override=np.ones(count, bool) if can_override is None else can_override,
        position=np.zeros((count, 3), np.float32),
        feed=single(FEED),
        programmed=single(FEED),
        force=single(force),
        land_force=single(LAND_SHARE * force),
        exponent=single(EXPONENT),
        removal_rate=single(np.where(cuts, 100.0, 0.0)),
        axial_depth=single(np.where(cuts, 2.0, 0.0)),
        idle_power=single(200.0),
        spindle_speed=single(SPEED),
        diameter=single(np.where(cuts, 10.0, 0.0)),
        entry_angle=single(0.0),
        exit_angle=single(np.where(cuts, pi, 0.0)),
        peak=single(1.0),
        wall=single(0.0),
        lag=single(0.0),
        teeth=np.full(count, TEETH),
        tool=np.ones(count, dtype=np.int64),
        workingstep=np.ones(count, dtype=np.int64),
        line=np.ones(count, dtype=np.int64),
    )


def levels(*forces: float, cells: int = 100) -> Floats:
    """Forces that stay for so many cells each."""
    return np.repeat(np.array(forces), cells)
