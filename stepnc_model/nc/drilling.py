"""Drilling cycles as moves: their feed is one number for all of them."""

from collections.abc import Iterator
from math import isnan, nan

from stepnc_model.nc.moves import MoveKind
from stepnc_model.post.blocks import DrillingCycle, Linear, Rapid, Rate, expanded
from stepnc_model.toolpath.path import CycleKind, Point

CycleMove = tuple[MoveKind, Point]


def cycle_moves(cycle: DrillingCycle) -> Iterator[CycleMove]:
    """Moves of a drilling cycle from its retract plane and back to it.

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
    for block in expanded(cycle).expansion:
        if isinstance(block, Linear):
            yield MoveKind.LINE, block.end
        elif isinstance(block, Rapid):
            yield MoveKind.RAPID, block.end


def drilling(
    kind: CycleKind,
    at: tuple[float, float],
    *,
    retract: float,
    bottom: float,
    step: float = 0.0,
    above: float = nan,
) -> DrillingCycle:
    """Drilling cycle without its feed, which stands in the moves.

    Parameters
    ----------
    kind : CycleKind
    at : tuple of 2 floats, mm
    retract, bottom : float, mm
        Heights of the retract plane and of the bottom.
    step : float, mm
        Depth of each peck; 0 for none.
    above : float, mm
        Height above the last depth, or of a short retract; NaN for the usual one.
    """
    return DrillingCycle(
        kind=kind,
        at=at,
        retract_z=retract,
        bottom_z=bottom,
        rate=Rate(value=nan),
        step_depth=abs(step),
        retract_distance=CLEARANCE if isnan(above) else abs(above),
    )


CLEARANCE = 0.254
"""Height above the last depth after a retract, mm: fixed in LinuxCNC, a parameter elsewhere."""
