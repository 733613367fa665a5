"""What the strategy of a turning operation says, as numbers: depths, overcut, lift, feeds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, chain, repeat
from math import ceil, isfinite

from stepnc_model.entities.turning_strategies import (
    BidirectionalTurning,
    ContourTurning,
    TurningMachiningStrategy,
)
from stepnc_model.part21.values import Typed
from stepnc_model.toolpath.job import DEFAULT_CLEARANCE, Job
from stepnc_model.toolpath.path import Feed
from stepnc_model.toolpath.turning.link import Link, link_of
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.stock import operation_of
from stepnc_model.toolpath.turning.walk import RAPID_CLEARANCE, Feeds
from stepnc_model.units import speed_from_m_s

DEFAULT_OVERCUT = 2.0
"""mm of feed through air before the cut where the strategy gives none; customary"""

SLIVER = 0.25
"""part of a full pass below which the last one is no pass: all are made equal"""

MOST_PASSES = 2000

LEAST_TOTAL = 1e-6
"""mm of material that is none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """How the passes of an operation run."""

    depths: tuple[float, ...]
    """mm: of each pass, the last one for all that follow; none: all at once"""
    overcut: float
    """mm"""
    link: Link
    feeds: Feeds
    is_reversed: bool
    """passes run towards +u"""
    is_to_and_fro: bool
    is_along_contour: bool
    is_one_pass: bool
    """the strategy allows no second one"""


def setting_of(job: Job, plane: HalfPlane) -> Setting:
    """Numbers of the strategy of an operation, customary ones where it has none.

    Raises
    ------
    PathError
        When a depth, a length or a feed is not positive.
    """
    reference = operation_of(job).its_machining_strategy
    strategy = job.program.get(reference) if reference is not None else None
    overcut = getattr(strategy, "overcut_length", None)
    link = link_of(job, plane)
    if overcut is not None and not 0.0 <= overcut < 1e4:
        at = reference or job.step.ref
        raise job.fault(f"{overcut:g} mm is no such length", at, "overcut_length")
    return Setting(
        depths=depths_of(job),
        overcut=DEFAULT_OVERCUT if overcut is None else float(overcut),
        link=link,
        feeds=_feeds(job, strategy),
        is_reversed=link.ahead[0] > 0.0,
        is_to_and_fro=isinstance(strategy, BidirectionalTurning),
        is_along_contour=isinstance(strategy, ContourTurning),
        is_one_pass=strategy is not None and strategy.allow_multiple_passes is False,
    )


def depths_of(job: Job) -> tuple[float, ...]:
    """Depths of the passes as the strategy gives them."""
    reference = operation_of(job).its_machining_strategy
    strategy = job.program.get(reference) if reference is not None else None
    if strategy is not None and strategy.allow_multiple_passes is False:
        return ()
    depths = tuple(map(float, getattr(strategy, "cutting_depth", None) or ()))
    for depth in depths:
        if not isfinite(depth) or depth <= 0.0:
            message = f"a depth of {depth:g} mm removes nothing: it must be positive"
            raise job.fault(message, reference or job.step.operation_ref, "cutting_depth")
    return depths


def clearance_of(job: Job) -> float:
    """Distance of the safe point from the stock, mm."""
    plane = operation_of(job).retract_plane
    if plane is None:
        return DEFAULT_CLEARANCE
    if not 0.0 <= plane < 1e4:
        message = f"{plane:g} mm above the feature: it must not be negative"
        raise job.fault(message, job.step.operation_ref, "retract_plane")
    return max(float(plane), RAPID_CLEARANCE)


def cutting_feed(job: Job) -> Feed:
    """The programmed feed, by the ratio of the strategy."""
    reference = operation_of(job).its_machining_strategy
    ratio = job.program.get(reference).variable_feedrate if reference is not None else None
    if ratio is None:
        return job.feed
    if not 0.0 < ratio < 100.0:
        raise job.fault(f"{ratio:g} is no ratio of a feed", job.step.ref, "variable_feedrate")
    return Feed(technology=job.step.technology_ref, ratio=float(ratio))


def cumulative(total: float, depths: Sequence[float]) -> list[float]:
    """Depths from the outside after each pass, the last one the total.

    Passes that would leave a sliver for the last one are made equal.

    Examples
    --------
    >>> cumulative(5.0, (2.0,))
    [2.0, 4.0, 5.0]
    >>> cumulative(6.0625, (3.0,))
    [2.02083..., 4.04166..., 6.0625]
    """
    if total <= LEAST_TOTAL:
        return []
    if not depths:
        return [total]
    following = chain(depths, repeat(depths[-1]))
    sums: list[float] = []
    for at in accumulate(following):
        if at >= total - LEAST_TOTAL or len(sums) > MOST_PASSES:
            break
        sums.append(at)
    rest = total - (sums[-1] if sums else 0.0)
    is_sliver = len(depths) == 1 and sums and rest < SLIVER * depths[0]
    if is_sliver:
        count = ceil(total / depths[0] - LEAST_TOTAL)
        return [total * i / count for i in range(1, count)] + [total]
    return [*sums, total]


def _feeds(job: Job, strategy: TurningMachiningStrategy | None) -> Feeds:
    """Feeds of the passes and of the ways between them.

    ISO 14649-12 does not say what ``variable_stepover_feed`` is a ratio for: here it scales
    the feed of a step over where that one cuts, as ``variable_feedrate`` scales the passes.
    """
    cutting = cutting_feed(job)
    stepover = _feed(job, getattr(strategy, "stepover_feed", None), "stepover_feed")
    entering = stepover or cutting
    ratio = getattr(strategy, "variable_stepover_feed", None)
    if ratio is not None:
        if not 0.0 < ratio < 100.0:
            at = operation_of(job).its_machining_strategy or job.step.ref
            raise job.fault(f"{ratio:g} is no ratio of a feed", at, "variable_stepover_feed")
        entering = _scaled(entering, float(ratio))
    return Feeds(
        cutting=cutting,
        lift=_feed(job, getattr(strategy, "lift_feed", None), "lift_feed") or job.feed,
        stepover=stepover or job.feed,
        entering=entering,
    )


def _scaled(feed: Feed, ratio: float) -> Feed:
    """A feed by a ratio, in whichever way it is given."""
    if feed.velocity is not None:
        return replace(feed, velocity=feed.velocity * ratio)
    if feed.per_revolution is not None:
        return replace(feed, per_revolution=feed.per_revolution * ratio)
    return replace(feed, ratio=feed.ratio * ratio)


def _feed(job: Job, written: Typed | float | None, name: str) -> Feed | None:
    """A feed of the strategy, if it gives one."""
    if written is None:
        return None
    value = written.value if isinstance(written, Typed) else written
    if not isinstance(value, (int, float)) or not 0.0 < value < 1e6:
        reference = operation_of(job).its_machining_strategy or job.step.operation_ref
        raise job.fault("a feed must be positive", reference, name)
    if isinstance(written, Typed) and "REV" in written.keyword.upper():
        return Feed(technology=job.step.technology_ref, per_revolution=float(value))
    return Feed(technology=job.step.technology_ref, velocity=speed_from_m_s(float(value)))
