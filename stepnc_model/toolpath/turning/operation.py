"""Tool path of a turning workingstep from its features, tool and strategy.

Procedure and types of moves after Shin et al., "Developing a virtual machining model to
generate MTConnect machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54 (2016)
4487-4505, section 3.2.2: removal volume, offset by the nose, scan lines, net cuts, approach
and retract, links. The programmed point is the imaginary tool tip: see
:mod:`stepnc_model.toolpath.turning.profile`.

In knurling the wheel is pressed in at the front and fed along once. Contouring and facing
follow scan lines or passes along the contour, with the last pass on the contour. Facing is
contouring seen across the spindle axis. Roughing leaves the allowance; a last pass along the
surface removes what scan lines leave above it. Finishing follows the whole surface, in as many
passes as the depth requires.
"""

from stepnc_model.entities.turning import (
    Contouring,
    ContouringFinish,
    Facing,
    FacingFinish,
    Grooving,
    Knurl,
    Knurling,
    Threading,
)
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.programs.outline import size_or_zero
from stepnc_model.toolpath.path import MoveType, Point, ToolPath
from stepnc_model.toolpath.task import DEFAULT_CLEARANCE, PathBuilder, ToolPathTask
from stepnc_model.toolpath.turning.groove import groove
from stepnc_model.toolpath.turning.offset import thickness
from stepnc_model.toolpath.turning.outline import FeatureOutline, outline_of
from stepnc_model.toolpath.turning.passes import (
    departure,
    entrance,
    oriented,
    scan,
    shortened,
    touching,
)
from stepnc_model.toolpath.turning.path_builder import TurningPathBuilder
from stepnc_model.toolpath.turning.profile import HalfPlane, RadiusProfile, tip_of
from stepnc_model.toolpath.turning.region import (
    SEEN,
    TurningBlank,
    TurningRegion,
    bar_of,
    leftovers,
    region_of,
)
from stepnc_model.toolpath.turning.setting import (
    MOST_PASSES,
    TurningSetting,
    allowance_of,
    clearance_of,
    cumulative,
    direction_in,
    operation_of,
    setting_of,
    strategy_of,
)
from stepnc_model.toolpath.turning.thread import thread, threaded_feature

DEEP = 3.0
"""Depth of a single pass, mm, from which an unasked single pass is a warning."""


def contour(
    job: ToolPathTask,
    course: PathBuilder,
    bar: TurningBlank,
    outlines: tuple[FeatureOutline, ...],
    plane: HalfPlane,
) -> None:
    """Generate the path of a contouring or facing operation.

    Raises
    ------
    PathError
        If there is nothing to remove, or the allowance is larger than the stock.
    """
    setting = setting_of(job, plane)
    allowance = allowance_of(job, job.step.operation_ref, job.step.operation)
    nose = job.tool.corner_radius or 0.0
    region = region_of(
        job, bar, outlines, plane=plane, allowance=allowance, overcut=setting.overcut
    )
    for finding in (*setting.link.findings, *leftovers(job, region, outlines)):
        course.find(finding)
    walk = TurningPathBuilder(course, plane, region.stock, nose=nose, feeds=setting.feeds)
    # At the very end stands material that belongs to no feature: do not remove it.
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


def plane_of(job: ToolPathTask, tip: tuple[float, float]) -> HalfPlane:
    """Half plane of the passes: across the axis for facing, else along it or as fed."""
    is_across = isinstance(job.step.operation, Facing)
    feed = getattr(strategy_of(job), "feed_direction", None)
    along = direction_in(job, HalfPlane(), feed)
    if along is not None and isinstance(job.step.operation, Contouring):
        is_across = abs(along[1]) > abs(along[0])
    return HalfPlane(is_across=is_across, tip_x=tip[0], tip_z=tip[1])


def _check_stock(
    job: ToolPathTask, region: TurningRegion, deep: float, allowance: float
) -> None:
    """Check that there is stock to remove; a finish may follow a surface already at size."""
    is_finish = isinstance(job.step.operation, (ContouringFinish, FacingFinish))
    if deep <= SEEN and not is_finish:
        raise job.fault(
            "nothing to remove: the stock is already at the size of the feature", job.step.ref
        )
    if allowance >= deep > SEEN:
        message = f"the allowance of {allowance:g} mm exceeds the {deep:.4g} mm of stock"
        raise job.fault(message, job.step.operation_ref, "allowance")


