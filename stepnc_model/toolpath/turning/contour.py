"""Contouring and facing: scan lines or passes along the contour, and the last pass on it.

Facing is contouring seen across the spindle axis. Roughing leaves the allowance; what scan
lines leave above it goes with a last pass along the surface. Finishing follows the whole
surface, in as many passes as the depth asks for.
"""

from stepnc_model.entities.turning import Contouring, ContouringFinish, Facing, FacingFinish
from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.approach import departure, entrance
from stepnc_model.toolpath.turning.link import direction_in
from stepnc_model.toolpath.turning.offset import thickness
from stepnc_model.toolpath.turning.outline import Outline
from stepnc_model.toolpath.turning.passes import oriented, scan, shortened, touching
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.profile import Profile
from stepnc_model.toolpath.turning.region import SEEN, Region, leftovers, region_of
from stepnc_model.toolpath.turning.setting import (
    MOST_PASSES,
    Setting,
    cumulative,
    setting_of,
)
from stepnc_model.toolpath.turning.stock import Bar, allowance_of, operation_of
from stepnc_model.toolpath.turning.walk import Walk

DEEP = 3.0
"""mm in one pass that a turner would not take unasked"""


def contour(
    job: Job, course: Course, bar: Bar, outlines: tuple[Outline, ...], plane: HalfPlane
) -> None:
    """Make the path of a contouring or facing operation.

    Raises
    ------
    PathError
        When there is nothing to remove, or the allowance is larger than the stock.
    """
    setting = setting_of(job, plane)
    allowance = allowance_of(job, job.step.operation_ref, job.step.operation)
    nose = job.tool.corner_radius or 0.0
    region = region_of(
        job, bar, outlines, plane=plane, allowance=allowance, overcut=setting.overcut
    )
    for finding in (*setting.link.findings, *leftovers(job, region, outlines)):
        course.find(finding)
    walk = Walk(course, plane, region.stock, nose=nose, feeds=setting.feeds)
    # Right at the end stands what is no feature: it is not to be taken off.
    own = region.surface.within(region.low + SEEN, max(region.low + SEEN, region.own_high))
    deep = thickness(region.stock, own) if own.pieces else 0.0
    _check_stock(job, region, deep, allowance)
    _find_one_pass(job, course, setting, deep - allowance)
    if isinstance(job.step.operation, (ContouringFinish, FacingFinish)):
        _finish(job, walk, region, setting, allowance=allowance, total=deep - allowance)
    elif setting.is_along_contour:
        _along(job, walk, region, setting, allowance=allowance, total=deep - allowance)
    else:
        _scanned(job, walk, region, setting, allowance)
    departure(job, walk, setting.link)
    walk.home()


def plane_of(job: Job, tip: tuple[float, float]) -> HalfPlane:
    """Facing looks across the axis, contouring along it, unless the feed direction says so."""
    is_across = isinstance(job.step.operation, Facing)
    reference = operation_of(job).its_machining_strategy
    if reference is not None:
        along = direction_in(
            job, HalfPlane(), getattr(job.program.get(reference), "feed_direction", None)
        )
        if along is not None and isinstance(job.step.operation, Contouring):
            is_across = abs(along[1]) > abs(along[0])
    return HalfPlane(is_across=is_across, tip_x=tip[0], tip_z=tip[1])


def _check_stock(job: Job, region: Region, deep: float, allowance: float) -> None:
    """There must be something to take off; a finish may follow what is at its size."""
    is_finish = isinstance(job.step.operation, (ContouringFinish, FacingFinish))
    if deep <= SEEN and not is_finish:
        raise job.fault(
            "there is nothing to remove: the stock lies on the feature", job.step.ref
        )
    if allowance >= deep > SEEN:
        message = f"an allowance of {allowance:g} mm where {deep:.4g} mm of stock stand"
        raise job.fault(message, job.step.operation_ref, "allowance")


def _find_one_pass(job: Job, course: Course, setting: Setting, total: float) -> None:
    """Say so where all is taken at once because nothing tells a depth."""
    if setting.depths or setting.is_one_pass or total <= SEEN:
        return
    text = f"no cutting depth is given: {total:.3g} mm in one pass"
    find = job.warning if total >= DEEP else job.note
    course.find(find(text, operation_of(job).its_machining_strategy, "cutting_depth"))


def _scanned(job: Job, walk: Walk, region: Region, setting: Setting, allowance: float) -> None:
    """Scan lines from the outside in, then once along the surface."""
    centres = region.centres(allowance)
    bottom = max(
        centres.bottom(region.low, region.front), region.floor + region.nose + allowance
    )
    top = _top(region, centres)
    sums = cumulative(top - bottom + region.nose, setting.depths)
    if len(sums) > MOST_PASSES:
        raise job.fault(f"more than {MOST_PASSES} passes", job.step.operation_ref)
    for index, depth in enumerate(sums):
        is_back = setting.is_reversed != (setting.is_to_and_fro and index % 2 == 1)
        level = top + region.nose - depth
        scan(walk, centres, level, setting, towards=1 if is_back else -1)
    _follow(job, walk, region, setting, allowance)


def _top(region: Region, centres: Profile) -> float:
    """Greatest v of the stock over the region."""
    return region.stock.top(centres.low, centres.high)


def _along(
    job: Job, walk: Walk, region: Region, setting: Setting, *, allowance: float, total: float
) -> None:
    """Passes along the contour, each nearer to it."""
    for depth in cumulative(total, setting.depths):
        _follow(job, walk, region, setting, allowance + total - depth)


def _finish(
    job: Job, walk: Walk, region: Region, setting: Setting, *, allowance: float, total: float
) -> None:
    """Passes along the contour; the last one touches all of it."""
    for depth in cumulative(total, setting.depths)[:-1]:
        _follow(job, walk, region, setting, allowance + total - depth)
    chain = region.chain(allowance)
    touched = touching(walk, oriented(chain, towards=-1), setting.overcut)
    start = max(
        (piece.high for piece in touched),
        default=region.own_high + region.nose + setting.overcut,
    )
    start = max(start, region.own_high + region.nose + allowance)
    towards = 1 if setting.is_reversed else -1
    pieces = oriented(shortened(chain, start), towards=towards)
    entrance(job, walk, pieces, setting.link)
    walk.feed(pieces)


def _follow(job: Job, walk: Walk, region: Region, setting: Setting, allowance: float) -> None:
    """Once along the surface where something stands on it."""
    towards = 1 if setting.is_reversed else -1
    pieces = touching(walk, oriented(region.chain(allowance), towards=towards), setting.overcut)
    if pieces:
        entrance(job, walk, pieces, setting.link)
        walk.feed(pieces)
