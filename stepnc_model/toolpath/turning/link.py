"""What a strategy says about the way from one pass to the next: lift, back path, step over.

Directions that contradict each other are left out, and a finding says so; what is left out or
not given takes the customary way.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.turning_strategies import ContourTurning
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.piece import Spot
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.stock import operation_of

DEFAULT_LIFT = 1.0
"""mm off the surface after a pass where the strategy gives none; customary"""

ALONG = 1e-6
"""sine between two directions that are one"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """Unit vectors of the ways between passes."""

    ref: Ref[Entity]
    """where it is written"""
    ahead: Spot = (-1.0, 0.0)
    """sense of the first pass"""
    lift: Spot | None = None
    """None: out and back, at 45°"""
    lift_height: float = DEFAULT_LIFT
    """mm"""
    back: Spot | None = None
    """None with the step over: as short as the room allows, along the axes"""
    stepover: Spot | None = None
    is_stepover_fed: bool = False
    """the strategy gives a feed for the step over; else it is a rapid where there is room"""
    findings: tuple[Finding, ...] = ()


def link_of(job: Job, plane: HalfPlane) -> Link:
    """The ways between passes, as far as they make sense.

    Raises
    ------
    PathError
        When the height of the lift is negative.
    """
    ref = operation_of(job).its_machining_strategy
    if ref is None:
        return Link(ref=job.step.operation_ref)
    strategy = job.program.get(ref)
    written = {
        name: direction_in(job, plane, getattr(strategy, name, None)) for name in DIRECTIONS
    }
    feed = written["feed_direction"]
    ahead = (1.0, 0.0) if feed is not None and feed[0] > abs(feed[1]) else (-1.0, 0.0)
    height = getattr(strategy, "lift_height", None)
    if height is not None and not 0.0 <= height < 1e4:
        raise job.fault(f"{height:g} mm is no such length", ref, "lift_height")
    faults = dict(_faults(job, strategy, written, ahead))
    good = {name: None if name in faults else at for name, at in written.items()}
    back, stepover = good["back_path_direction"], good["stepover_direction"]
    if back is None and stepover is not None and hasattr(strategy, "back_path_direction"):
        back = (-ahead[0], -ahead[1])
    return Link(
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


def _faults(
    job: Job, strategy: Entity, written: dict[str, Spot | None], ahead: Spot
) -> Iterator[tuple[str, str]]:
    """Attributes whose directions make no sense, with what is wrong and what is done."""
    for name, at in written.items():
        if at is None and getattr(strategy, name, None) is not None:
            yield name, "no direction in the plane of the lathe: the customary one is taken"
    feed, lift, back, stepover = (written[name] for name in DIRECTIONS)
    if feed is not None and not isinstance(strategy, ContourTurning):
        if abs(feed[1]) > abs(feed[0]):
            yield "feed_direction", "a face is cut across the spindle axis, not along it"
        elif abs(feed[1]) > ALONG:
            yield "feed_direction", "oblique: the passes run along its greater part"
    if lift is not None and lift[1] <= ALONG:
        text = "leads into the part" if lift[1] < -ALONG else "does not leave the surface"
        yield "lift_direction", f"the lift {text}: the tool lifts out and back"
    if back is not None and back[0] * ahead[0] > -ALONG:
        yield "back_path_direction", "does not lead back: the customary way is taken"
    if stepover is not None and stepover[1] >= -ALONG:
        text = "leads along the feed" if abs(stepover[1]) <= ALONG else "leads off the part"
        yield "stepover_direction", f"the step over {text}: straight to the part is taken"
