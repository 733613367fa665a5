"""Models of how a control runs a path: exact stop, and junction deviation. Units mm, s.

With exact stop every block begins and ends at rest, as the equations of the papers on virtual
machining have it, whose programs are long straight moves. A control with look-ahead runs no
path of short lines that way: the feeds of paper 004 grow with the spacing of points; with stops
they would grow with its root. The speed of a block is a trapezoid, or a triangle if it is too
short to reach its speed. Pieces of one block that continues straight on are one move. A feed
block without length takes the control's block time. References are in
:mod:`simulator.motion.sweep`.

With junction deviation corners are passed at a speed instead of at rest. At a corner a circle
touches both directions and passes the corner at the distance of the deviation e; the speed is
that at which the circle needs the centripetal acceleration a: ``v² = a·e·S/(1−S)``, S =
sin(θ/2), where θ is the angle between the two segments (π: straight on). The circle only
determines the speed: the path keeps its corner, so that the speed along the path is continuous
while the velocity of an axis jumps.

No model was identified on a machine of its own: exact stop was fitted to a mill that stops at
every block (``benchmarks.umich``); junction deviation has the default of Grbl; filter times
follow from the limits of the axes. ``stepnc blockfit`` tells which of them a machine
contradicts. LinuxCNC's planner is :mod:`simulator.motion.linuxcnc_planner`; it alone was
measured against its control (``benchmarks.linuxcnc``).

With junction deviation the control stops before, after and between rapids, and reads blocks
ahead: a block without length takes no time. The module also selects control models by name.

References
----------
.. [1] S. K. Jeon, "Improving Grbl: Cornering algorithm", 2011: junction deviation.
.. [2] S. S. Skogsrud and S. K. Jeon, Grbl 1.1, planner: the acceleration that the axes reach
   in the direction in which the velocity changes.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.fir import FilterWithinLimits, shortest_filter
from simulator.motion.linuxcnc_planner import LinuxCncPlanner
from simulator.motion.model_name import ControlModelName
from simulator.motion.path_limits import (
    block_lengths,
    corners,
    goes_on,
    is_stop,
    least,
    path_limits,
)
from simulator.motion.segments import AxisLimits, ControlModel, Floats, Segments
from simulator.motion.sweep import Phases, swept
from simulator.planner_settings import USUAL, PlannerSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactStop:
    """Control that waits at the end of each block until the axes stand still."""

    def plan(self, segments: Segments, limits: AxisLimits) -> Phases:
        """Plan the motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            If there is no segment, or a segment's speed is unlimited.
        """
        bounds = path_limits(segments, limits)
        is_pause = (block_lengths(segments) == 0.0) & ~segments.is_rapid
        rows = np.flatnonzero((segments.length > 0.0) | is_pause)
        corner = np.where(goes_on(segments[rows]), np.inf, 0.0)
        pause = limits.block_time
        return swept(segments, rows, limits=bounds, corner=corner, pause=pause)


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionDeviation:
    """Control with look-ahead over the whole stretch and corner speeds by junction deviation.

    Raises
    ------
    ValueError
        If the deviation is not positive.
    """

    deviation: float
    """Junction deviation e, mm."""

    def __post_init__(self) -> None:
        if not 0.0 < self.deviation < np.inf:
            raise ValueError(f"junction deviation {self.deviation:g} mm must be positive")

    def plan(self, segments: Segments, limits: AxisLimits) -> Phases:
        """Plan the motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            If there is no segment, or a segment's speed is unlimited.
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
        N segments, each with a length.
    acceleration : (3,) array, mm/s²
        Limits of the axes; a is what they reach along the change of velocity, [2]_.
    deviation : float, mm

    Returns
    -------
    (N−1,) array, mm²/s²
        Infinite where the path continues straight on, 0 where it reverses.
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


DEVIATION = 0.01
"""Default junction deviation, mm, as in Grbl 1.1 ($11)."""


def control_model(
    control: ControlModelName,
    limits: AxisLimits,
    *,
    deviation: float = DEVIATION,
    planner: PlannerSettings = USUAL,
) -> ControlModel:
    """Create the control model with a given name; filter times follow from the limits.

    Parameters
    ----------
    deviation : float, mm
        Deviation for :attr:`ControlModelName.JUNCTION`.
    planner : PlannerSettings
        Settings for :attr:`ControlModelName.LINUXCNC`.

    Returns
    -------
    ControlModel

    Raises
    ------
    ValueError
        If the deviation is not positive, or no filter times follow from the limits.
    """
    match control:
        case ControlModelName.EXACT_STOP:
            return ExactStop()
        case ControlModelName.JUNCTION:
            return JunctionDeviation(deviation=deviation)
        case ControlModelName.FIR:
            shortest_filter(limits, limits.rapid)
            return FilterWithinLimits()
        case ControlModelName.LINUXCNC:
            return LinuxCncPlanner(settings=planner)
