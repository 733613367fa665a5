"""Drilling cycles as moves: their feed is one number for all of them."""

from collections.abc import Iterator
from math import isnan, nan

from stepnc_model.nc.moves import MoveKind
from stepnc_model.nc.spindle import SpindleBlock
from stepnc_model.post.blocks import (
    Block,
    DrillingCycle,
    Linear,
    Rapid,
    Rate,
    SpindleOff,
    expanded,
)
from stepnc_model.toolpath.path import CycleKind, Point

CycleMove = tuple[MoveKind, Point]


def cycle_moves(
    cycle: DrillingCycle, spindle: SpindleBlock | None = None
) -> Iterator[CycleMove | Block]:
    """Moves, pauses and switches of a drilling cycle from its retract plane and back to it.

    Parameters
    ----------
    cycle : DrillingCycle
    spindle : SpindleOn, SurfaceSpeed or SpindleOff, optional
        Spindle state to restore after a cycle that stops the spindle.

    Raises
    ------
    PostError
        If the cycle has too many pecks.
    """
    if cycle.kind is CycleKind.TAP:
        yield MoveKind.THREAD, (*cycle.at, cycle.bottom_z)
        yield MoveKind.THREAD, (*cycle.at, cycle.retract_z)
        return
    if isnan(sum((*cycle.at, cycle.retract_z, cycle.bottom_z))):
        yield MoveKind.LINE, (*cycle.at, cycle.bottom_z)
        yield MoveKind.RAPID, (*cycle.at, cycle.retract_z)
        return
    turning = None if isinstance(spindle, SpindleOff) else spindle
    for block in expanded(cycle, turning).expansion:
        if isinstance(block, Linear):
            yield MoveKind.LINE, block.end
        elif isinstance(block, Rapid):
            yield MoveKind.RAPID, block.end
        else:
            yield block


def drilling(
    kind: CycleKind,
    at: tuple[float, float],
    *,
    heights: tuple[float, float],
    step: float = 0.0,
    above: float = nan,
    dwell: float = 0.0,
) -> DrillingCycle:
    """Drilling cycle without its feed, which stands in the moves.

    Parameters
    ----------
    kind : CycleKind
    at : tuple of 2 floats, mm
    heights : tuple of 2 floats, mm
        Heights of the retract plane and of the bottom.
    step : float, mm
        Depth of each peck; 0 for none.
    above : float, mm
        Height above the last depth, or of a short retract; NaN for the usual one.
    dwell : float, s
        Pause at the bottom; not known where it is NaN, and then left out.
    """
    return DrillingCycle(
        kind=kind,
        at=at,
        retract_z=heights[0],
        bottom_z=heights[1],
        rate=Rate(value=nan),
        step_depth=abs(step),
        retract_distance=CLEARANCE if isnan(above) else abs(above),
        dwell=0.0 if isnan(dwell) else max(0.0, dwell),
    )


CLEARANCE = 0.254
"""Height above the last depth after a retract, mm: fixed in LinuxCNC, a parameter elsewhere."""
