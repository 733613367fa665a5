"""Stock assumed for given tool paths in a program that describes no raw part. Unit mm.

A given path does not say how much it removes. Where all workingsteps of a setup have given
paths, the raw part is taken to be the box that their tools sweep at a feed, up to the highest
feature: every path then removes what those before it left. A path that comes down at the edge
of this box is taken to come down beside the part, and the box ends where the tool stands.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from stepnc_model.entities.executables import Setup
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.frame import feature_frame
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.left_out import TOUCHING, swept_box
from stepnc_model.toolpath.path import Move, Point, ToolPath

LEAST_HEIGHT = 0.1
"""Least height of a stock that is assumed, mm."""

ASSUMED = "no stock is known: assumed is the box that the given tool paths sweep, {0} mm"


def words_of(stock: Stock) -> str:
    """Sentence that states an assumed stock."""
    low, high = (",".join(f"{value:.4g}" for value in at) for at in (stock.low, stock.high))
    return ASSUMED.format(f"{low} to {high}")


def assumed_stock(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Box that the given tool paths of a setup sweep; None where a path is not given.

    Parameters
    ----------
    program : Program
    setup : Ref or None

    Returns
    -------
    Stock or None
    """
    steps = [step for step in program.workingsteps if step.setup == setup]
    if not steps or any(step.operation.its_toolpath is None for step in steps):
        return None
    paths = [path for step in steps if (path := _path(program, step)) is not None]
    boxes = [box for path in paths if (box := swept_box(program, path)) is not None]
    tops = [
        feature_frame(program, setup, feature).origin[2]
        for step in steps
        for feature in step.features
    ]
    if not boxes or not tops:
        return None
    x0, y0, low = (min(box.low[axis] for box in boxes) for axis in range(3))
    x1, y1 = (max(box.high[axis] for box in boxes) for axis in range(2))
    around = _Edges(x0, y0, x1, y1)
    for path in paths:
        around = _beside(program, path, around)
    top = max(tops)
    if top - low < LEAST_HEIGHT or around.area <= 0.0:
        return None
    return Stock(low=(around.x0, around.y0, low), high=(around.x1, around.y1, top))


@dataclass(frozen=True, slots=True)
class _Edges:
    """Edges of a stock in plan, mm."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        """Area, mm²; 0 where nothing is left."""
        return max(0.0, self.x1 - self.x0) * max(0.0, self.y1 - self.y0)


def _beside(program: Program, path: ToolPath, edges: _Edges) -> _Edges:
    """Edges that leave out the tool where a path comes down within its radius of an edge."""
    begin = next(iter(_starts(path)), None)
    if begin is None or path.tool_ref is None:
        return edges
    radius = 0.5 * tool_of(program, path.tool_ref).diameter
    x, y, _ = begin
    reach = radius + TOUCHING
    others = [
        replace(edges, **{name: at})
        for name, at, is_near in (
            ("x0", x + radius, x - edges.x0 < reach),
            ("y0", y + radius, y - edges.y0 < reach),
            ("x1", x - radius, edges.x1 - x < reach),
            ("y1", y - radius, edges.y1 - y < reach),
        )
        if is_near
    ]
    is_inside = edges.x0 - reach < x < edges.x1 + reach and (
        edges.y0 - reach < y < edges.y1 + reach
    )
    return max(others, key=lambda each: each.area) if others and is_inside else edges


def _starts(path: ToolPath) -> Iterator[Point]:
    """Start of the first move at a feed."""
    at = path.start
    for move in path.steps:
        if isinstance(move, Move):
            if move.feed is not None:
                yield at
                return
            at = move.end


def _path(program: Program, step: ResolvedWorkingstep) -> ToolPath | None:
    """Path of a workingstep; None where it cannot be made."""
    try:
        return workingstep_path(program, step)
    except SchemaError:
        return None
