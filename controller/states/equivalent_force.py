"""Equivalent forces, comparable at different places of a path.

The greatest force of a revolution breaks a tool, the force normal to a wall while an edge forms
it spoils the wall, and the mean force loads the motor. Relative to the mean, the other two grow
as the arc of contact gets narrower; so the same mean force may use up its bound in a finishing
cut and be far from it in a slot. The loop controls *equivalent* forces: the mean force at the
plan's hardest place that uses the same share of its bound. Set point, thresholds and breakage
force then hold for the whole workingstep.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from controller.signals.preview import Preview
from controller.states.loop_settings import LoopSettings, LoopStep
from simulator.reading import Floats, Reading


def equivalent(plain: Preview, steps: Sequence[LoopStep], settings: LoopSettings) -> Preview:
    """Convert a preview to equivalent forces.

    Parameters
    ----------
    plain : Preview
        Preview of real forces.
    steps : sequence of LoopStep
        In the order of the workingstep numbers, from 1.
    settings : LoopSettings
        With a set point given by the user, the forces stay real forces.
    """
    if plain.peak is None or plain.workingstep is None or settings.set_point is not None:
        return plain
    weight: Floats = np.ones(len(plain.until))
    for number, step in enumerate(steps, 1):
        rows = plain.workingstep == number
        peak = np.asarray(plain.peak[rows], dtype=np.float64)
        wall = None if plain.wall is None else np.asarray(plain.wall[rows], dtype=np.float64)
        weight[rows] = step.reference.weights(
            peak, wall=wall, power_factor=settings.power_factor
        )
    land = None if plain.land_force is None else plain.land_force * weight
    return replace(plain, force=plain.force * weight, weight=weight, land_force=land)


def weighed(reading: Reading, weight: float) -> Reading:
    """Convert the forces of a reading to equivalent forces."""
    if weight == 1.0:
        return reading
    return reading._replace(force=reading.force * weight, normal=reading.normal * weight)
