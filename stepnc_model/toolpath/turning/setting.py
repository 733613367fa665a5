"""Strategy of a turning operation as numbers: depths, overcut, feeds, and links between passes.

Links are lift, return path and stepover. Contradictory directions are ignored with a finding;
ignored or missing directions are replaced by the customary ones.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, chain, repeat
from math import ceil, hypot, isfinite

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.turning import (
    BidirectionalTurning,
    ContourTurning,
    TurningMachiningOperation,
    TurningMachiningStrategy,
)
from stepnc_model.errors import Finding, PathError
from stepnc_model.part21.values import Ref, Typed
from stepnc_model.toolpath.path import Feed
from stepnc_model.toolpath.task import DEFAULT_CLEARANCE, ToolPathTask
from stepnc_model.toolpath.turning.path_builder import RAPID_CLEARANCE, Feeds
from stepnc_model.toolpath.turning.profile import HalfPlane, Spot
from stepnc_model.units import speed_from_m_s

DEFAULT_LIFT = 1.0
"""Default lift off the surface after a pass, mm; customary."""

ALONG = 1e-6
"""Greatest sine between two directions that count as equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PassLink:
    """Directions of the moves between passes, as unit vectors in u and v."""

    ref: Ref[Entity]
    """Entity that defines the directions."""
    ahead: Spot = (-1.0, 0.0)
    """Direction of the first pass."""
    lift: Spot | None = None
    """Lift direction; None for out and back at 45°."""
    lift_height: float = DEFAULT_LIFT
    """Lift height, mm."""
    back: Spot | None = None
    """Return direction; None with a stepover for the shortest axis-parallel route."""
    stepover: Spot | None = None
    is_stepover_fed: bool = False
    """Whether the strategy gives a stepover feed; otherwise it is a rapid where clear."""
    findings: tuple[Finding, ...] = ()


def allowance_of(job: ToolPathTask, ref: Ref[Entity], operation: MachiningOperation) -> float:
    """Allowance that an operation leaves on the feature, mm."""
    allowance = getattr(operation, "allowance", None) or 0.0
    if not 0.0 <= allowance < 1e3:
        message = f"allowance {allowance:g} mm must be from 0 to 1000 mm"
        raise job.fault(message, ref, "allowance")
    return float(allowance)


def operation_of(job: ToolPathTask) -> TurningMachiningOperation:
    """Operation of a turning workingstep."""
    operation = job.step.operation
    if not isinstance(operation, TurningMachiningOperation):
        raise job.fault("is not a turning operation", job.step.operation_ref)
    return operation


def strategy_of(job: ToolPathTask) -> TurningMachiningStrategy | None:
    """Strategy of a turning operation, or None."""
    reference = operation_of(job).its_machining_strategy
    return None if reference is None else job.program.get(reference)


def strategy_fault(job: ToolPathTask, message: str, attribute: str) -> PathError:
    """Error that the operation's strategy allows no path."""
    at = operation_of(job).its_machining_strategy or job.step.operation_ref
    return job.fault(message, at, attribute)


def link_of(job: ToolPathTask, plane: HalfPlane) -> PassLink:
    """Read the moves between passes, ignoring contradictory directions.

    Raises
    ------
    PathError
        If the lift height is negative.
    """
    ref = operation_of(job).its_machining_strategy
    if ref is None:
        return PassLink(ref=job.step.operation_ref)
    strategy = job.program.get(ref)
    written = {
        name: direction_in(job, plane, getattr(strategy, name, None)) for name in DIRECTIONS
    }
    feed = written["feed_direction"]
    ahead = (1.0, 0.0) if feed is not None and feed[0] > abs(feed[1]) else (-1.0, 0.0)
    height = getattr(strategy, "lift_height", None)
    if height is not None and not 0.0 <= height < 1e4:
        raise job.fault(f"{height:g} mm is not a valid lift height", ref, "lift_height")
    faults = dict(_faults(job, strategy, written, ahead))
    good = {name: None if name in faults else at for name, at in written.items()}
    back, stepover = good["back_path_direction"], good["stepover_direction"]
    if back is None and stepover is not None and hasattr(strategy, "back_path_direction"):
        back = (-ahead[0], -ahead[1])
    return PassLink(
        ref=ref,
        ahead=ahead,
        lift=good["lift_direction"],
        lift_height=DEFAULT_LIFT if height is None else float(height),
        back=back,
        stepover=(0.0, -1.0) if back is not None and stepover is None else stepover,
        is_stepover_fed=getattr(strategy, "stepover_feed", None) is not None,
        findings=tuple(job.warning(text, ref, name) for name, text in faults.items()),
    )


