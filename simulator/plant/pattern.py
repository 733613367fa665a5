"""Force over a revolution of the cutter, relative to its mean.

The teeth of :mod:`simulator.machine.tooth_forces` on one arc of contact, with runout or with a
tooth that has broken. Times the mean force of a revolution, which is that of the power, it is
what a dynamometer shows. Units mm, rad.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi

import numpy as np

from simulator.machine.tooth_forces import chip_thickness, tooth_angles
from simulator.machine.transients import eccentric_runout
from simulator.motion.segments import Floats

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
    """Greatest force of a revolution over its mean; 1 where no arc is known.

    The mean is that of the power, with k_c at the mean chip, as the optimiser has it:
    ``z·φ/2π · (C/φ)^p`` over the force of one tooth at its thickest chip. Teeth without runout.
    """
    contact = teeth.exit_angle - teeth.entry_angle
    if not contact > 0.0:
        return 1.0
    force = _force(teeth, np.zeros(teeth.count))
    chip = (cos(teeth.entry_angle) - cos(teeth.exit_angle)) / contact
    mean = teeth.count * contact / (2.0 * pi) * chip**teeth.exponent
    return float(max(force.max() / mean, 1.0))


def _force(teeth: Teeth, runout: Floats) -> Floats:
    """Sum over the teeth through a revolution that begins where tooth 0 enters."""
    pitch = 2.0 * pi / teeth.count
    each = SAMPLES * PLACES
    middle = (np.arange(teeth.count * each) + 0.5) / each
    angle = tooth_angles(teeth.entry_angle + pitch * middle, teeth.count)
    chip = chip_thickness(angle, feed_per_tooth=1.0, runout=runout)
    in_cut = (chip > 0.0) & (angle >= teeth.entry_angle) & (angle <= teeth.exit_angle)
    force: Floats = (np.where(in_cut, chip, 0.0) ** teeth.exponent * in_cut).sum(axis=1)
    return force
