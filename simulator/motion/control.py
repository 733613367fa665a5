"""Control models by name, with customary numbers. Units mm, s."""

from enum import StrEnum

from simulator.motion.exact_stop import ExactStop
from simulator.motion.fir import FilterWithinLimits, shortest_filter
from simulator.motion.junction import JunctionDeviation
from simulator.motion.motion import AxisLimits, ControlModel

DEVIATION = 0.01
"""mm, default of grbl 1.1 ($11)"""


class Control(StrEnum):
    """How a control runs a path."""

    EXACT_STOP = "exact-stop"
    """each block from rest to rest"""
    JUNCTION = "junction"
    """continuous, corners at the speed of a junction deviation"""
    FIR = "fir"
    """axis commands filtered over fixed times"""


def control_model(
    control: Control, limits: AxisLimits, *, deviation: float = DEVIATION
) -> ControlModel:
    """The control model of a name, with times of the filter from the limits.

    Parameters
    ----------
    control : Control
    limits : AxisLimits
    deviation : float, mm
        Of :attr:`Control.JUNCTION`.

    Returns
    -------
    ControlModel

    Raises
    ------
    ValueError
        When the deviation is not positive, or the limits give the filter no times.
    """
    match control:
        case Control.EXACT_STOP:
            return ExactStop()
        case Control.JUNCTION:
            return JunctionDeviation(deviation=deviation)
        case Control.FIR:
            shortest_filter(limits, limits.rapid)
            return FilterWithinLimits()