DIRECTIONS = ("feed_direction", "lift_direction", "back_path_direction", "stepover_direction")


def direction_in(
    job: ToolPathTask, plane: HalfPlane, ref: Ref[Direction] | None
) -> Spot | None:
    """Direction of the file in a half plane, as a unit vector."""
    if ref is None:
        return None
    ratios = (*job.program.get(ref).direction_ratios, 0.0, 0.0, 0.0)[:3]
    x, z = float(ratios[0]), float(ratios[2])
    length = hypot(x, z)
    if not 0.0 < length < 1e12:
        return None
    return (x / length, z / length) if plane.is_across else (z / length, x / length)


def _faults(
    job: ToolPathTask, strategy: Entity, written: dict[str, Spot | None], ahead: Spot
) -> Iterator[tuple[str, str]]:
    """Attributes with contradictory directions, each with the problem and its replacement."""
    for name, at in written.items():
        if at is None and getattr(strategy, name, None) is not None:
            yield name, "not in the lathe's x-z plane: the customary direction is used"
    feed, lift, back, stepover = (written[name] for name in DIRECTIONS)
    if feed is not None and not isinstance(strategy, ContourTurning):
        if abs(feed[1]) > abs(feed[0]):
            yield "feed_direction", "a face is cut across the spindle axis, not along it"
        elif abs(feed[1]) > ALONG:
            yield (
                "feed_direction",
                "oblique direction: the passes run along its larger component",
            )
    if lift is not None and lift[1] <= ALONG:
        text = "points into the part" if lift[1] < -ALONG else "does not leave the surface"
        yield "lift_direction", f"the lift {text}: the tool lifts out and back at 45°"
    if back is not None and back[0] * ahead[0] > -ALONG:
        yield "back_path_direction", "does not point back: the customary return path is used"
    if stepover is not None and stepover[1] >= -ALONG:
        text = (
            "points along the feed"
            if abs(stepover[1]) <= ALONG
            else "points away from the part"
        )
        yield "stepover_direction", f"the stepover {text}: the tool steps straight in"


DEFAULT_OVERCUT = 2.0
"""Default feed length through air before the cut, mm; customary."""

SLIVER = 0.25
"""Fraction of a full pass below which the last pass is avoided by equal passes."""

MOST_PASSES = 2000

