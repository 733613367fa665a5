"""Path smoothing of a control: the memory of its filter, corners and arcs. Units mm, s.

A control with a fixed-time filter averages the commanded velocity over a window W = T1 + T2.
The tool lags half a window behind the command, so that a feed c holds at a place only if the
command is at most c from ``c·W/2`` before it to ``c·W/2`` after it: while the whole window
lies in that stretch, the mean is at most c; before, the tool has not reached the place, and
after, it has left it. A control that plans its speed along the path (exact stop, junction
deviation) keeps each feed where it is commanded.

References
----------
.. [1] Corners are rounded by ``e = v·(T1/4 + T2²/(12·T1))·sin(φ/2)``; see
   :mod:`simulator.motion.fir`. An arc of radius r shrinks by ``v²·(T1² + T2²)/(24·r)``, the
   first term of the filter's gain at the frequency v/r.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.fir import FilterWithinLimits, FixedTimeFilter, shortest_filter
from simulator.motion.segments import AxisLimits, ControlModel


@dataclass(frozen=True, slots=True, kw_only=True)
class Smoothing:
    """Times of a control's two averages; both are 0 for a control without a filter."""

    first: float = 0.0
    """Time T1 of the first average, s."""
    second: float = 0.0
    """Time T2 of the second average, s."""

    @property
    def window(self) -> float:
        """Length of the filter window T1 + T2, s."""
        return self.first + self.second

    @property
    def reach(self) -> float:
        """Distance over which a feed must be commanded around its place, over that feed, s."""
        return 0.5 * self.window

    @property
    def corner_gain(self) -> float:
        """Rounding of a corner over ``v·sin(φ/2)``, [1]_, s; 0 without a filter."""
        if self.first == 0.0:
            return 0.0
        return self.first / 4.0 + self.second**2 / (12.0 * self.first)

    @property
    def arc_gain(self) -> float:
        """Shrinking of an arc over ``v²·κ``, κ its curvature, [1]_, s²."""
        return (self.first**2 + self.second**2) / 24.0


def smoothing_of(control: ControlModel, limits: AxisLimits, greatest: float) -> Smoothing:
    """Smoothing of a control in a run of feed moves.

    Parameters
    ----------
    greatest : float, mm/s
        Greatest commanded feed of the run, by which :class:`FilterWithinLimits` chooses its
        filter.
    """
    match control:
        case FilterWithinLimits():
            chosen = shortest_filter(limits, np.full(3, 2.0 * greatest))
        case FixedTimeFilter():
            chosen = control
        case _:
            return Smoothing()
    return Smoothing(first=chosen.first, second=chosen.second)
