"""Tool path of a milling workingstep from its areas and flanks, level by level.

Finishing after a roughing operation cuts the walls at each level and sweeps the floor once;
without roughing it clears the whole depth. Passes between which the tool stays in the area are
linked at the feed; between other passes the tool is lifted.
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
from stepnc_model.toolpath.milling.contour import TINY, Chain, line
from stepnc_model.toolpath.milling.cover import Area, Flank, MillingPass
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
"""EXPRESS keyword of the only tool that cuts the undercut of a tee slot."""

GAP = 0.5
"""Clearance above the material of a level where the descent through air ends, mm."""

LINK = 2.0
"""Greatest distance of two passes linked at the feed, in steps between passes."""

LARGEST = 1000.0
"""Greatest allowance accepted, mm."""

MOST_LEVELS = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Allowance:
    """Allowances of a milling operation on walls and floor, mm."""

    side: float
    bottom: float


def milling_path(job: ToolPathTask) -> ToolPath:
    """Generate the tool path of a milling workingstep.

    Raises
    ------
    PathError
        If the tool does not fit, or feature, strategy or allowances allow no path.
    """
    operation = job.step.operation
    if not isinstance(operation, Two5dMillingOperation):
        raise job.fault(
            f"{job.step.operation_type} needs an explicit tool path, but none is given",
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
        raise job.fault("the workingstep has no feature to mill", job.step.ref, "its_feature")
    first = found[0][1][0].passes[0].start
    course = PathBuilder(job, (first.real, first.imag, job.security_z))
    for finding in way.findings:
        course.find(finding)
    for shape, _ in found:
        _warn_outside_stock(course, job, shape)
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
            text = "only the neck of the tee slot is cut: its undercut needs a T-slot mill"
            course.find(job.warning(text, shape.ref))
        lowest = min(layer.z for layer in layers)
        missing = lowest - shape.bottom - allowance_of(job, operation).bottom
        if missing > 1e-6:
            text = (
                f"the tool does not fit below z = {lowest:g} mm: {missing:.4g} mm remain uncut"
            )
            course.find(job.warning(text, shape.ref))
    x, y, _ = course.at
    course.rapid((x, y, job.security_z), MoveType.RETRACT)
    return course.finished()


def _warn_outside_stock(course: PathBuilder, job: ToolPathTask, shape: Area | Flank) -> None:
    """Warn that a feature lies wholly outside the stock, as by a placement applied twice."""
    if job.stock is None:
        return
    chains = (shape.chain,) if isinstance(shape, Flank) else [wall.loop for wall in shape.walls]
    faces = [shape.face] if isinstance(shape, Area) and shape.face is not None else []
    points = [edge.start for chain in (*chains, *faces) for edge in chain]
    for pick, axis in ((lambda at: at.real, 0), (lambda at: at.imag, 1)):
        low, high = min(map(pick, points)), max(map(pick, points))
        if low > job.stock.high[axis] or high < job.stock.low[axis]:
            text = (
                f"the feature lies outside the stock: {'xy'[axis]} from {low:g} to {high:g} mm"
            )
            course.find(job.warning(text, shape.ref))
            return


def allowance_of(job: ToolPathTask, operation: Entity) -> Allowance:
    """Allowances of an operation on walls and floor.

    Raises
    ------
    PathError
        If an allowance is negative or too large.
    """
    values = {}
    for name in ("allowance_side", "allowance_bottom"):
        value = getattr(operation, name, None) or 0.0
        if not 0.0 <= value < LARGEST:
            raise job.fault(
                f"{value:g} mm: an allowance must lie between 0 and {LARGEST:g} mm",
                job.step.operation_ref,
                name,
            )
        values[name] = float(value)
    return Allowance(side=values["allowance_side"], bottom=values["allowance_bottom"])


def levels(top: float, bottom: float, depth: float) -> list[float]:
    """Heights of equal levels down to the bottom, each at most a given depth apart, mm."""
    count = max(1, ceil((top - bottom) / depth - 1e-9))
    return [top + (bottom - top) * (index + 1) / count for index in range(count)]


def _layers(
    job: ToolPathTask, shape: Area | Flank, cutter: EndMillShape, way: ResolvedStrategy
) -> Iterator[Layer]:
    """Layers of passes of one shape, from the top down as far as the cutter fits."""
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
    """Heights of the levels of a shape, including the tops of low islands.

    Yields
    ------
    float
        z in the setup, mm, falling.
    """
    tops = shape.terraces if isinstance(shape, Area) else []
    stops = [top + allowance.bottom for top in tops if floor < top + allowance.bottom < start]
    if (start - floor) / depth > MOST_LEVELS:
        raise job.fault(
            f"{depth:g} mm needs more than {MOST_LEVELS} levels over {start - floor:g} mm",
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
    """Layer of passes at one level; None if the cutter does not fit."""
    operation = job.step.operation
    if isinstance(shape, Flank):
        finishes = isinstance(operation, (SideFinishMilling, BottomAndSideFinishMilling))
        return flank_layer(job, shape, level, way, is_single=finishes and earlier is not None)
    if isinstance(operation, SideMilling):
        if not shape.walls:
            raise job.fault("the feature has no walls for side milling", shape.ref)
        return wall_passes(shape, level, way)
    if isinstance(operation, BottomAndSideFinishMilling) and earlier is not None:
        has_floor_left = earlier.bottom > floor - shape.bottom
        if level.z > floor + 1e-9 or not has_floor_left:
            return wall_passes(shape, level, way)
    return clear(job, shape, level, way)


def _earlier(job: ToolPathTask) -> Allowance | None:
    """Allowances of the last earlier milling operation on the feature, or None."""
    kinds = (PlaneMilling, SideMilling, BottomAndSideMilling)
    for step in reversed(job.program.before(job.step)):
        if isinstance(step.operation, kinds):
            return allowance_of(job, step.operation)
    return None


def _span(
    job: ToolPathTask, shape: Area | Flank, allowance: Allowance, earlier: Allowance | None
) -> tuple[float, float]:
    """Start and end height of the material that the operation removes, mm."""
    floor = shape.bottom + allowance.bottom
    start = shape.top
    if isinstance(job.step.operation, PlaneFinishMilling) and earlier is not None:
        start = min(start, shape.bottom + earlier.bottom)
    if earlier is not None and abs(start - floor) <= 1e-9:
        # The earlier operation left nothing on the floor: one pass smooths it.
        return floor, floor
    if start - floor <= 1e-9:
        raise job.fault(
            f"an allowance of {allowance.bottom:g} mm on {start - shape.bottom:g} mm of stock: "
            "nothing is removed",
            job.step.operation_ref,
            "allowance_bottom",
        )
    return start, floor


def _axial_depth(job: ToolPathTask, total: float) -> float:
    """Depth of a level, mm: as programmed, or else the length of the cutting edge."""
    depth = getattr(job.step.operation, "axial_cutting_depth", None)
    if depth is None:
        return min(total, job.tool.cutting_edge_length or total) or 1.0
    if not 0.0 < depth < float("inf"):
        raise job.fault(
            f"{depth:g} mm: the depth of cut must be positive",
            job.step.operation_ref,
            "axial_cutting_depth",
        )
    return float(depth)


def _retract_z(job: ToolPathTask, course: PathBuilder, shape: Area | Flank) -> float:
    """Height z of the retract plane above a shape, mm."""
    distance = job.step.operation.retract_plane
    if distance is None:
        distance = DEFAULT_CLEARANCE
        text = f"no retract plane given: assuming {distance:g} mm above the feature"
        course.find(job.note(text, None, "retract_plane"))
    if distance < 0.0:
        raise job.fault(
            f"{distance:g} mm: the retract plane must lie above the feature",
            job.step.operation_ref,
            "retract_plane",
        )
    if job.security_z <= shape.top:
        raise job.fault(
            f"the security plane at z = {job.security_z:g} mm does not lie above the feature, "
            f"whose top is at z = {shape.top:g} mm",
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
    """Cut all passes of one level."""
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
    """Warn where an end mill plunges straight down into solid material."""
    if not isinstance(operation, (PlaneRoughMilling, BottomAndSideRoughMilling)):
        return
    strategy = job.program.get(operation.approach) if operation.approach is not None else None
    is_straight = strategy is None or isinstance(strategy, PlungeToolaxis)
    if is_straight and (
        not layer.solid or any(contains(layer.solid, [cut.start], tolerance=1e-3))
    ):
        text = "the tool plunges straight into the material: consider a ramp or helix"
        course.find(job.warning(text, attribute="approach"))


def _cut(course: PathBuilder, chain: Chain, layer: Layer) -> None:
    """Follow a pass through material and through air."""
    found = pieces(chain, layer.solid) if layer.solid else [ClippedChain(chain, is_inside=True)]
    for piece in found:
        type = MoveType.CONTACT if piece.is_inside else MoveType.NO_CONTACT
        trace(course, piece.chain, z=layer.z, end_z=layer.z, type=type)


def _travel_z(job: ToolPathTask, retract_z: float) -> float:
    """Height z of sideways travel, above the stock where that is higher, mm."""
    if job.stock is None or retract_z >= job.stock.high[2] + ABOVE_STOCK:
        return retract_z
    return max(job.security_z, job.stock.high[2] + ABOVE_STOCK)


def _is_linked(
    here: complex, following: MillingPass, layer: Layer, way: ResolvedStrategy
) -> bool:
    """True if the tool may go to the next pass at the feed without lifting."""
    distance = abs(following.start - here)
    if distance < TINY:
        return True
    if way.is_lifted or distance > LINK * way.step:
        return False
    if layer.loops:
        return is_inside(here, following.start, layer.loops)
    return layer.room.holds((line(here, following.start),))
