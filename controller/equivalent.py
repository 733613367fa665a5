"""Forces at different places of a path, made comparable.

What breaks a tool is the greatest force of a revolution, what spoils a wall is the force
normal to it while an edge makes it, what the motor gives is the mean. Over the mean, the others
are the greater the narrower the arc of contact is; so one and the same mean force uses its
bound up in a finishing cut and is far from it in a slot. The loop acts upon *equivalent*
forces: the mean force at the plan's hardest place that uses the same share of its bound. Set
point, thresholds and breakage force then hold for the whole workingstep.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from controller.loop_settings import LoopSettings, LoopStep
from controller.preview import Preview
from simulator.reading import Floats, Reading


def equivalent(plain: Preview, steps: Sequence[LoopStep], settings: LoopSettings) -> Preview:
    """A preview of equivalent forces.

    Parameters
    ----------
    plain : Preview
        Forces as they are.
    steps : sequence of LoopStep
        By the number of the workingstep, from 1.
    settings : LoopSettings
        With a set point of the user's own forces count as they are.
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
    """A reading with equivalent forces."""
    return reading if weight == 1.0 else replace(reading, force=reading.force * weight)