def _find_one_pass(
    job: ToolPathTask, course: PathBuilder, setting: TurningSetting, total: float
) -> None:
    """Report a single pass that is taken because no cutting depth is given."""
    if setting.depths or setting.is_one_pass or total <= SEEN:
        return
    text = f"no cutting depth given: {total:.3g} mm are cut in one pass"
    find = job.warning if total >= DEEP else job.note
    course.find(find(text, operation_of(job).its_machining_strategy, "cutting_depth"))


def _scanned(
    job: ToolPathTask,
    walk: TurningPathBuilder,
    region: TurningRegion,
    setting: TurningSetting,
    allowance: float,
) -> None:
    """Cut scan lines from the outside in, then follow the surface once."""
    centres = region.centres(allowance)
    bottom = max(
        centres.bottom(region.low, region.front), region.floor + region.nose + allowance
    )
    top = _top(region, centres)
    sums = cumulative(top - bottom + region.nose, setting.depths)
    if len(sums) > MOST_PASSES:
        raise job.fault(
            f"the cutting depth needs more than {MOST_PASSES} passes: increase it",
            job.step.operation_ref,
        )
    for index, depth in enumerate(sums):
        is_back = setting.is_reversed != (setting.is_to_and_fro and index % 2 == 1)
        level = top + region.nose - depth
        scan(walk, centres, level, setting, towards=1 if is_back else -1)
    _follow(job, walk, region, setting, allowance)


def _top(region: TurningRegion, centres: RadiusProfile) -> float:
    """Greatest height v of the stock over the region to be turned, mm."""
    return region.stock.top(centres.low, centres.high)


def _along(
    job: ToolPathTask,
    walk: TurningPathBuilder,
    region: TurningRegion,
    setting: TurningSetting,
    *,
    allowance: float,
    total: float,
) -> None:
    """Make passes along the contour, each closer to it."""
    for depth in cumulative(total, setting.depths):
        _follow(job, walk, region, setting, allowance + total - depth)


def _finish(
    job: ToolPathTask,
    walk: TurningPathBuilder,
    region: TurningRegion,
    setting: TurningSetting,
    *,
    allowance: float,
    total: float,
) -> None:
    """Make passes along the contour; the last pass covers all of it."""
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


def _follow(
    job: ToolPathTask,
    walk: TurningPathBuilder,
    region: TurningRegion,
    setting: TurningSetting,
    allowance: float,
) -> None:
    """Make one pass along the surface where stock stands on it."""
    towards = 1 if setting.is_reversed else -1
    pieces = touching(walk, oriented(region.chain(allowance), towards=towards), setting.overcut)
    if pieces:
        entrance(job, walk, pieces, setting.link)
        walk.feed(pieces)


EVEN = 1e-6
"""Greatest difference of radii between the ends of a cylinder, mm."""


def knurl(
    job: ToolPathTask, course: PathBuilder, bar: TurningBlank, outline: FeatureOutline
) -> None:
    """Generate the path of a knurling operation: press in and feed along the feature.

    Raises
    ------
    PathError
        If the feature is not a knurl, has no tooth depth or is not a cylinder.
    """
    ref = job.step.features[0]
    feature = job.program.get(ref)
    if not isinstance(feature, Knurl) or feature.tooth_depth is None:
        raise job.fault("knurling needs a knurl feature with a tooth depth", ref, "tooth_depth")
    depth = size_or_zero(job.program, feature.tooth_depth)
    least, radius = outline.radii
    if radius - least > EVEN:
        raise job.fault("only a cylinder can be knurled", ref, "base_feature")
    clearance = clearance_of(job)
    outside = max(radius, bar.left.top(outline.low, bar.left.high)) + clearance
    start = course.at
    course.rapid((outside, 0.0, start[2]), MoveType.APPROACH)
    course.rapid((outside, 0.0, outline.high), MoveType.APPROACH)
    course.line((radius, 0.0, outline.high), MoveType.NO_CONTACT)
    course.line((radius - depth, 0.0, outline.high), MoveType.CONTACT)
    course.line((radius - depth, 0.0, outline.low), MoveType.CONTACT)
    course.line((radius, 0.0, outline.low), MoveType.NO_CONTACT)
    course.rapid((start[0], 0.0, outline.low), MoveType.RETRACT)
    course.rapid(start, MoveType.RETRACT)


