"""Threading: passes of a profiled insert, synchronised with the spindle angle.

The programmed point is the tip of the thread profile, in the middle of the insert. A
right-hand thread is cut towards the chuck, a left-hand thread away from it. Flank infeed shifts
each pass so that the last pass lies at the final thread position.

Moves that meet the stock are contact moves; run-in, run-out and other moves in air are not.
All parts of a run have the same feed, so that a control makes one block of them.

References
----------
.. [1] ISO 68-1:1998, ISO 965-1:2013: basic profile of metric threads. An external thread
   with a root rounded by H/6 is 17/24 · H = 0.61343 · P deep, H = √3/2 · P.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, copysign, sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    ThreadCutDepthType,
    ThreadHandType,
    ThreadingDirectionType,
    ThreadType,
)
from stepnc_model.entities.features import DefinedThread, Thread
from stepnc_model.entities.turning import ThreadingFinish, ThreadStrategy, TurningTechnology
from stepnc_model.entities.turning_tools import TurningThreadingTool
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.path import Feed, Move, MoveType
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask
from stepnc_model.toolpath.turning.outline import FeatureOutline
from stepnc_model.toolpath.turning.path_builder import RAPID_CLEARANCE, split
from stepnc_model.toolpath.turning.profile import ProfilePiece, RadiusProfile, Spot
from stepnc_model.toolpath.turning.region import TurningBlank
from stepnc_model.toolpath.turning.setting import (
    MOST_PASSES,
    allowance_of,
    cumulative,
    depths_of,
    strategy_of,
)
from stepnc_model.units import rad_from_deg

MOST_RETURN = 0.5
"""Greatest fraction of a pass that may be used for the angled pull-out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadPass:
    """Geometry of one threading pass, mm."""

    start: float
    """Position z where the run-in starts, mm."""
    end: float
    bottom: float
    """Radius at which the insert tip cuts in this pass, mm."""
    clear: float
    """Radius at which the tool returns, mm."""
    angle: float | None
    """Pull-out angle from the axis, degrees; None for straight out."""
    has_relief: bool
    """Whether the tool leaves where no material stands."""


def cut_thread(
    job: ToolPathTask,
    course: PathBuilder,
    one: ThreadPass,
    *,
    stock: RadiusProfile,
    pitch: float,
    kind: MoveType,
) -> None:
    """Generate the moves of one threading pass.

    Parameters
    ----------
    stock : RadiusProfile
        Radius over z before the thread.
    pitch : float, mm
    kind : MoveType
        Type of the rapid move to the pass.
    """
    bound = Feed(technology=job.step.technology_ref, per_revolution=pitch, is_synchronised=True)
    course.rapid((one.clear, 0.0, one.start), kind)
    _feed(course, stock, (one.start, one.bottom), job.feed)
    if one.angle is not None and 0.0 < one.angle < 90.0:
        out = (one.clear - one.bottom) / tan(rad_from_deg(one.angle))
        part = min(out / abs(one.end - one.start), MOST_RETURN)
        turning = one.end + part * (one.start - one.end)
        _feed(course, stock, (turning, one.bottom), bound)
        _feed(course, stock, (one.end, one.clear), bound)
        return
    _feed(course, stock, (one.end, one.bottom), bound)
    if one.has_relief:
        course.rapid((one.clear, 0.0, one.end))
    else:
        _feed(course, stock, (one.end, one.clear), job.feed)


def _feed(course: PathBuilder, stock: RadiusProfile, end: Spot, feed: Feed) -> None:
    """Feed straight to z and radius, split where the tip enters or leaves the stock."""
    line = ProfilePiece(start=(course.at[2], course.at[0]), end=end)
    for part, is_contact in split(line, stock):
        kind = MoveType.CONTACT if is_contact else MoveType.NO_CONTACT
        z, x = part.end
        course.add(Move(end=(x, 0.0, z), type=kind, feed=feed))


EXTERNAL_DEPTH = 17.0 / 24.0 * sqrt(3.0) / 2.0
"""Thread depth per pitch of an external metric thread, [1]_."""

RUN_IN = 2.0
"""Run-in length in pitches while the slide synchronises with the spindle, customary."""

HALF_ANGLE_DEG = 30.0
"""Half the profile angle of a metric thread, degrees, [1]_."""

HALF_INSERT = 0.5
"""Greatest half width of the thread profile, in pitches, [1]_."""

FEWEST_PASSES = 4
PASSES_PER_MM = 4.0
"""Passes per mm of pitch where the strategy gives no depths, customary."""

