"""Workingsteps without a path, and the later ones that depend on them by their geometry.

A later workingstep meets material that a workingstep without a path would have removed where
the boxes that both tools sweep at a feed overlap, in the same setup. Where a box is not known,
because no path can be made, the later workingsteps on the same feature depend on it. Unit mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

from stepnc_model.errors import SchemaError
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.arc import radius
from stepnc_model.toolpath.path import Move, Point, ToolPath

TOUCHING = 1e-3
"""Overlap up to which two boxes only touch, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptBox:
    """Box around the tool on all moves at a feed, mm."""

    low: Point
    high: Point

    def overlaps(self, other: "SweptBox") -> bool:
        """True if two boxes share more than their surfaces."""
        return all(
            self.low[axis] + TOUCHING < other.high[axis]
            and other.low[axis] + TOUCHING < self.high[axis]
            for axis in range(3)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Omission:
    """Workingstep that was left out, with its box where that is known."""

    step: ResolvedWorkingstep
    box: SweptBox | None


class LeftOut:
    """Workingsteps of a program that were left out so far (mutable)."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._omissions: list[_Omission] = []

    def add(self, step: ResolvedWorkingstep, path: ToolPath | None) -> None:
        """Leave out a workingstep, with its path if one could be made."""
        box = None if path is None else swept_box(self._program, path)
        self._omissions.append(_Omission(step=step, box=box))

    def require_ready(self, step: ResolvedWorkingstep, path: ToolPath) -> None:
        """Raise an error if a workingstep depends on one that was left out.

        Raises
        ------
        PathError
            With the id of the workingstep that was left out.
        """
        if not self._omissions:
            return
        box = swept_box(self._program, path)
        for each in self._omissions:
            if _depends(step, box, each):
                message = f"the feature is not ready: workingstep '{each.step.id}' was left out"
                raise self._program.path_error(message, step.ref)


def _depends(step: ResolvedWorkingstep, box: SweptBox | None, omission: _Omission) -> bool:
    """True if a workingstep would meet material of one that was left out."""
    if step.setup == omission.step.setup and box is not None and omission.box is not None:
        return box.overlaps(omission.box)
    return bool({int(ref) for ref in step.features} & {*map(int, omission.step.features)})


def swept_box(program: Program, path: ToolPath) -> SweptBox | None:
    """Box around the tool on the moves of a path at a feed; None if there is none.

    Returns
    -------
    SweptBox or None
    """
    if path.tool_ref is None:
        return None
    try:
        half = 0.5 * tool_of(program, path.tool_ref).diameter
    except SchemaError:
        return None
    low, high = [inf, inf, inf], [-inf, -inf, -inf]
    for point, around in _fed_points(path):
        for axis in range(3):
            low[axis] = min(low[axis], point[axis] - around[axis])
            high[axis] = max(high[axis], point[axis] + around[axis])
    if low[0] > high[0]:
        return None
    return SweptBox(
        low=(low[0] - half, low[1] - half, low[2]),
        high=(high[0] + half, high[1] + half, high[2]),
    )


def _fed_points(path: ToolPath) -> Iterator[tuple[Point, Point]]:
    """Ends of all moves at a feed, and centres of arcs with their extent along the axes."""
    at = path.start
    for move in path.steps:
        if not isinstance(move, Move):
            continue
        if move.feed is not None:
            yield at, (0.0, 0.0, 0.0)
            yield move.end, (0.0, 0.0, 0.0)
            if move.arc is not None:
                normal = move.arc.plane.axes[2]
                x, y, z = (
                    at[axis] if axis == normal else move.arc.centre[axis] for axis in range(3)
                )
                size = radius(at, move.arc)
                dx, dy, dz = (0.0 if axis == normal else size for axis in range(3))
                yield (x, y, z), (dx, dy, dz)
        at = move.end
