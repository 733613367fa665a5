"""Passes beside a wall, and those that make the bar of a tee slot, one level at a time.

Walls are those of outside profiles, bosses and steps. The neck of a tee slot is a slot like any
other and is milled first; nothing looks whether it was. Above the bar the T-slot mill cannot be
lifted, so every pass runs from outside the part to its other side.
"""

from collections.abc import Iterator
from math import ceil

import numpy as np

from stepnc_model.tool import body_of
from stepnc_model.toolpath.milling.area import Area, Flank, TeeSlotUndercut, extra
from stepnc_model.toolpath.milling.contour import (
    Chain,
    Loop,
    polygon,
    reversed_chain,
    rotated_to,
    stretched,
)
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.layer import CentreArea, CutLevel, Layer, nowhere
from stepnc_model.toolpath.milling.layer import beside as clearance
from stepnc_model.toolpath.milling.offset import ContourEdges, beside, distances, erode
from stepnc_model.toolpath.milling.strategy import EndMillShape, ResolvedStrategy, run_out
from stepnc_model.toolpath.milling.strokes import inside
from stepnc_model.toolpath.task import ToolPathTask

MOST_PASSES = 1000


def flank_layer(
    job: ToolPathTask, flank: Flank, level: CutLevel, way: ResolvedStrategy, *, is_single: bool
) -> Layer | None:
    """Passes at one level, from the outside in; None when the cutter cannot follow the wall.

    ``is_single``: only what an earlier operation left on the wall is taken off.
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
            # The last pass follows the whole wall; those before it only where there is stock.
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
    """The wall at a distance; a closed one starts in the middle of its longest line."""
    if flank.is_closed:
        return [
            MillingPass(rotated_to(loop, _start(loop)), is_closed=True)
            for loop in erode([flank.chain], distance)
        ]
    run = cutter.radius + run_out(job)
    longer = stretched(flank.chain, run, run)
    return [MillingPass(chain, is_closed=False) for chain in beside(longer, distance)]


def _start(loop: Loop) -> complex:
    """Middle of the longest line, or of the longest arc."""
    lines = [edge for edge in loop if edge.centre is None] or list(loop)
    return max(lines, key=lambda edge: edge.length).at(0.5)


def _count(job: ToolPathTask, flank: Flank, way: ResolvedStrategy, left: float) -> int:
    """Passes side by side that remove everything up to the side of the stock."""
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
            f"{count} passes of {way.step:g} mm beside its wall: {MOST_PASSES} are enough",
            flank.ref,
        )
    return count


def _stock(job: ToolPathTask) -> Loop | None:
    """The stock seen along z: a rectangle; a bar by the square about it."""
    if job.stock is None:
        return None
    (x0, y0, _), (x1, y1, _) = job.stock.low, job.stock.high
    return polygon([complex(x0, y0), complex(x1, y0), complex(x1, y1), complex(x0, y1)])


FITS = 1e-3
"""mm by which the mill may differ from the bar that it makes in one pass"""


def tee_layers(
    job: ToolPathTask, area: Area, bar: TeeSlotUndercut, cutter: EndMillShape
) -> Iterator[Layer]:
    """Passes that make the bar, from its top down.

    Raises
    ------
    PathError
        When the mill cannot come in, is wider or thicker than the bar, or leaves its middle.
    """
    if not bar.is_open:
        raise job.fault(
            "a T-slot mill comes and goes through open ends: both must be open", area.ref
        )
    thickness = _thickness(job, bar)
    if thickness > bar.depth + FITS:
        raise job.fault(
            f"a mill of {thickness:g} mm thickness in a bar of {bar.depth:g} mm", area.ref
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
    """The middle of the slot, or a way along either side of the bar."""
    aside = 0.5 * bar.width - cutter.radius
    if aside < -FITS or aside > cutter.radius:
        raise job.fault(
            f"'{job.tool.id}' of {job.tool.diameter:g} mm for a bar of {bar.width:g} mm: "
            "it may not be wider, nor narrower than half of it",
            area.ref,
        )
    way = stretched(area.middle or (), *area.ends)
    if aside <= FITS:
        return [way]
    left, right = beside(way, aside), beside(reversed_chain(way), aside)
    if len(left) != 1 or len(right) != 1:
        raise job.fault("its course turns too sharply for the mill", area.ref)
    return [left[0], right[0]]


def _thickness(job: ToolPathTask, bar: TeeSlotUndercut) -> float:
    """Thickness of the mill, mm; that of the bar where the file does not say."""
    thickness = getattr(body_of(job.program, job.step.tool_ref), "cutting_thickness", None)
    return float(thickness) if thickness and thickness > 0.0 else bar.depth
