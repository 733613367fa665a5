"""Forces at different places of a path, made comparable.

What bends a tool is the greatest force of a revolution, what the motor gives is the mean. Over
the mean, the greatest force is the greater the narrower the arc of contact is; so one and the
same mean force uses its bound up in a finishing cut and is far from it in a slot. The loop acts
upon *equivalent* forces: the mean force at the plan's hardest place that uses the same share
of its bound. Set point, thresholds and breakage force then hold for the whole workingstep.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from controller.aims import Aims, Step
from controller.preview import Preview
from simulator.reading import Floats, Reading


def equivalent(plain: Preview, steps: Sequence[Step], aims: Aims) -> Preview:
    """A preview of equivalent forces.

    Parameters
    ----------
    plain : Preview
        Forces as they are.
    steps : sequence of Step
        By the number of the workingstep, from 1.
    aims : Aims
        With a set point of the user's own forces count as they are.
    """
    if plain.peak is None or plain.workingstep is None or aims.set_point is not None:
        return plain
    weight: Floats = np.ones(len(plain.until))
    for number, step in enumerate(steps, 1):
        rows = plain.workingstep == number
        peak = np.asarray(plain.peak[rows], dtype=np.float64)
        weight[rows] = step.reference.weights(peak, power_factor=aims.power_factor)
    return replace(plain, force=plain.force * weight, weight=weight)


def weighed(reading: Reading, weight: float) -> Reading:
    """A reading with equivalent forces."""
    return reading if weight == 1.0 else replace(reading, force=reading.force * weight)
