"""How fast the axes really are at places of a workingstep's tool path.

Where a path turns, begins or ends they are slower than the feed. Units mm, s.
"""

import numpy as np

from simulator.motion.motion import AxisLimits, ControlModel
from simulator.motion.passing import Passing
from simulator.motion.segments import Floats, Ints
from simulator.motion.tool_path import Run


def reached_speeds(
    run: Run, control: ControlModel, limits: AxisLimits, *, segment: Ints, station: Floats
) -> Floats:
    """(M,) mm/s that the axes reach at places of a path, which are ascending.

    Parameters
    ----------
    run : Run
    control : ControlModel
    limits : AxisLimits
    segment : (M,) array of int
        Rows of the run.
    station : (M,) array, mm
        Along them.
    """
    speeds = np.zeros(len(segment))
    for leg in run.legs:
        at = slice(*np.searchsorted(segment, (leg.first, leg.last)))
        if at.stop > at.start:
            part = run.segments[leg.first : leg.last]
            passing = Passing(segments=part, motion=control.plan(part, limits))
            speeds[at] = passing.speeds(segment[at] - leg.first, station[at])
    return speeds
