"""Tool paths that a search has tried, and what it read and changed. Units mm, s.

Program with another depth of its passes, as :mod:`stepnc_model.editing.writeback` would write
it.

Stock that a path in another number of passes leaves, compared with the programmed path.

On a sloped or round flank the levels of a mill leave stairs, and so do the passes of a turning
tool along a cone: fewer, deeper passes leave more to the next tool. Such a number is no
candidate, for the workingsteps after it were programmed for the stock that the program leaves.
"""

from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

from optimiser.cuts.cut import Cut
from optimiser.cuts.fixtured_stock import Change, StockMap, StockPlace, TrialContacts
from optimiser.cuts.hardest_places import Bending, PathContacts
from optimiser.cuts.plunge_engagement import PlungeCuts
from simulator.motion.segments import Bools, Floats
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.difference import StockDifference, bar_difference, height_difference
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import StationKind
from simulator.removal.trial import Box, PathTrial
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.path import ToolPath


@dataclass(frozen=True, slots=True, kw_only=True)
class TriedPath:
    """Tool path that was tried, with its contacts, its cut and its timing."""

    path: ToolPath
    run: ToolPathRun
    """Run of the path at the programmed feeds and speeds."""
    cut: Cut
    """Cut with the engagement met along the path."""
    passes: int
    weighted: float
    """Chip-weighted volume over that of the hardest place, mm."""
    air: float
    """Share of the length that removes nothing."""
    meeting: TrialContacts
    along: PathContacts | None
    """Contacts along the passes; None when they are not known."""
    bent: Bending | None
    """Bending forces of an end mill at these contacts."""
    slope: PlungeCuts | None
    """Contacts down ramps; None when there are no ramps."""
    times: dict[tuple[float, float, float | None], Cut] = field(default_factory=dict)
    """Timed cuts by feed ratio, speed ratio and plunge feed, filled on demand."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchTrace:
    """Trace of the search for a workingstep's setting: what it read and changed."""

    place: StockPlace | None = None
    """Stock map that the workingstep cuts."""
    change: Change | None = None
    trial: PathTrial | None = None
    """Milling trial of the change; None when the tool is not a mill."""
    trials: tuple[PathTrial, ...] = ()
    """Trials of all paths that were tried."""
    left_out: dict[int, str] = field(default_factory=dict)
    """Features whose path could not be made, with the id of the workingstep."""


def air_share(run: ToolPathRun, met: PathContacts, is_bound: Bools) -> float:
    """Share of the time at the programmed feed in which nothing is removed."""
    row = met.stations.segment
    seconds = met.length / run.segments.speed[row]
    bound = is_bound[row]
    whole = float(seconds[bound].sum())
    is_air = bound & (met.stations.kind == StationKind.AIR)
    return float(seconds[is_air].sum()) / whole if whole > 0.0 else 0.0


def with_depth(
    program: Program, step: ResolvedWorkingstep, depth: float
) -> tuple[Program, ResolvedWorkingstep]:
    """Copy of a program and a workingstep with a different depth of its passes.

    Raises
    ------
    PathError
        When the file does not let the depth be chosen.
    """
    operation: Any = step.operation
    if hasattr(operation, "axial_cutting_depth") and not operation.its_toolpath:
        other = replace(operation, axial_cutting_depth=depth)
        return program, replace(step, operation=other)
    strategy: Ref[Entity] | None = getattr(operation, "its_machining_strategy", None)
    entity: Any = None if strategy is None else program.get(strategy)
    if strategy is None or not hasattr(entity, "cutting_depth") or operation.its_toolpath:
        raise PathError("the file sets no depth of its passes", entity=str(step.ref))
    changed = copy(program)
    changed.model = _Changed(program.model, strategy, replace(entity, cutting_depth=(depth,)))
    return changed, step


class _Changed(Model):
    """Entities of a program with one entity replaced."""

    def __init__(self, model: Model, ref: Ref[Entity], entity: Entity) -> None:
        super().__init__(model.file)
        self._model, self._number, self._entity = model, int(ref), entity

    def entity(self, id: int, /) -> Entity | None:
        """Return the entity of an instance number."""
        return self._entity if id == self._number else self._model.entity(id)


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