def turning_path(job: ToolPathTask) -> ToolPath:
    """Tool path of a turning workingstep.

    Returns
    -------
    ToolPath
        Positions of the imaginary tool tip in the coordinates of the setup: x is the radius.

    Raises
    ------
    PathError, SchemaError
        When feature, tool, stock or strategy allow no path.
    """
    operation = operation_of(job)
    with job.program.using(job.step.operation_ref, *job.step.features):
        outlines = outlines_of(job)
        bar = bar_of(job, outlines)
        course = PathBuilder(job, _safe_point(job, bar), is_turning=True)
        for finding in bar.findings:
            course.find(finding)
        if operation.retract_plane is None:
            text = f"no retract plane given: assuming {DEFAULT_CLEARANCE:g} mm off the stock"
            course.find(job.note(text, attribute="retract_plane"))
        _make(job, course, bar, outlines)
    return course.finished()


def _make(
    job: ToolPathTask,
    course: PathBuilder,
    bar: TurningBlank,
    outlines: tuple[FeatureOutline, ...],
) -> None:
    """Generate the tool path by the kind of turning operation."""
    operation = job.step.operation
    if isinstance(operation, (Contouring, Facing)):
        tool = job.program.get(job.step.tool_ref)
        if not isinstance(tool, TurningMachineCuttingTool):
            raise job.fault("is not a turning tool", job.step.tool_ref)
        if job.tool.corner_radius is None:
            text = "no nose radius given: assuming a sharp tool"
            course.find(job.note(text, job.step.tool_ref, "cutting_edge"))
        tip = tip_of(tool.hand_of_tool, job.tool.corner_radius or 0.0)
        contour(job, course, bar, outlines, plane_of(job, tip))
    elif isinstance(operation, Grooving):
        groove(job, course, bar, outlines)
    elif isinstance(operation, Threading):
        thread(job, course, bar, outlines[0])
    elif isinstance(operation, Knurling):
        knurl(job, course, bar, outlines[0])
    else:
        raise job.fault(
            "path generation does not support this kind of turning operation",
            job.step.operation_ref,
        )


def outlines_of(job: ToolPathTask) -> tuple[FeatureOutline, ...]:
    """Outlines of the features of a workingstep within the bar, ordered from the front.

    Raises
    ------
    PathError, SchemaError
        If there is none, or one cannot be turned.
    """
    if not job.step.features:
        raise job.fault("the workingstep has no feature to turn", job.step.ref, "its_features")
    reach = _reach(job)
    found = tuple(
        outline_of(job, threaded_feature(job, ref), reach) for ref in job.step.features
    )
    if job.stock is not None:
        for outline in found:
            _check_bar(job, outline)
    return tuple(sorted(found, key=lambda outline: -outline.high))


def _reach(job: ToolPathTask) -> float:
    """Radius of the bar, mm, or 0 where no stock is given."""
    if job.stock is None:
        return 0.0
    return job.stock.radius or max(map(abs, (*job.stock.low[:2], *job.stock.high[:2])))


def _check_bar(job: ToolPathTask, outline: FeatureOutline) -> None:
    """Check that a feature lies within the bar in z and in radius."""
    stock = job.stock
    if stock is None:
        return
    if outline.low < stock.low[2] or outline.low > stock.high[2]:
        message = (
            f"the feature reaches to z = {outline.low:g} mm; "
            f"the bar extends from {stock.low[2]:g} to {stock.high[2]:g} mm"
        )
        raise job.fault(message, outline.ref)
    least = outline.radii[0]
    if least > _reach(job):
        message = (
            f"the feature's radius of {least:g} mm exceeds the bar radius of {_reach(job):g} mm"
        )
        raise job.fault(message, outline.ref)
    if least < 0.0:
        raise job.fault(
            f"the feature's radius of {least:g} mm must not be negative", outline.ref
        )


def _safe_point(job: ToolPathTask, bar: TurningBlank) -> Point:
    """Safe point outside the bar and in front of it."""
    clearance = clearance_of(job)
    front = bar.raw.high + clearance
    return bar.radius + clearance, 0.0, max(job.security_z, front)
