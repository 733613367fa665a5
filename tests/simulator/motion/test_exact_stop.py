from dataclasses import replace

import numpy as np
import pytest

from simulator.motion.exact_stop import ExactStop
from simulator.motion.motion import AxisLimits
from simulator.motion.segments import lines
from simulator.physics.motion import move_time
from tests_typing import Drift, Wander


def _mill(rapid: float) -> AxisLimits:
    """The machine of paper 003, Fig. 5: 6 m/s²."""
    return AxisLimits(
        acceleration=np.full(3, 6000.0), rapid=np.full(3, rapid), feed=np.full(3, rapid)
    )
