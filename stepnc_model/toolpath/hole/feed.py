"""Feeds along the depth of a hole: reduced where a drill enters and where it leaves.

ISO 14649-11, ``drilling_type_strategy``: the values at the start hold down to
``depth_of_start``, those at the end from ``depth_of_end`` on. Both depths are those of the full
diameter, below the top of the hole; so NIST's interpreter reads them as well.
"""

from dataclasses import dataclass, replace
from math import inf

from stepnc_model.entities.drilling import DrillingTypeOperation, Tapping
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.strategies import DrillingTypeStrategy
from stepnc_model.technology import programmed
from stepnc_model.toolpath.hole.depth import Depth
from stepnc_model.toolpath.hole.feature import Hole
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import Feed

PERCENT = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One feed, down to a height of the tip."""

    end_z: float
    """mm"""
    feed: Feed


def stages_of(
    job: Job, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> tuple[Stage, ...]:
    """Feeds from the top of a hole to its bottom, in order.

    Raises
    ------
    PathError
        When a reduction is no ratio, or a tap has no pitch.
    """
    bottom = hole.top[2] - depth.tip
    if isinstance(operation, Tapping):
        return (Stage(end_z=bottom, feed=_thread_feed(job)),)
    if operation.its_machining_strategy is None:
        return (Stage(end_z=bottom, feed=job.feed),)
    strategy: Entity = job.program.get(operation.its_machining_strategy)
    if not isinstance(strategy, DrillingTypeStrategy):
        message = "is no strategy of drilling"
        raise job.fault(message, operation.its_machining_strategy)
    start = _reduced(job, operation, strategy, "start")
    end = _reduced(job, operation, strategy, "end")
    point = depth.tip - depth.full
    stages: list[Stage] = []
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
            stages.append(Stage(end_z=end_z, feed=feed))
            height = end_z
    return _merged(stages)


def retract_feed(job: Job, operation: DrillingTypeOperation, last: Feed) -> Feed:
    """Feed out of the hole: ``feed_on_retract`` times the programmed one, else that itself.

    The spindle keeps the speed that it has at the bottom.
    """
    ratio = operation.feed_on_retract
    if ratio is None:
        return replace(last, ratio=1.0)
    if not 0.0 < ratio < inf:
        message = f"{ratio:g}: it must be positive"
        raise job.fault(message, job.step.operation_ref, "feed_on_retract")
    return replace(last, ratio=1.0 if last.is_synchronised else ratio)


def _reduced(
    job: Job, operation: DrillingTypeOperation, strategy: DrillingTypeStrategy, where: str
) -> Feed:
    """Programmed feed and speed, times the ratios at the start or at the end."""
    ratios = []
    for name in (f"reduced_feed_at_{where}", f"reduced_cut_at_{where}"):
        ratio = getattr(strategy, name)
        if ratio is None:
            ratio = 1.0
        elif 1.0 < ratio <= PERCENT:
            # Files of the draft of 2001 write percent.
            ratio /= PERCENT
        if not 0.0 < ratio <= 1.0:
            message = f"{ratio:g}: a ratio from 0 to 1, or percent up to 100"
            raise job.fault(message, job.step.operation_ref, name)
        ratios.append(ratio)
    return replace(job.feed, ratio=ratios[0], speed_ratio=ratios[1])


def _merged(stages: list[Stage]) -> tuple[Stage, ...]:
    """Stages without those that the next one continues."""
    kept = [
        stage
        for stage, following in zip(stages, [*stages[1:], None], strict=True)
        if following is None or following.feed != stage.feed
    ]
    return tuple(kept)


def _thread_feed(job: Job) -> Feed:
    """One pitch per revolution: the programmed feed over the programmed speed."""
    values = programmed(job.program, job.step.technology_ref)
    speed = values.spindle_speed(job.tool.diameter)
    pitch = values.feed_per_tooth(speed, job.tool.teeth) * job.tool.teeth
    return Feed(technology=job.step.technology_ref, per_revolution=pitch, is_synchronised=True)
