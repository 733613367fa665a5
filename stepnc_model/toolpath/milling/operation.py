"""Milling: from areas and flanks to the tool's path, level by level.

Finishing after a roughing operation cuts the walls at each level and sweeps the floor once;
without one it clears the whole depth. Passes between which the tool stays in the area are
linked at the feed; for all others it is lifted.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.milling import (
    BottomAndSideFinishMilling,
    BottomAndSideMilling,
    BottomAndSideRoughMilling,
    PlaneFinishMilling,
    PlaneMilling,
    PlaneRoughMilling,
    PlungeToolaxis,
    SideFinishMilling,
    SideMilling,
    Two5dMillingOperation,
)
from stepnc_model.toolpath.frame import placements
from stepnc_model.toolpath.milling.area import Area, Flank
from stepnc_model.toolpath.milling.contour import TINY, Chain, line
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.enter import Heights, enter, leave, trace
from stepnc_model.toolpath.milling.flank import flank_layer, tee_layers
from stepnc_model.toolpath.milling.layer import CutLevel, Layer, clear, wall_passes
from stepnc_model.toolpath.milling.offset import contains
from stepnc_model.toolpath.milling.shapes import shapes
from stepnc_model.toolpath.milling.strategy import (
    EndMillShape,
    ResolvedStrategy,
    cutter_of,
    way_of,
)
from stepnc_model.toolpath.milling.strokes import ClippedChain, is_inside, pieces
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.task import ABOVE_STOCK, DEFAULT_CLEARANCE, PathBuilder, ToolPathTask

T_SLOT_MILL = "T_SLOT_MILL"
"""body of the only tool that makes the bar of a tee slot"""

GAP = 0.5
"""mm above the material of a level where the way down through air ends"""

LINK = 2.0
"""steps between two passes that are linked at the feed; further apart the tool is lifted"""

LARGEST = 1000.0
"""mm of allowance; more is a slip"""

MOST_LEVELS = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Allowance:
    """Allowance of an operation, mm."""

    side: float
    bottom: float


def milling_path(job: ToolPathTask) -> ToolPath:
    """Tool path of a milling workingstep.

    Raises
    ------
    PathError
        When the tool does not fit, or feature, strategy or allowances allow no path.
    """
    operation = job.step.operation
    if not isinstance(operation, Two5dMillingOperation):
        raise job.fault(
            f"{job.step.operation_type} needs a tool path of its own: none is given",
            job.step.operation_ref,
            "its_toolpath",
        )
    cutter = cutter_of(job)
    way = way_of(job, cutter)
    found = [
        (shape, list(_layers(job, shape, cutter, way)))
        for feature in job.step.features
        for placed in placements(job.program, job.step.setup, feature)
        for shape in shapes(job, placed.feature, placed.frame)
    ]
    if not found:
        raise job.fault("has no feature: nothing tells what to cut", job.step.ref)
    first = found[0][1][0].passes[0].start
    course = PathBuilder(job, (first.real, first.imag, job.security_z))
    for finding in way.findings:
        course.find(finding)
    for shape, _ in found:
        _warn_beside_stock(course, job, shape)
    planes = [_retract_z(job, course, shape) for shape, _ in found]
    travel_z = _travel_z(job, max(planes))
    for (shape, layers), retract_z in zip(found, planes, strict=True):
        for layer in layers:
            heights = Heights(
                travel=travel_z,
                retract=retract_z,
                above=min(layer.above + GAP, retract_z),
                level=layer.z,
            )
            _cut_layer(course, job, operation, layer, heights=heights, way=way)
        if (
            isinstance(shape, Area)
            and shape.bar is not None
            and job.tool.keyword != T_SLOT_MILL
        ):
            text = "only the neck of the tee slot is made: its bar takes a T-slot mill"
            course.find(job.warning(text, shape.ref))
        lowest = min(layer.z for layer in layers)
        missing = lowest - shape.bottom - allowance_of(job, operation).bottom
        if missing > 1e-6:
            text = f"the tool does not fit below z = {lowest:g} mm: {missing:.4g} mm are left"
            course.find(job.warning(text, shape.ref))
    x, y, _ = course.at
    course.rapid((x, y, job.security_z), MoveType.RETRACT)
    return course.finished()


def _warn_beside_stock(course: PathBuilder, job: ToolPathTask, shape: Area | Flank) -> None:
    """Say that a feature lies wholly beside the stock: a placement may count twice."""
    if job.stock is None:
        return
    chains = (shape.chain,) if isinstance(shape, Flank) else [wall.loop for wall in shape.walls]
    faces = [shape.face] if isinstance(shape, Area) and shape.face is not None else []
    points = [edge.start for chain in (*chains, *faces) for edge in chain]
    for pick, axis in ((lambda at: at.real, 0), (lambda at: at.imag, 1)):
        low, high = min(map(pick, points)), max(map(pick, points))
        if low > job.stock.high[axis] or high < job.stock.low[axis]:
            text = f"lies beside the stock: {'xy'[axis]} from {low:g} to {high:g} mm"
            course.find(job.warning(text, shape.ref))
            return


def allowance_of(job: ToolPathTask, operation: Entity) -> Allowance:
    """Allowance of an operation on walls and floor.

    Raises
    ------
    PathError
        When it is negative.
    """
    values = {}
    for name in ("allowance_side", "allowance_bottom"):
        value = getattr(operation, name, None) or 0.0
        if not 0.0 <= value < LARGEST:
            raise job.fault(
                f"{value:g} mm: an allowance lies between 0 and {LARGEST:g} mm",
                job.step.operation_ref,
                name,
            )
        values[name] = float(value)
    return Allowance(side=values["allowance_side"], bottom=values["allowance_bottom"])


def levels(top: float, bottom: float, depth: float) -> list[float]:
    """Heights of equal levels down to the bottom, none deeper than a depth, mm."""
    count = max(1, ceil((top - bottom) / depth - 1e-9))
    return [top + (bottom - top) * (index + 1) / count for index in range(count)]


def _layers(
    job: ToolPathTask, shape: Area | Flank, cutter: EndMillShape, way: ResolvedStrategy
) -> Iterator[Layer]:
    """Passes of one shape, from the top down as far as the cutter fits in."""
    if isinstance(shape, Area) and shape.bar is not None and job.tool.keyword == T_SLOT_MILL:
        yield from tee_layers(job, shape, shape.bar, cutter)
        return
    allowance = allowance_of(job, job.step.operation)
    earlier = _earlier(job)
    start, floor = _span(job, shape, allowance, earlier)
    above, count = start, 0
    depth = _axial_depth(job, start - floor)
    for z in _heights(job, shape, allowance, start=start, floor=floor, depth=depth):
        level = CutLevel(z=z, above=above, cutter=cutter, allowance=allowance.side)
        layer = _layer(job, shape, level, way, floor=floor, earlier=earlier)
        if layer is None or not layer.passes:
            break
        yield layer
        above, count = z, count + 1
    if count == 0:
        raise job.fault(
            f"'{job.tool.id}' of {job.tool.diameter:g} mm does not fit in"
            + (f" with {allowance.side:g} mm left on the walls" if allowance.side else ""),
            shape.ref,
        )


def _heights(
    job: ToolPathTask,
    shape: Area | Flank,
    allowance: Allowance,
    *,
    start: float,
    floor: float,
    depth: float,
) -> Iterator[float]:
    """Levels of a shape; the tops of low islands are levels too.

    Yields
    ------
    float
        z in the setup, mm, falling.
    """
    tops = shape.terraces if isinstance(shape, Area) else []
    stops = [top + allowance.bottom for top in tops if floor < top + allowance.bottom < start]
    if (start - floor) / depth > MOST_LEVELS:
        raise job.fault(
            f"{depth:g} mm: more than {MOST_LEVELS} levels over {start - floor:g} mm",
            job.step.operation_ref,
            "axial_cutting_depth",
        )
    for top, bottom in pairwise([start, *stops, floor]):
        yield from levels(top, bottom, depth)


def _layer(
    job: ToolPathTask,
    shape: Area | Flank,
    level: CutLevel,
    way: ResolvedStrategy,
    *,
    floor: float,
    earlier: Allowance | None,
) -> Layer | None:
    """Passes of one level, or None where the cutter does not fit."""
    operation = job.step.operation
    if isinstance(shape, Flank):
        finishes = isinstance(operation, (SideFinishMilling, BottomAndSideFinishMilling))
        return flank_layer(job, shape, level, way, is_single=finishes and earlier is not None)
    if isinstance(operation, SideMilling):
        if not shape.walls:
            raise job.fault("has no walls that could be milled from the side", shape.ref)
        return wall_passes(shape, level, way)
    if isinstance(operation, BottomAndSideFinishMilling) and earlier is not None:
        has_floor_left = earlier.bottom > floor - shape.bottom
        if level.z > floor + 1e-9 or not has_floor_left:
            return wall_passes(shape, level, way)
    return clear(job, shape, level, way)


def _earlier(job: ToolPathTask) -> Allowance | None:
    """Allowance of the last earlier operation of the same kind on the feature, or None."""
    kinds = (PlaneMilling, SideMilling, BottomAndSideMilling)
    for step in reversed(job.program.before(job.step)):
        if isinstance(step.operation, kinds):
            return allowance_of(job, step.operation)
    return None


def _span(
    job: ToolPathTask, shape: Area | Flank, allowance: Allowance, earlier: Allowance | None
) -> tuple[float, float]:
    """Heights between which the operation removes material."""
    floor = shape.bottom + allowance.bottom
    start = shape.top
    if isinstance(job.step.operation, PlaneFinishMilling) and earlier is not None:
        start = min(start, shape.bottom + earlier.bottom)
    if earlier is not None and abs(start - floor) <= 1e-9:
        # Nothing was left on the floor: one pass smooths it.
        return floor, floor
    if start - floor <= 1e-9:
        raise job.fault(
            f"leaves {allowance.bottom:g} mm of {start - shape.bottom:g} mm: "
            "nothing is removed",
            job.step.operation_ref,
            "allowance_bottom",
        )
    return start, floor


def _axial_depth(job: ToolPathTask, total: float) -> float:
    """Depth of a level: as programmed, else what the cutting edge reaches, mm."""
    depth = getattr(job.step.operation, "axial_cutting_depth", None)
    if depth is None:
        return min(total, job.tool.cutting_edge_length or total) or 1.0
    if not 0.0 < depth < float("inf"):
        raise job.fault(
            f"{depth:g} mm: a depth of cut is positive",
            job.step.operation_ref,
            "axial_cutting_depth",
        )
    return float(depth)


def _retract_z(job: ToolPathTask, course: PathBuilder, shape: Area | Flank) -> float:
    """Height of the retract plane over a shape."""
    distance = job.step.operation.retract_plane
    if distance is None:
        distance = DEFAULT_CLEARANCE
        text = f"no retract plane: {distance:g} mm above the feature assumed"
        course.find(job.note(text, None, "retract_plane"))
    if distance < 0.0:
        raise job.fault(
            f"{distance:g} mm: the retract plane lies above the feature",
            job.step.operation_ref,
            "retract_plane",
        )
    if job.security_z <= shape.top:
        raise job.fault(
            f"the security plane at z = {job.security_z:g} mm does not lie above the feature, "
            f"which begins at z = {shape.top:g} mm",
            job.step.ref,
            "its_secplane",
        )
    return min(shape.top + distance, job.security_z)


def _cut_layer(
    course: PathBuilder,
    job: ToolPathTask,
    operation: Two5dMillingOperation,
    layer: Layer,
    *,
    heights: Heights,
    way: ResolvedStrategy,
) -> None:
    """All passes of one level."""
    room = layer.room
    last: MillingPass | None = None
    for cut in layer.passes:
        here = complex(course.at[0], course.at[1])
        current = cut if last is None else cut.from_near(here)
        if last is not None and _is_linked(here, current, layer, way):
            course.line((current.start.real, current.start.imag, layer.z), MoveType.CONTACT)
        else:
            if last is not None:
                leave(course, job, last, heights=heights, room=room, retract=None)
            approach = None if layer.is_from_outside else operation.approach
            current = enter(course, job, current, heights=heights, room=room, approach=approach)
            _warn_of_plunge(course, job, operation, layer, current)
        _cut(course, current.chain, layer)
        last = current
    if last is not None:
        retract = None if layer.is_from_outside else operation.retract
        leave(course, job, last, heights=heights, room=room, retract=retract)


def _warn_of_plunge(
    course: PathBuilder,
    job: ToolPathTask,
    operation: Two5dMillingOperation,
    layer: Layer,
    cut: MillingPass,
) -> None:
    """Say that an end mill goes straight down into solid material, where it does."""
    if not isinstance(operation, (PlaneRoughMilling, BottomAndSideRoughMilling)):
        return
    strategy = job.program.get(operation.approach) if operation.approach is not None else None
    is_straight = strategy is None or isinstance(strategy, PlungeToolaxis)
    if is_straight and (
        not layer.solid or any(contains(layer.solid, [cut.start], tolerance=1e-3))
    ):
        text = "straight down into the material: a ramp spares the tool"
        course.find(job.warning(text, attribute="approach"))


def _cut(course: PathBuilder, chain: Chain, layer: Layer) -> None:
    """Follow a pass, through material and through air."""
    found = pieces(chain, layer.solid) if layer.solid else [ClippedChain(chain, is_inside=True)]
    for piece in found:
        type = MoveType.CONTACT if piece.is_inside else MoveType.NO_CONTACT
        trace(course, piece.chain, z=layer.z, end_z=layer.z, type=type)


def _travel_z(job: ToolPathTask, retract_z: float) -> float:
    """Height at which the tool moves sideways: over the stock, which may stand higher."""
    if job.stock is None or retract_z >= job.stock.high[2] + ABOVE_STOCK:
        return retract_z
    return max(job.security_z, job.stock.high[2] + ABOVE_STOCK)


def _is_linked(
    here: complex, following: MillingPass, layer: Layer, way: ResolvedStrategy
) -> bool:
    """Whether the way to the next pass may be made at the feed."""
    distance = abs(following.start - here)
    if distance < TINY:
        return True
    if way.is_lifted or distance > LINK * way.step:
        return False
    if layer.loops:
        return is_inside(here, following.start, layer.loops)
    return layer.room.holds((line(here, following.start),))