SAME_PITCH = 1e-6
"""Tolerance within which two lengths are equal, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnedThread:
    """Thread to be cut; start and end are z in the direction of cutting, mm."""

    pitch: float
    depth: float
    radius: float
    start: float
    end: float

    @property
    def towards(self) -> float:
        """Direction of cutting along z: −1 towards the chuck, +1 away from it."""
        return -1.0 if self.end < self.start else 1.0


def threaded_feature(job: ToolPathTask, ref: Ref[Entity]) -> Ref[Entity]:
    """Reference of the shape that carries a thread; the feature itself if not a thread."""
    feature = job.program.get(ref)
    if not isinstance(feature, Thread):
        return ref
    if not feature.applied_shape:
        raise job.fault("the thread does not name the shape it is cut on", ref, "applied_shape")
    return feature.applied_shape[0]


def thread(
    job: ToolPathTask, course: PathBuilder, bar: TurningBlank, outline: FeatureOutline
) -> None:
    """Generate the path of a threading operation.

    Raises
    ------
    PathError
        If no pitch is given, the thread is internal, or the thread is too deep.
    """
    strategy = _strategy(job)
    pitch = _pitch(job, course)
    helix = _helix(job, outline, pitch)
    half = _half_angle(job)
    shifts = [_shift(helix, strategy, 0.0, index) * tan(half) for index in (0, 1)]
    outwards = max(0.0, *(-helix.towards * shift for shift in shifts))
    run_in = _run_in(job, course, bar, helix, strategy, outwards)
    run_out = _run_out(job, course, bar, helix, strategy)
    start = helix.start - helix.towards * run_in
    end = helix.end + helix.towards * run_out
    lift = getattr(strategy, "lift_height", None) or RAPID_CLEARANCE
    outside = bar.left.top(min(start, end), max(start, end))
    clear = max(outside, helix.radius) + max(lift, RAPID_CLEARANCE)
    angle = getattr(strategy, "path_return_angle", None)
    home = course.at
    for index, depth in enumerate(_depths(job, helix, strategy)):
        shift = _shift(helix, strategy, depth, index) * tan(half)
        kind = MoveType.RAPID if index else MoveType.APPROACH
        if index == 0:
            course.rapid((home[0], 0.0, start + shift), kind)
        one = ThreadPass(
            start=start + shift,
            end=end,
            bottom=helix.radius - depth,
            clear=clear,
            angle=angle,
            has_relief=run_out > 0.0,
        )
        cut_thread(job, course, one, stock=bar.left, pitch=pitch, kind=kind)
    course.rapid((home[0], 0.0, course.at[2]), MoveType.RETRACT)
    course.rapid(home, MoveType.RETRACT)


def _strategy(job: ToolPathTask) -> ThreadStrategy | None:
    strategy = strategy_of(job)
    return strategy if isinstance(strategy, ThreadStrategy) else None


def _pitch(job: ToolPathTask, course: PathBuilder) -> float:
    """Pitch of the tool or else the feed per revolution of the technology, mm."""
    tool = job.program.get(job.step.tool_ref)
    technology = job.program.get(job.step.technology_ref)
    fed = technology.feed_per_revolution if isinstance(technology, TurningTechnology) else None
    pitch = tool.threading_pitch if isinstance(tool, TurningThreadingTool) else None
    pitch = fed if pitch is None else pitch
    if pitch is None or not 0.0 < pitch < 1e3:
        raise job.fault(f"thread pitch {pitch} mm must be positive", job.step.tool_ref)
    if fed is not None and abs(fed - pitch) > SAME_PITCH:
        text = f"feed {fed:g} mm/rev differs from the pitch {pitch:g} mm: pitch used"
        course.find(job.warning(text, job.step.technology_ref, "feed_per_revolution"))
    return float(pitch)


def _helix(job: ToolPathTask, outline: FeatureOutline, pitch: float) -> TurnedThread:
    """Position, pitch and depth of the thread to be cut."""
    tool = job.program.get(job.step.tool_ref)
    feature = job.program.get(job.step.features[0])
    is_left = False
    if isinstance(tool, TurningThreadingTool):
        is_left = tool.thread_hand is ThreadHandType.LEFT
        if tool.its_thread_type is ThreadType.INTERNAL:
            raise job.fault("internal threads are not supported", job.step.tool_ref)
    depth = EXTERNAL_DEPTH * pitch
    least, radius = outline.radii
    if radius - least > SAME_PITCH:
        raise job.fault("tapered threads are not supported", outline.ref)
    low, high = outline.low, outline.high
    if isinstance(feature, Thread):
        area = job.program.get(feature.partial_profile)
        low = max(low, high - area.effective_length)
        if isinstance(feature, DefinedThread) and feature.minor_diameter:
            depth = radius - 0.5 * feature.minor_diameter
    if not 0.0 < depth < radius:
        message = f"thread depth {depth:.4g} mm is not valid at a radius of {radius:g} mm"
        raise job.fault(message, job.step.features[0])
    start, end = (low, high) if is_left else (high, low)
    return TurnedThread(pitch=pitch, depth=depth, radius=radius, start=start, end=end)


def _run_out(
    job: ToolPathTask,
    course: PathBuilder,
    bar: TurningBlank,
    helix: TurnedThread,
    strategy: ThreadStrategy | None,
) -> float:
    """Run-out behind the thread, mm: the overcut where a relief or the bar end gives room."""
    wanted = getattr(strategy, "overcut_length", None)
    wanted = helix.pitch if wanted is None else wanted
    beside = HALF_INSERT * helix.pitch
    length = _room(bar, helix, helix.end, helix.towards * wanted, beside)
    if length > 0.0:
        return length
    if not getattr(strategy, "path_return_angle", None):
        text = "no relief behind the thread: the tool pulls out in the material"
        course.warn(text, job.step.features[0])
    if length < 0.0:
        text = f"the thread stops {-length:.3g} mm before the shoulder: the insert needs room"
        course.warn(text, job.step.features[0])
    return length


def _run_in(
    job: ToolPathTask,
    course: PathBuilder,
    bar: TurningBlank,
    helix: TurnedThread,
    strategy: ThreadStrategy | None,
    outwards: float,
) -> float:
    """Run-in before the thread, mm; shifted passes may start further out."""
    wanted = max(RUN_IN * helix.pitch, getattr(strategy, "overcut_length", None) or 0.0)
    beside = HALF_INSERT * helix.pitch + outwards
    length = _room(bar, helix, helix.start, -helix.towards * wanted, beside)
    if length < RUN_IN * helix.pitch - SAME_PITCH:
        text = f"material in front of the thread: the run-in is {max(length, 0.0):.3g} mm"
        course.warn(f"{text} instead of {wanted:.3g} mm", job.step.features[0])
    return length


def _room(
    bar: TurningBlank, helix: TurnedThread, at: float, reach: float, clearance: float
) -> float:
    """Clear length for the tip beyond an end of the thread, mm, with side clearance.

    Negative at a shoulder, where the insert must stop short.
    """
    half = copysign(clearance, reach)
    for eighths in range(8, 0, -1):
        part = reach * eighths / 8.0
        if part and _top(bar, at, at + part + half) <= helix.radius - helix.depth:
            return abs(part)
    is_shoulder = _top(bar, at, at + half) > helix.radius + SAME_PITCH
    return -abs(half) if is_shoulder else 0.0


def _top(bar: TurningBlank, start: float, end: float) -> float:
    """Greatest radius of the stock strictly between two z positions, mm."""
    low, high = min(start, end) + SAME_PITCH, max(start, end) - SAME_PITCH
    return bar.left.within(low, high).top(low, high)


def _depths(
    job: ToolPathTask, helix: TurnedThread, strategy: ThreadStrategy | None
) -> Iterator[float]:
    """Depth of each threading pass from the crest, mm."""
    allowance = allowance_of(job, job.step.operation_ref, job.step.operation)
    depths = depths_of(job)
    full = sum(depths) if len(depths) > 1 else helix.depth
    total = full - allowance
    if total <= 0.0 or total >= helix.radius:
        message = f"thread depth {full:.4g} mm minus allowance {allowance:g} mm is not valid"
        raise job.fault(message, job.step.operation_ref, "allowance")
    done = 0.0
    if isinstance(job.step.operation, ThreadingFinish):
        left = [
            getattr(e.operation, "allowance", None) or 0.0 for e in job.program.before(job.step)
        ]
        done = full - left[-1] if left and left[-1] > 0.0 else 0.0
    for depth in _sums(total, depths, strategy, helix.pitch):
        if depth > done + SAME_PITCH:
            yield depth


def _sums(
    total: float, depths: tuple[float, ...], strategy: ThreadStrategy | None, pitch: float
) -> list[float]:
    """Cumulative pass depths: from the list, with equal chip area, or equal steps, mm."""
    if len(depths) > 1:
        return cumulative(total, depths)
    is_even = strategy is not None and (
        strategy.cut_in_amount_function is ThreadCutDepthType.CONSTANT_DEPTH
    )
    count = max(FEWEST_PASSES, ceil(PASSES_PER_MM * pitch))
    if depths:
        ratio = total / depths[0]
        count = ceil((ratio if is_even else ratio * ratio) - SAME_PITCH)
    count = min(max(count, 1), MOST_PASSES)
    return [total * (i / count if is_even else sqrt(i / count)) for i in range(1, count + 1)]


def _half_angle(job: ToolPathTask) -> float:
    """Half the angle of the thread profile, rad."""
    tool = job.program.get(job.step.tool_ref)
    included = None
    if isinstance(tool, TurningThreadingTool):
        included = job.program.get(tool.cutting_edge).tool_included_angle
    if included is not None and not 0.0 < included < 180.0:
        message = f"an included angle of {included:g} degrees is not a valid thread profile"
        raise job.fault(message, job.step.tool_ref, "tool_included_angle")
    return rad_from_deg(0.5 * included if included else HALF_ANGLE_DEG)


def _shift(
    helix: TurnedThread, strategy: ThreadStrategy | None, depth: float, index: int
) -> float:
    """Remaining depth, signed for the flank infeed so that passes keep to one flank, mm."""
    direction = strategy.threading_direction if strategy else ThreadingDirectionType.CENTER
    side = {
        ThreadingDirectionType.RIGHT: 1.0,
        ThreadingDirectionType.LEFT: -1.0,
        ThreadingDirectionType.RIGHT_ZIGZAG: 1.0 if index % 2 == 0 else -1.0,
        ThreadingDirectionType.LEFT_ZIGZAG: -1.0 if index % 2 == 0 else 1.0,
    }.get(direction, 0.0)
    return side * max(0.0, helix.depth - depth)
