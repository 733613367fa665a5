"""Signals of a simulated run for plots, in bounded memory. Units mm, s, N, W, rev/s."""

from enum import IntEnum

import numpy as np

from service.buckets import BucketedRun, Buckets
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats


class SimulationSignal(IntEnum):
    """Signals of a run that are kept for plots; the value is the column index."""

    X_POWER = 0
    Y_POWER = 1
    Z_POWER = 2
    SPINDLE_POWER = 3
    COOLANT_POWER = 4
    BASE_POWER = 5
    TOTAL_POWER = 6
    FEED_PROGRAMMED = 7
    FEED_ACTUAL = 8
    SPINDLE_SPEED = 9
    FORCE = 10
    REMOVAL_RATE = 11
    OVERLOAD = 12
    """Overload, a :class:`simulator.machine.samples.Condition`."""


class TraceKeeper:
    """Collects the signals of a run for plots while it is simulated. Running state."""

    def __init__(self) -> None:
        self._buckets = Buckets(len(SimulationSignal))

    def add(self, samples: Samples) -> None:
        """Add samples, later than all before; NaN is a missing value."""
        self._buckets.add(samples.time, _values(samples))

    def trace(self) -> BucketedRun:
        """Return the signals collected so far."""
        return self._buckets.trace()


def _values(samples: Samples) -> Floats:
    """Return the signals as an array, (M, S), in the order of their numbers."""
    return np.column_stack((
        samples.axis_power,
        samples.spindle_power,
        samples.coolant_power,
        samples.base_power,
        samples.total_power,
        samples.feed_programmed,
        samples.path_speed,
        samples.spindle_speed,
        samples.cutting_force,
        samples.removal_rate,
        samples.overload,
    ))