LEAST_TOTAL = 1e-6
"""Material thickness that counts as nothing to cut, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningSetting:
    """Settings of the passes of a turning operation."""

    depths: tuple[float, ...]
    """Depth of each pass, mm; the last value repeats; empty to cut everything at once."""
    overcut: float
    """Feed length through air before the cut, mm."""
    link: PassLink
    feeds: Feeds
    is_reversed: bool
    """Whether the passes run in the positive u direction."""
    is_to_and_fro: bool
    is_along_contour: bool
    is_one_pass: bool
    """Whether the strategy allows only one pass."""


def setting_of(job: ToolPathTask, plane: HalfPlane) -> TurningSetting:
    """Read the settings of an operation's strategy, with customary defaults.

    Raises
    ------
    PathError
        If a depth, a length or a feed is invalid.
    """
    strategy = strategy_of(job)
    overcut = getattr(strategy, "overcut_length", None)
    link = link_of(job, plane)
    if overcut is not None and not 0.0 <= overcut < 1e4:
        raise strategy_fault(job, f"{overcut:g} mm is not a valid length", "overcut_length")
    return TurningSetting(
        depths=depths_of(job),
        overcut=DEFAULT_OVERCUT if overcut is None else float(overcut),
        link=link,
        feeds=_feeds(job, strategy),
        is_reversed=link.ahead[0] > 0.0,
        is_to_and_fro=isinstance(strategy, BidirectionalTurning),
        is_along_contour=isinstance(strategy, ContourTurning),
        is_one_pass=strategy is not None and strategy.allow_multiple_passes is False,
    )


def depths_of(job: ToolPathTask) -> tuple[float, ...]:
    """Depths of the passes in the strategy, mm; empty for a single pass."""
    strategy = strategy_of(job)
    if strategy is not None and strategy.allow_multiple_passes is False:
        return ()
    depths = tuple(map(float, getattr(strategy, "cutting_depth", None) or ()))
    for depth in depths:
        if not isfinite(depth) or depth <= 0.0:
            message = f"cutting depth {depth:g} mm must be positive and finite"
            raise strategy_fault(job, message, "cutting_depth")
    return depths


def clearance_of(job: ToolPathTask) -> float:
    """Distance of the safe point from the stock, mm."""
    plane = operation_of(job).retract_plane
    if plane is None:
        return DEFAULT_CLEARANCE
    if not 0.0 <= plane < 1e4:
        message = f"{plane:g} mm above the feature: the retract plane must not be negative"
        raise job.fault(message, job.step.operation_ref, "retract_plane")
    return max(float(plane), RAPID_CLEARANCE)


def cutting_feed(job: ToolPathTask) -> Feed:
    """Programmed feed scaled by the ratio of the strategy."""
    ratio = getattr(strategy_of(job), "variable_feedrate", None)
    if ratio is None:
        return job.feed
    if not 0.0 < ratio < 100.0:
        raise job.fault(
            f"{ratio:g} is not a valid feed ratio", job.step.ref, "variable_feedrate"
        )
    return Feed(technology=job.step.technology_ref, ratio=float(ratio))


def cumulative(total: float, depths: Sequence[float]) -> list[float]:
    """Cumulative depths after each pass, the last being the total, mm.

    Passes are made equal where a thin sliver would be left for the last one.

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


def _feeds(job: ToolPathTask, strategy: TurningMachiningStrategy | None) -> Feeds:
    """Feeds of the passes and of the moves between them.

    ISO 14649-12 does not define what ``variable_stepover_feed`` is a ratio of: here it scales
    the stepover feed where the stepover cuts, as ``variable_feedrate`` scales the passes.
    """
    cutting = cutting_feed(job)
    stepover = _feed(job, getattr(strategy, "stepover_feed", None), "stepover_feed")
    entering = stepover or cutting
    ratio = getattr(strategy, "variable_stepover_feed", None)
    if ratio is not None:
        if not 0.0 < ratio < 100.0:
            message = f"{ratio:g} is not a valid feed ratio"
            raise strategy_fault(job, message, "variable_stepover_feed")
        entering = _scaled(entering, float(ratio))
    return Feeds(
        cutting=cutting,
        lift=_feed(job, getattr(strategy, "lift_feed", None), "lift_feed") or job.feed,
        stepover=stepover or job.feed,
        entering=entering,
    )


def _scaled(feed: Feed, ratio: float) -> Feed:
    """Feed multiplied by a ratio, in the form in which it is given."""
    if feed.velocity is not None:
        return replace(feed, velocity=feed.velocity * ratio)
    if feed.per_revolution is not None:
        return replace(feed, per_revolution=feed.per_revolution * ratio)
    return replace(feed, ratio=feed.ratio * ratio)


def _feed(job: ToolPathTask, written: Typed | float | None, name: str) -> Feed | None:
    """Feed from an attribute of the strategy, or None if it is not given."""
    if written is None:
        return None
    value = written.value if isinstance(written, Typed) else written
    if not isinstance(value, (int, float)) or not 0.0 < value < 1e6:
        raise strategy_fault(job, "the feed must be positive", name)
    if isinstance(written, Typed) and "REV" in written.keyword.upper():
        return Feed(technology=job.step.technology_ref, per_revolution=float(value))
    return Feed(technology=job.step.technology_ref, velocity=speed_from_m_s(float(value)))
