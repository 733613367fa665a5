"""Stock that a path in another number of passes leaves, compared with the programmed path.

On a sloped or round flank the levels of a mill leave stairs, and so do the passes of a turning
tool along a cone: fewer, deeper passes leave more to the next tool. Such a number is no
candidate, for the workingsteps after it were programmed for the stock that the program leaves.
"""

from optimiser.clamped import StockMap, TrialContacts
from simulator.motion.segments import Floats
from simulator.removal.difference import StockDifference, bar_difference, height_difference
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.trial import Box, PathTrial


def difference_left(
    stock: StockMap | None, one: TrialContacts, other: TrialContacts
) -> StockDifference | None:
    """Difference of the stock after one path from that after another; None if not known.

    Parameters
    ----------
    stock : MillingStock or TurningStock or None
        The stock before both paths.
    one, other : TrialContacts
        Contacts of the paths with this stock.
    """
    if one.trial is not None and other.trial is not None and isinstance(stock, MillingStock):
        return _milled(stock, one.trial, other.trial)
    changes = one.change, other.change
    match (*changes, stock):
        case BarRadii() as bar, BarRadii() as wanted, TurningStock(cell=cell):
            return bar_difference(bar, wanted, cell=cell, within=cell)
    return None


def _milled(stock: MillingStock, one: PathTrial, other: PathTrial) -> StockDifference:
    """Difference within the cells that either path may have changed."""
    grid = stock.map.grid
    box = _around(one.box, other.box)
    after = [_after(grid.heights, box, each) for each in (one, other)]
    return height_difference(*after, cells=(grid.dx, grid.dy), within=stock.map.cell)


def _around(one: Box, other: Box) -> Box:
    """Cells around two boxes; a path that stays above the stock has an empty one."""
    if not all(side.stop > side.start for side in one):
        return other
    if not all(side.stop > side.start for side in other):
        return one
    columns, rows = (
        slice(min(a.start, b.start), max(a.stop, b.stop))
        for a, b in zip(one, other, strict=True)
    )
    return columns, rows


def _after(heights: Floats, box: Box, trial: PathTrial) -> Floats:
    """Heights in a box after a path of which the map knows nothing yet."""
    after = heights[box].copy()
    inside = tuple(
        slice(side.start - whole.start, side.stop - whole.start)
        for side, whole in zip(trial.box, box, strict=True)
    )
    if trial.after.heights.size:
        after[inside] = trial.after.heights
    return after
