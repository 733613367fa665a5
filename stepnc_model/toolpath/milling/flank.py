"""Milling passes along a wall, and passes that undercut a tee slot, level by level.

Walls are those of outside profiles, bosses and steps. The neck of a tee slot is an ordinary
slot and has to be milled first; this is not checked. Above the undercut the T-slot mill cannot
be lifted, so every pass runs from outside the part to its other side.
"""

from collections.abc import Iterator
from math import ceil

import numpy as np

from stepnc_model.programs.tool import body_of
from stepnc_model.toolpath.milling.contour import (
    Chain,
    Loop,
    polygon,
    reversed_chain,
    rotated_to,
    stretched,
)
from stepnc_model.toolpath.milling.cover import Area, Flank, MillingPass, TeeSlotUndercut, extra
from stepnc_model.toolpath.milling.layer import CentreArea, CutLevel, Layer, nowhere
from stepnc_model.toolpath.milling.layer import clearance_from_wall as clearance
from stepnc_model.toolpath.milling.offset import ContourEdges, distances, erode, offset_left
from stepnc_model.toolpath.milling.strategy import EndMillShape, ResolvedStrategy, run_out
from stepnc_model.toolpath.milling.strokes import inside
from stepnc_model.toolpath.task import ToolPathTask

MOST_PASSES = 1000


def flank_layer(
    job: ToolPathTask, flank: Flank, level: CutLevel, way: ResolvedStrategy, *, is_single: bool
) -> Layer | None:
    """Passes along a wall at one level, from the outside in; None if the cutter does not fit.

    ``is_single``: remove only what an earlier operation left on the wall.
    """
    cutter = level.cutter
    lean = extra(flank.inset, cutter, bottom=level.z - flank.bottom, top=flank.depth)
    near = level.distance + lean
    count = 1 if is_single else _count(job, flank, way, level.allowance + lean)
    stock = _stock(job)
    near_stock = level.touching(stock)
    passes: list[MillingPass] = []
    for index in reversed(range(count)):
        for cut in _at(job, flank, cutter, near + index * way.step):
            # The last pass follows the whole wall; earlier passes only where there is stock.
            passes += [cut] if index == 0 or not near_stock else inside(cut, near_stock)
    if not passes:
        return None
    if not way.has_wall_on_right:
        passes = [MillingPass(reversed_chain(cut.chain), cut.is_closed) for cut in passes]
    return Layer(
        z=level.z,
        above=level.above,
        passes=tuple(passes),
        solid=near_stock,
        room=CentreArea(
            clearance=clearance(flank.chain, near),
            side=1j if way.has_wall_on_right else -1j,
        ),
    )


def _at(
    job: ToolPathTask, flank: Flank, cutter: EndMillShape, distance: float
) -> list[MillingPass]:
    """Passes at a distance from the wall; closed ones start in the longest straight edge."""
    if flank.is_closed:
        return [
            MillingPass(rotated_to(loop, _start(loop)), is_closed=True)
            for loop in erode([flank.chain], distance)
        ]
    run = cutter.radius + run_out(job)
    longer = stretched(flank.chain, run, run)
    return [MillingPass(chain, is_closed=False) for chain in offset_left(longer, distance)]


def _start(loop: Loop) -> complex:
    """Start point on a closed wall: middle of its longest line, else of its longest arc."""
    lines = [edge for edge in loop if edge.centre is None] or list(loop)
    return max(lines, key=lambda edge: edge.length).at(0.5)


def _count(job: ToolPathTask, flank: Flank, way: ResolvedStrategy, left: float) -> int:
    """Number of parallel passes that remove all material up to the side of the stock."""
    width = flank.width
    if width is None:
        stock = _stock(job)
        if stock is None:
            return 1
        corners = np.array([edge.start for edge in stock], dtype=complex)
        width = float(distances(corners, ContourEdges.of(flank.chain)).max())
    count = max(1, ceil((width - left) / way.step - 1e-6))
    if count > MOST_PASSES:
        raise job.fault(
            f"{count} passes of {way.step:g} mm along the wall: at most {MOST_PASSES} allowed",
            flank.ref,
        )
    return count


def _stock(job: ToolPathTask) -> Loop | None:
    """Stock seen along z as a rectangle; a round bar as its bounding square."""
    if job.stock is None:
        return None
    (x0, y0, _), (x1, y1, _) = job.stock.low, job.stock.high
    return polygon([complex(x0, y0), complex(x1, y0), complex(x1, y1), complex(x0, y1)])


FITS = 1e-3
"""Tolerance between the mill and the undercut that it cuts in one pass, mm."""


def tee_layers(
    job: ToolPathTask, area: Area, bar: TeeSlotUndercut, cutter: EndMillShape
) -> Iterator[Layer]:
    """Layers of passes that cut the undercut of a tee slot, from its top down.

    Raises
    ------
    PathError
        If the slot is not open at both ends, or the mill does not suit the undercut.
    """
    if not bar.is_open:
        raise job.fault(
            "a T-slot mill enters and leaves through the slot ends: both must be open", area.ref
        )
    thickness = _thickness(job, bar)
    if thickness > bar.depth + FITS:
        raise job.fault(
            f"a mill {thickness:g} mm thick does not fit an undercut of {bar.depth:g} mm",
            area.ref,
        )
    start = area.bottom + bar.depth - thickness
    count = ceil((start - area.bottom) / thickness - FITS)
    passes = tuple(
        MillingPass(chain, is_closed=False) for chain in _chains(job, area, bar, cutter)
    )
    for index in range(max(0, count) + 1):
        z = area.bottom + (start - area.bottom) * (1.0 - index / max(1, count))
        level = CutLevel(z=z, above=area.top, cutter=cutter, allowance=0.0)
        yield Layer(
            z=z,
            above=area.top,
            passes=passes,
            room=CentreArea(clearance=nowhere),
            solid=level.touching(area.solid),
            is_from_outside=True,
        )


def _chains(
    job: ToolPathTask, area: Area, bar: TeeSlotUndercut, cutter: EndMillShape
) -> list[Chain]:
    """Centre line of the slot, or a path along each side of the undercut."""
    aside = 0.5 * bar.width - cutter.radius
    if aside < -FITS or aside > cutter.radius:
        raise job.fault(
            f"'{job.tool.id}' of {job.tool.diameter:g} mm for an undercut of {bar.width:g} mm: "
            "the mill must be between half and all of the undercut's width",
            area.ref,
        )
    way = stretched(area.middle or (), *area.ends)
    if aside <= FITS:
        return [way]
    left, right = offset_left(way, aside), offset_left(reversed_chain(way), aside)
    if len(left) != 1 or len(right) != 1:
        raise job.fault("the slot's course turns too sharply for the mill", area.ref)
    return [left[0], right[0]]


def _thickness(job: ToolPathTask, bar: TeeSlotUndercut) -> float:
    """Thickness of the T-slot mill, mm; the undercut depth where the file does not say."""
    thickness = getattr(body_of(job.program, job.step.tool_ref), "cutting_thickness", None)
    return float(thickness) if thickness and thickness > 0.0 else bar.depth
