"""The bar of a tee slot: passes of a T-slot mill, which comes in through an open end.

The neck is a slot like any other and is milled first; nothing looks whether it was. Above the
bar the mill cannot be lifted, so every pass runs from outside the part to its other side.
"""

from collections.abc import Iterator
from math import ceil

from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Area, Bar
from stepnc_model.toolpath.milling.contour import Chain, reversed_chain, stretched
from stepnc_model.toolpath.milling.cover import Pass
from stepnc_model.toolpath.milling.cutter import Cutter
from stepnc_model.toolpath.milling.layer import Layer, Level
from stepnc_model.toolpath.milling.offset import beside
from stepnc_model.toolpath.milling.room import Room, nowhere

FITS = 1e-3
"""mm by which the mill may differ from the bar that it makes in one pass"""


def tee_layers(job: Job, area: Area, bar: Bar, cutter: Cutter) -> Iterator[Layer]:
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
    passes = tuple(Pass(chain, is_closed=False) for chain in _chains(job, area, bar, cutter))
    for index in range(max(0, count) + 1):
        z = area.bottom + (start - area.bottom) * (1.0 - index / max(1, count))
        level = Level(z=z, above=area.top, cutter=cutter, allowance=0.0)
        yield Layer(
            z=z,
            above=area.top,
            passes=passes,
            room=Room(clearance=nowhere),
            solid=level.touching(area.solid),
            is_from_outside=True,
        )


def _chains(job: Job, area: Area, bar: Bar, cutter: Cutter) -> list[Chain]:
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


def _thickness(job: Job, bar: Bar) -> float:
    """Thickness of the mill, mm; that of the bar where the file does not say."""
    tool = job.program.get(job.step.tool_ref)
    body = job.program.get(tool.its_tool_body) if isinstance(tool, MillingCuttingTool) else None
    thickness = getattr(body, "cutting_thickness", None)
    return float(thickness) if thickness and thickness > 0.0 else bar.depth
