"""Continuous path with junction deviation: corners are taken at a speed, not at rest.

At a corner a circle touches both directions and passes the corner at the distance of the
deviation e; the speed is that at which the circle needs the centripetal acceleration a:
``v² = a·e·S/(1−S)``, S = sin(θ/2), θ the angle between the two segments (π: straight on). The
circle sets the speed only: the path keeps its corner, so the speed along the path is
continuous while the velocity of an axis jumps there, as the model has it.

The control stops before, after and between rapids, and reads blocks ahead: one without length
takes no time. Units mm, s.

References
----------
.. [1] S. K. Jeon, "Improving Grbl: Cornering algorithm", 2011: junction deviation.
.. [2] S. S. Skogsrud and S. K. Jeon, Grbl 1.1, planner: the acceleration that the axes reach
   in the direction in which the velocity changes.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.motion import AxisLimits
from simulator.motion.path_limits import corners, is_stop, least, path_limits
from simulator.motion.phases import Phases
from simulator.motion.segments import Floats, Segments
from simulator.motion.sweep import swept


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionDeviation:
    """A control that looks ahead over the whole stretch.

    Raises
    ------
    ValueError
        When the deviation is not positive.
    """

    deviation: float
    """mm, e"""

    def __post_init__(self) -> None:
        if not 0.0 < self.deviation < np.inf:
            raise ValueError(f"junction deviation {self.deviation:g} mm must be positive")

    def plan(self, segments: Segments, limits: AxisLimits) -> Phases:
        """Motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            When there is no segment, or a segment's speed has no bound at all.
        """
        bounds = path_limits(segments, limits)
        rows = np.flatnonzero(segments.length > 0.0)
        moving = segments[rows]
        corner = corner_squares(moving, limits.acceleration, deviation=self.deviation)
        corner = np.where(is_stop(moving), 0.0, corner)
        return swept(segments, rows, limits=bounds, corner=corner)


def corner_squares(segments: Segments, acceleration: Floats, *, deviation: float) -> Floats:
    """Greatest squared speed at each corner, ``a·e·S/(1−S)``, [1]_.

    Parameters
    ----------
    segments : Segments
        N of them, each with a length.
    acceleration : (3,) array, mm/s²
        Of the axes; a is what they reach along the change of velocity, [2]_.
    deviation : float, mm

    Returns
    -------
    (N−1,) array, mm²/s²
        Infinite where the path goes straight on, 0 where it turns back.
    """
    before, after = corners(segments)
    change = np.linalg.norm(after - before, axis=1)
    sine = 0.5 * np.linalg.norm(after + before, axis=1)
    squares = np.full(len(change), np.inf)
    bent = np.flatnonzero(change > 0.0)
    share = np.abs(after - before)[bent] / change[bent, None]
    # 1 − S = (1 − S²)/(1 + S) = (|Δd|/2)²/(1 + S), without cancellation near straight on.
    radius = deviation * sine[bent] * (1.0 + sine[bent]) * (2.0 / change[bent]) ** 2
    squares[bent] = least(acceleration, share) * radius
    return squares
