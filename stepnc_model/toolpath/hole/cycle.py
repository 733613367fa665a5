"""Moves of a tool in one hole, from the retract plane to the bottom and back.

ISO 14649-11: a tool leaves the hole at feed. Drilling cycles of controls, and cycles that
stop the spindle, retract in rapid; they are used all the same where ``feed_on_retract`` is not
given, because they leave the same hole.

Feeds may be reduced where a drill enters and where it leaves. ISO 14649-11,
``drilling_type_strategy``: the values at the start apply down to ``depth_of_start``, those at
the end from ``depth_of_end`` on. Both depths refer to the full diameter, below the top of the
hole, as NIST's interpreter reads them.
"""

from dataclasses import dataclass, replace
from math import inf

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.milling import (
    BoringOperation,
    DrillingTypeOperation,
    DrillingTypeStrategy,
    MultistepDrilling,
    Tapping,
)
from stepnc_model.entities.technology import MillingMachineFunctions
from stepnc_model.programs.technology import programmed
from stepnc_model.toolpath.hole.feature import Depth, Hole
from stepnc_model.toolpath.path import CannedCycle, CycleKind, Feed, MoveType, SpindleCommand
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask

PERCENT = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedStage:
    """Feed that applies down to a height of the tool tip."""

    end_z: float
    """Height z of the tip at the end of the stage, mm."""
    feed: Feed


