"""Force over a revolution of the cutter, relative to its mean.

The teeth of :mod:`simulator.physics.tooth_forces` on one arc of contact, along their helix,
with runout or with a tooth that has broken. Times the mean force of a revolution, which is that
of the power, it is what a dynamometer shows. Units mm, rad.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import atan, cos, pi

import numpy as np

from simulator.motion.segments import Floats
from simulator.physics.flutes import CuttingEdges, Law
from simulator.physics.tooth_forces import (
    Places,
    forces,
    one_place,
    peak_resultant,
    wall_force,
)
from simulator.physics.uneven_teeth import Runout, eccentric_runout

SAMPLES = 8
"""of a tooth period"""

PLACES = 32
"""places that make one sample: narrow arcs must not fall between two of them"""

SUNKEN = 10.0
"""feeds per tooth by which a broken tooth lies below the others: it meets nothing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Teeth:
    """Teeth on their arc."""

    count: int
    entry_angle: float
    exit_angle: float
    exponent: float
    """of force over chip thickness"""
    lag: float = 0.0
    """rad by which the upper end of the edge in the cut is behind its tip"""
    runout: float = 0.0
    """eccentricity over feed per tooth"""
    broken: int | None = None


@lru_cache(maxsize=4096)
def pattern(teeth: Teeth) -> Floats:
    """Force in each tooth period of a revolution over the mean force of whole teeth.

    Parameters
    ----------
    teeth : Teeth

    Returns
    -------
    (z, K) array
        Row j: while tooth j is the last that has entered. The mean is 1; with a broken tooth
        it is less, as two chips in one take less force than two.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return np.ones((teeth.count, SAMPLES))
    runout = eccentric_runout(teeth.runout, teeth.count)
    force = _force(teeth, runout)
    mean = force.mean()
    if not mean > 0.0:
        return np.ones((teeth.count, SAMPLES))
    if teeth.broken is not None and teeth.count > 1:
        sunken = runout.copy()
        sunken[teeth.broken % teeth.count] -= SUNKEN
        force = _force(teeth, sunken)
    shape: Floats = (force / mean).reshape(teeth.count, SAMPLES, PLACES).mean(axis=2)
    shape.setflags(write=False)
    return shape


@lru_cache(maxsize=4096)
def peak_over_mean(teeth: Teeth) -> float:
    """Greatest force across the axis in a revolution, over the mean tangential force.

    1 where no arc is known; less where teeth pull against each other. The mean is that of the
    power, with k_c at the mean chip, as the optimiser has it: ``z·φ/2π · (C/φ)^q`` over the
    force of one tooth at its thickest chip. Teeth without runout.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return 1.0
    found = peak_resultant(_edges(teeth), _place(teeth), Law(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


@lru_cache(maxsize=4096)
def wall_over_mean(teeth: Teeth) -> float:
    """Force normal to the wall while an edge makes it, over that mean; 0 without a wall."""
    if not teeth.exit_angle > teeth.entry_angle:
        return 0.0
    found = wall_force(_edges(teeth), _place(teeth), Law(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


def _mean(teeth: Teeth) -> float:
    contact = teeth.exit_angle - teeth.entry_angle
    chip = (cos(teeth.entry_angle) - cos(teeth.exit_angle)) / contact
    return float(teeth.count * contact / (2.0 * pi) * chip**teeth.exponent)


def _edges(teeth: Teeth) -> CuttingEdges:
    """Edges of a cutter of radius 1, which lag as they do over a depth of 1."""
    return CuttingEdges(teeth=teeth.count, diameter=2.0, helix_angle=atan(teeth.lag))


def _place(teeth: Teeth) -> Places:
    return one_place(teeth.entry_angle, teeth.exit_angle, axial_depth=1.0)


def _force(teeth: Teeth, runout: Floats) -> Floats:
    """Sum over the teeth through a revolution that begins where tooth 0 enters."""
    pitch = 2.0 * pi / teeth.count
    each = SAMPLES * PLACES
    middle = (np.arange(teeth.count * each) + 0.5) / each
    found = forces(
        _edges(teeth),
        _place(teeth),
        Law(exponent=teeth.exponent),
        rotation=(teeth.entry_angle + pitch * middle)[None, :],
        runout=Runout(offsets=runout, feed_per_tooth=np.ones(1)) if runout.any() else None,
    )
    force: Floats = found.tangential[0]
    return force
