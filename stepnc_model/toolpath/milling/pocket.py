"""Pockets, closed and open, and the bosses that stand in them (ISO 14649-10)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from stepnc_model.entities.bottoms import (
    GeneralPocketBottomCondition,
    RadiusedPocketBottomCondition,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import Boss, ClosedPocket, OpenPocket, Pocket
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.frame import Frame, frame_of, point_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Area, Wall, chord, leaning
from stepnc_model.toolpath.milling.contour import (
    Chain,
    Loop,
    circle,
    clockwise,
    counter_clockwise,
    line,
    shape,
)
from stepnc_model.toolpath.milling.cutter import run_out
from stepnc_model.toolpath.milling.offset import rounded
from stepnc_model.toolpath.milling.outline import (
    closed_outline,
    given,
    open_outline,
    require_simple,
    size,
    slope_of,
)

CHORD = 1e-3
"""mm of tolerance where an outline is looked at as a polygon"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Island:
    """Boss that reaches above the floor, and its wall."""

    ref: Ref[Boss]
    wall: Wall


def closed_pocket(
    job: Job, ref: Ref[Entity], feature: ClosedPocket, frame: Frame, bottom: float
) -> Area:
    """Area of a pocket with walls all around.

    Raises
    ------
    PathError
        When its boundary crosses itself, or an island touches it.
    """
    outline = closed_outline(job, feature.feature_boundary, frame)
    require_simple(job, outline, ref)
    area, found = _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
    _require_apart(job, area.walls[0].loop, found)
    return area


def open_pocket(
    job: Job, ref: Ref[Entity], feature: OpenPocket, frame: Frame, bottom: float
) -> Area:
    """Area of a pocket that the tool runs out of.

    Raises
    ------
    PathError
        When its boundary closes, or crosses itself.
    """
    chain = open_outline(job, feature.open_boundary, frame)
    if abs(chain[0].start - chain[-1].end) < 1e-6:
        raise job.fault("its boundary closes: an open pocket has an opening", ref)
    solid = counter_clockwise((*chain, line(chain[-1].end, chain[0].start)))
    require_simple(job, solid, ref)
    box = _box(job, chain)
    outline = counter_clockwise((*chain, *box))
    require_simple(job, outline, ref)
    area, _ = _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
    return replace(area, solid=solid, outside=(box[1],))


def islands(
    job: Job, owner: Ref[Entity], bosses: tuple[Ref[Boss], ...], frame: Frame, bottom: float
) -> Iterator[Island]:
    """Bosses that reach above the floor; they are placed beside the feature, not within it."""
    # In a pattern or a compound feature the bosses move along with their feature.
    placement = getattr(job.program.get(owner), "feature_placement", None)
    beside = frame.inner(frame_of(job.program, placement).inverse())
    for ref in bosses or ():
        boss = job.program.get(ref)
        within = beside.inner(frame_of(job.program, boss.feature_placement))
        top = within.origin[2]
        if top <= bottom:
            continue
        loop = clockwise(closed_outline(job, boss.its_boundary, within))
        slope = slope_of(job, boss.slope, ref)
        inset = leaning(depth=top - bottom, slope_deg=slope)
        yield Island(ref=ref, wall=Wall(loop=loop, inset=inset, top=top))


def _pocket(
    job: Job,
    ref: Ref[Entity],
    feature: Pocket,
    frame: Frame,
    *,
    bottom: float,
    outline: Loop,
) -> tuple[Area, list[Island]]:
    """Boundary with rounded corners, islands, and the edge along the floor."""
    top = frame.origin[2]
    fillet = given(job, feature.planar_radius)
    slope = slope_of(job, feature.slope, ref)
    inset = leaning(depth=top - bottom, slope_deg=slope, fillet=fillet)
    loops = _with_corners(job, ref, feature.orthogonal_radius, outline)
    found = list(islands(job, ref, feature.its_boss, frame, bottom))
    walls = [*(Wall(loop=loop, inset=inset) for loop in loops), *(one.wall for one in found)]
    condition = job.program.get(feature.bottom_condition) if feature.bottom_condition else None
    if isinstance(condition, GeneralPocketBottomCondition):
        raise job.fault("a floor of any shape cannot be milled yet", ref, "bottom_condition")
    if isinstance(condition, RadiusedPocketBottomCondition):
        walls.append(_dish(job, condition, frame, bottom))
    return Area(ref=ref, walls=tuple(walls), top=top, bottom=bottom), found


def _with_corners(
    job: Job,
    ref: Ref[Entity],
    radius_ref: Ref[TolerancedLengthMeasure] | None,
    outline: Loop,
) -> tuple[Loop, ...]:
    """The outline with its sharp corners rounded as the feature asks."""
    radius = given(job, radius_ref)
    if radius <= 0.0:
        return (outline,)
    loops = rounded(outline, radius)
    if len(loops) != 1:
        raise job.fault(
            f"corners of {radius:g} mm do not fit in its boundary", ref, "orthogonal_radius"
        )
    return loops


def _dish(
    job: Job, condition: RadiusedPocketBottomCondition, frame: Frame, bottom: float
) -> Wall:
    """Floor that is part of a sphere, its lowest point on the depth plane at least."""
    x, y, z = frame.point(point_of(job.program, condition.floor_radius_center))
    radius = size(job, condition.floor_radius, condition.floor_radius_center)
    raised = max(z - radius - bottom, 0.0)
    return Wall(
        loop=circle(complex(x, y), radius),
        inset=lambda height: radius - chord(radius, height - raised),
    )


def _box(job: Job, chain: Chain) -> Chain:
    """From the end of an open pocket's wall to its start, by a box in front of the opening."""
    start, end = chain[0].start, chain[-1].end
    opening = start - end
    reach = job.tool.diameter + run_out(job)
    middle = shape((*chain, line(end, start)), tolerance=CHORD).representative_point()
    outward = 1j * opening / abs(opening)
    inside = complex(middle.x, middle.y) - 0.5 * (start + end)
    if (outward.conjugate() * inside).real > 0.0:
        outward = -outward
    before, after = start + reach * outward, end + reach * outward
    return (line(end, after), line(after, before), line(before, start))


def _require_apart(job: Job, outline: Loop, found: list[Island]) -> None:
    """Refuse an island that touches the wall of its pocket."""
    outer = shape(outline, tolerance=CHORD)
    for island in found:
        solid = shape(island.wall.loop, tolerance=CHORD)
        if outer.exterior.distance(solid) <= CHORD or not outer.covers(solid):
            raise job.fault("touches the wall of its pocket", island.ref, "its_boundary")