def stages_of(
    job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> tuple[FeedStage, ...]:
    """Feed stages from the top of a hole to its bottom, in order.

    Raises
    ------
    PathError
        If a reduction is not a valid ratio, or a tap has no pitch.
    """
    bottom = hole.top[2] - depth.tip
    if isinstance(operation, Tapping):
        return (FeedStage(end_z=bottom, feed=_thread_feed(job)),)
    if operation.its_machining_strategy is None:
        return (FeedStage(end_z=bottom, feed=job.feed),)
    strategy: Entity = job.program.get(operation.its_machining_strategy)
    if not isinstance(strategy, DrillingTypeStrategy):
        message = "is not a drilling strategy"
        raise job.fault(message, operation.its_machining_strategy)
    start = _reduced(job, operation, strategy, "start")
    end = _reduced(job, operation, strategy, "end")
    point = depth.tip - depth.full
    stages: list[FeedStage] = []
    height = inf
    for limit, feed in (
        (strategy.depth_of_start, start),
        (strategy.depth_of_end if end != job.feed else None, job.feed),
        (depth.full, end if strategy.depth_of_end is not None else job.feed),
    ):
        if limit is None:
            continue
        end_z = max(bottom, hole.top[2] - limit - point)
        if end_z < min(height, hole.top[2]):
            stages.append(FeedStage(end_z=end_z, feed=feed))
            height = end_z
    return _merged(stages)


def retract_feed(job: ToolPathTask, operation: DrillingTypeOperation, last: Feed) -> Feed:
    """Feed out of the hole: the last feed, scaled by ``feed_on_retract`` if given.

    The spindle keeps its speed from the bottom of the hole.
    """
    ratio = operation.feed_on_retract
    if ratio is None:
        return replace(last, ratio=1.0)
    if not 0.0 < ratio < inf:
        message = f"{ratio:g}: the feed ratio must be positive"
        raise job.fault(message, job.step.operation_ref, "feed_on_retract")
    return replace(last, ratio=1.0 if last.is_synchronised else ratio)


def _reduced(
    job: ToolPathTask,
    operation: DrillingTypeOperation,
    strategy: DrillingTypeStrategy,
    where: str,
) -> Feed:
    """Programmed feed and speed, scaled by the ratios at the start or the end of the hole."""
    ratios = []
    for name in (f"reduced_feed_at_{where}", f"reduced_cut_at_{where}"):
        ratio = getattr(strategy, name)
        if ratio is None:
            ratio = 1.0
        elif 1.0 < ratio <= PERCENT:
            # Files of the draft of 2001 write percent.
            ratio /= PERCENT
        if not 0.0 < ratio <= 1.0:
            message = f"{ratio:g}: must be a ratio from 0 to 1, or a percentage up to 100"
            raise job.fault(message, job.step.operation_ref, name)
        ratios.append(ratio)
    return replace(job.feed, ratio=ratios[0], speed_ratio=ratios[1])


def _merged(stages: list[FeedStage]) -> tuple[FeedStage, ...]:
    """Merge consecutive stages that have the same feed."""
    kept = [
        stage
        for stage, following in zip(stages, [*stages[1:], None], strict=True)
        if following is None or following.feed != stage.feed
    ]
    return tuple(kept)


def _thread_feed(job: ToolPathTask) -> Feed:
    """Feed of one pitch per revolution: the programmed feed divided by the programmed speed."""
    values = programmed(job.program, job.step.technology_ref)
    speed = values.spindle_speed(job.tool.diameter)
    pitch = values.feed_per_tooth(speed, job.tool.teeth) * job.tool.teeth
    return Feed(technology=job.step.technology_ref, per_revolution=pitch, is_synchronised=True)


PECK_CLEARANCE = 1.0
"""Height above the last depth where a returning drill starts to feed, mm, customary."""

MOST_PECKS = 1000

SAME_DEPTH = 1e-6
"""Tolerance within which two depths are equal, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HoleCut:
    """Hole with the heights and feeds for cutting it, mm, in setup coordinates."""

    job: ToolPathTask
    operation: DrillingTypeOperation
    hole: Hole
    retract_z: float
    bottom_z: float
    """Height z of the tool tip at the bottom, mm."""
    stages: tuple[FeedStage, ...]

    @property
    def feed(self) -> Feed:
        """Feed of the tool at the bottom of the hole."""
        return self.stages[-1].feed

    @property
    def is_one_feed(self) -> bool:
        """True if one feed applies over the whole depth."""
        return len(self.stages) == 1


def cut_hole(course: PathBuilder, cut: HoleCut) -> None:
    """Cut one hole; the tool starts and ends on the retract plane above it."""
    if isinstance(cut.operation, Tapping):
        _tap(course, cut)
    elif isinstance(cut.operation, MultistepDrilling):
        _peck(course, cut, cut.operation)
    elif isinstance(cut.operation, BoringOperation):
        _bore(course, cut, cut.operation)
    else:
        _drill(course, cut)


def _drill(course: PathBuilder, cut: HoleCut) -> None:
    """Drill to the bottom in one feed and retract."""
    first = course.count
    feed_to(course, cut, cut.bottom_z)
    dwell(course, cut, cut.operation.dwell_time_bottom, "dwell_time_bottom")
    retract(course, cut)
    if not cut.is_one_feed:
        return
    if cut.operation.feed_on_retract is None:
        kind = CycleKind.DWELL if cut.operation.dwell_time_bottom else CycleKind.DRILL
        _name_cycle(course, cut, kind, first)
    elif retract_feed(cut.job, cut.operation, cut.feed) == cut.feed:
        _name_cycle(course, cut, CycleKind.BORE, first)


def _peck(course: PathBuilder, cut: HoleCut, operation: MultistepDrilling) -> None:
    """Drill in pecks, with a short retract to break chips or a full retract to clear them.

    ISO 14649-11: a retract distance of 0 or less means the retract plane. The depths refer to
    the tip. Retracts are rapid, the last one too unless ``feed_on_retract`` is given.
    """
    first = course.count
    distance = operation.retract_distance or 0.0
    for z in _pecks(cut, operation):
        feed_to(course, cut, z)
        dwell(course, cut, operation.dwell_time_step, "dwell_time_step")
        if distance > 0.0:
            course.rapid(cut.hole.at(min(z + distance, cut.retract_z)), MoveType.RETRACT)
        else:
            course.rapid(cut.hole.at(cut.retract_z), MoveType.RETRACT)
            course.rapid(cut.hole.at(min(z + PECK_CLEARANCE, cut.retract_z)))
    feed_to(course, cut, cut.bottom_z)
    dwell(course, cut, operation.dwell_time_bottom, "dwell_time_bottom")
    if operation.feed_on_retract is not None:
        retract(course, cut)
        return
    course.rapid(cut.hole.at(cut.retract_z), MoveType.RETRACT)
    is_even = abs(operation.first_depth - operation.depth_of_step) < SAME_DEPTH
    if cut.is_one_feed and is_even and not operation.dwell_time_step:
        kind = CycleKind.CHIP_BREAK if distance > 0.0 else CycleKind.PECK
        _name_cycle(course, cut, kind, first)


def _pecks(cut: HoleCut, operation: MultistepDrilling) -> list[float]:
    """Heights z of the tip after each peck except the last, mm."""
    at = cut.job.step.operation_ref
    for name in ("first_depth", "depth_of_step"):
        value = getattr(operation, name)
        if value is None or not 0.0 < value < inf:
            raise cut.job.fault(f"{value} mm: the depth must be positive", at, name)
    top = cut.hole.top[2]
    count = (top - operation.first_depth - cut.bottom_z - SAME_DEPTH) / operation.depth_of_step
    if count > MOST_PECKS:
        message = f"{count:.0f} pecks to the bottom: at most {MOST_PECKS} allowed"
        raise cut.job.fault(message, at, "depth_of_step")
    heights: list[float] = []
    z = top - operation.first_depth
    while z > cut.bottom_z + SAME_DEPTH:
        heights.append(z)
        z = top - operation.first_depth - len(heights) * operation.depth_of_step
    return heights


def _bore(course: PathBuilder, cut: HoleCut, operation: BoringOperation) -> None:
    """Bore to the bottom and retract, with a test cut and a spindle stop where given."""
    if operation.depth_of_testcut:
        _test_cut(course, cut, operation, operation.depth_of_testcut)
    first = course.count
    feed_to(course, cut, cut.bottom_z)
    dwell(course, cut, operation.dwell_time_bottom, "dwell_time_bottom")
    if not operation.spindle_stop_at_bottom:
        retract(course, cut)
        if cut.is_one_feed and retract_feed(cut.job, operation, cut.feed) == cut.feed:
            _name_cycle(course, cut, CycleKind.BORE, first)
        return
    stop = SpindleCommand.ORIENT if _is_oriented(cut) else SpindleCommand.STOP
    course.spindle(stop)
    retract(course, cut)
    course.spindle(SpindleCommand.START)
    is_plain = cut.is_one_feed and operation.feed_on_retract is None
    if stop is SpindleCommand.STOP and is_plain:
        _name_cycle(course, cut, CycleKind.BORE_STOP, first)


def _is_oriented(cut: HoleCut) -> bool:
    """True if the spindle stops at a defined angle."""
    ref = cut.job.step.functions_ref
    functions = cut.job.program.get(ref) if ref is not None else None
    return (
        isinstance(functions, MillingMachineFunctions)
        and functions.oriented_spindle_stop is not None
    )


def _test_cut(
    course: PathBuilder, cut: HoleCut, operation: BoringOperation, depth: float
) -> None:
    """Make a short test cut and move away for measuring, ISO 14649-11."""
    z = cut.hole.top[2] - depth
    if not cut.bottom_z < z < cut.hole.top[2]:
        whole = cut.hole.top[2] - cut.bottom_z
        message = f"{depth:g} mm: the test cut must lie between 0 and the depth of {whole:g} mm"
        raise cut.job.fault(message, cut.job.step.operation_ref, "depth_of_testcut")
    feed_to(course, cut, z)
    retract(course, cut)
    course.spindle(SpindleCommand.STOP)
    if operation.waiting_position is not None:
        x, y, wanted = cut.hole.point(cut.job, operation.waiting_position)
        height = min(max(wanted, cut.retract_z), max(cut.job.security_z, cut.retract_z))
        course.rapid(cut.hole.at(height))
        course.rapid((x, y, height))
        course.rapid(cut.hole.at(height))
    text = "measure the hole after the test cut: the path contains no program stop for it"
    course.find(cut.job.warning(text, attribute="depth_of_testcut"))
    course.spindle(SpindleCommand.START)
    course.rapid(cut.hole.at(cut.retract_z))


def _tap(course: PathBuilder, cut: HoleCut) -> None:
    """Tap by one pitch per revolution, and retract with the spindle reversed."""
    first = course.count
    feed_to(course, cut, cut.bottom_z)
    dwell(course, cut, cut.operation.dwell_time_bottom, "dwell_time_bottom")
    course.spindle(SpindleCommand.REVERSE)
    retract(course, cut)
    course.spindle(SpindleCommand.START)
    _name_cycle(course, cut, CycleKind.TAP, first)


def feed_to(course: PathBuilder, cut: HoleCut, z: float) -> None:
    """Feed down to a height with the feed of each stage."""
    for stage in cut.stages:
        if course.at[2] > stage.end_z + SAME_DEPTH and course.at[2] > z + SAME_DEPTH:
            end = cut.hole.at(max(z, stage.end_z))
            course.line(end, MoveType.CONTACT, stage.feed)


def retract(course: PathBuilder, cut: HoleCut) -> None:
    """Retract at feed to the retract plane."""
    feed = retract_feed(cut.job, cut.operation, cut.feed)
    course.line(cut.hole.at(cut.retract_z), MoveType.RETRACT, feed)


def dwell(course: PathBuilder, cut: HoleCut, seconds: float | None, attribute: str) -> None:
    """Dwell for a time in seconds, if one is given."""
    if not seconds:
        return
    if not 0.0 < seconds < inf:
        message = f"{seconds:g} s: the dwell must not be negative"
        raise cut.job.fault(message, cut.job.step.operation_ref, attribute)
    course.dwell(seconds=seconds)


def _name_cycle(course: PathBuilder, cut: HoleCut, kind: CycleKind, first: int) -> None:
    """Record that the steps since the first one form a canned cycle."""
    operation = cut.operation
    step_depth = retract_distance = 0.0
    if isinstance(operation, MultistepDrilling):
        step_depth = operation.depth_of_step
        retract_distance = max(0.0, operation.retract_distance or 0.0)
    course.cycle(
        CannedCycle(
            kind=kind,
            first=first,
            last=course.count - 1,
            retract_z=cut.retract_z,
            bottom_z=cut.bottom_z,
            feed=cut.feed,
            step_depth=step_depth,
            retract_distance=retract_distance,
            dwell=operation.dwell_time_bottom or 0.0,
        )
    )
