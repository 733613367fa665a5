"""What the strategy of a turning operation says, as numbers: depths, overcut, lift, feeds."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, chain, repeat
from math import ceil, hypot, isfinite

from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.turning_strategies import BidirectionalTurning, ContourTurning
from stepnc_model.part21.values import Ref, Typed
from stepnc_model.toolpath.job import DEFAULT_CLEARANCE, Job
from stepnc_model.toolpath.path import Feed
from stepnc_model.toolpath.turning_piece import Spot
from stepnc_model.toolpath.turning_plane import HalfPlane
from stepnc_model.toolpath.turning_stock import operation_of
from stepnc_model.toolpath.turning_walk import RAPID_CLEARANCE, Feeds
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
    lift: Spot
    """unit vector"""
    lift_height: float
    """mm"""
    feeds: Feeds
    is_reversed: bool
    """passes run towards +u"""
    is_to_and_fro: bool
    is_along_contour: bool


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
    ahead = direction_in(job, plane, getattr(strategy, "feed_direction", None))
    lift = direction_in(job, plane, getattr(strategy, "lift_direction", None))
    height = getattr(strategy, "lift_height", None)
    is_reversed = ahead is not None and ahead[0] > abs(ahead[1])
    back = -(0.5**0.5) if is_reversed else 0.5**0.5
    for name, length in (("overcut_length", overcut), ("lift_height", height)):
        if length is not None and not (0.0 <= length < 1e4):
            raise job.fault(f"{length:g} mm is no such length", reference or job.step.ref, name)
    return Setting(
        depths=depths_of(job),
        overcut=DEFAULT_OVERCUT if overcut is None else float(overcut),
        lift=lift if lift is not None and lift[1] > 0.0 else (back, 0.5**0.5),
        lift_height=RAPID_CLEARANCE if height is None else float(height),
        feeds=Feeds(
            cutting=cutting_feed(job),
            lift=_feed(job, getattr(strategy, "lift_feed", None), "lift_feed"),
            stepover=_feed(job, getattr(strategy, "stepover_feed", None), "stepover_feed"),
        ),
        is_reversed=is_reversed,
        is_to_and_fro=isinstance(strategy, BidirectionalTurning),
        is_along_contour=isinstance(strategy, ContourTurning),
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


def direction_in(job: Job, plane: HalfPlane, ref: Ref[Direction] | None) -> Spot | None:
    """A direction of the file in a half plane, as a unit vector."""
    if ref is None:
        return None
    ratios = (*job.program.get(ref).direction_ratios, 0.0, 0.0, 0.0)[:3]
    x, z = float(ratios[0]), float(ratios[2])
    length = hypot(x, z)
    if not 0.0 < length < 1e12:
        return None
    return (x / length, z / length) if plane.is_across else (z / length, x / length)


def _feed(job: Job, written: Typed | float | None, name: str) -> Feed:
    """A feed of the strategy, the programmed one where it gives none."""
    if written is None:
        return job.feed
    value = written.value if isinstance(written, Typed) else written
    if not isinstance(value, (int, float)) or not 0.0 < value < 1e6:
        reference = operation_of(job).its_machining_strategy or job.step.operation_ref
        raise job.fault("a feed must be positive", reference, name)
    if isinstance(written, Typed) and "REV" in written.keyword.upper():
        return Feed(technology=job.step.technology_ref, per_revolution=float(value))
    return Feed(technology=job.step.technology_ref, velocity=speed_from_m_s(float(value)))
