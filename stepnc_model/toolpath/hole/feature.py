"""Holes of a workingstep: where they stand, how wide and how deep the file says they are.

Round holes, the elements of counterbored and countersunk holes, patterns of them, and other
features whose placement and depth plane make them a place to drill (ISO 14649-10).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, pi, tan

from stepnc_model.entities.bottoms import ThroughBottomCondition, ThroughPocketBottomCondition
from stepnc_model.entities.drilling import (
    CenterDrilling,
    CounterSinking,
    DrillingTypeOperation,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import CompoundFeature, RoundHole
from stepnc_model.entities.geometry import CartesianPoint
from stepnc_model.entities.measures import PlusMinusValue
from stepnc_model.entities.profiles import AngleTaper
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.frame import (
    Frame,
    compound_of,
    frame_of,
    point_of,
    surrounding_frame,
)
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import Point
from stepnc_model.toolpath.pattern import Placed, placements
from stepnc_model.units import rad_from_deg

SINK_TOOLS = ("COUNTERSINK", "COUNTERBORE", "BACKSIDE_COUNTERSINK", "BACKSIDE_COUNTERBORE")
"""tools that make the wide part of a compound hole"""

DEFAULT_TOLERANCE = 0.01
"""mm by which a tool may be wider than a hole that names no tolerance"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """One hole in the coordinates of the setup; lengths in mm."""

    ref: Ref[Entity]
    """the round hole, or the feature that is drilled into"""
    frame: Frame
    """of the feature that the workingstep names"""
    top: Point
    """centre where its depth counts from"""
    entry_z: float
    """where a tool meets the part: the top of the compound feature that it belongs to"""
    depth: float | None
    """of its cylindrical part, below the top; None where the file gives none"""
    diameter: float | None
    """at the top; None for a feature that is no round hole"""
    narrowest: float | None
    """diameter of a taper's narrow end"""
    tolerance: float
    """by which it may be wider"""
    bottom: Entity | None

    @property
    def is_tapered(self) -> bool:
        """Whether it narrows."""
        return self.narrowest != self.diameter

    @property
    def is_through(self) -> bool:
        """Whether it has no bottom."""
        return isinstance(self.bottom, (ThroughBottomCondition, ThroughPocketBottomCondition))

    def at(self, z: float) -> Point:
        """Point on its axis."""
        return self.top[0], self.top[1], z

    def point(self, job: Job, ref: Ref[CartesianPoint]) -> Point:
        """A point given in the coordinates of the feature."""
        return self.frame.point(point_of(job.program, ref))


def holes_of(job: Job, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes that an operation makes, in the order of the file.

    Raises
    ------
    PathError
        When there is none, its axis does not lie along the tool, or it lacks a size.
    """
    if not job.step.features:
        raise job.fault("has no feature: nothing tells where to drill", job.step.ref)
    for feature in job.step.features:
        for placed in placements(job.program, job.step.setup, feature):
            yield _hole(job, operation, placed)


def _hole(job: Job, operation: DrillingTypeOperation, placed: Placed) -> Hole:
    """One hole, or the element of a compound feature that is meant."""
    frame = placed.frame
    if not frame.is_upright:
        along = ", ".join(f"{part:.4g}" for part in frame.z)
        message = (
            f"its axis ({along}) does not lie along the tool: a setup of its own is needed"
        )
        raise job.fault(message, placed.feature)
    with job.program.using(placed.feature):
        compound = job.program.get(placed.feature)
        if not isinstance(compound, CompoundFeature):
            return _sized(job, placed.feature, placed, frame, entry_z=_entry(job, placed))
        element = _element(job, operation, placed.feature, compound.elements)
        placement = getattr(job.program.get(element), "feature_placement", None)
        inner = frame.inner(frame_of(job.program, placement))
        if not inner.is_upright:
            raise job.fault("its axis does not lie along the tool", element)
        return _sized(job, element, placed, inner, entry_z=frame.origin[2])


def _entry(job: Job, placed: Placed) -> float:
    """Height of the compound feature around a feature that is named by itself."""
    own = placed.frame.origin[2]
    if compound_of(job.program, placed.feature) is None:
        return own
    around: Frame = surrounding_frame(job.program, job.step.setup, placed.feature)
    return max(own, around.origin[2])


def _element(
    job: Job,
    operation: DrillingTypeOperation,
    ref: Ref[Entity],
    elements: Sequence[Ref[Entity]],
) -> Ref[Entity]:
    """Round hole of a compound feature that the operation and its tool make.

    A countersink or counterbore makes the tapered element, else the widest; a centre drill
    the uppermost; any other tool the narrowest that it fits into, else the widest.
    """
    holes = ((each, job.program.get(each)) for each in elements)
    widths = {
        each: size_of(job, each, hole) for each, hole in holes if isinstance(hole, RoundHole)
    }
    if not widths:
        raise job.fault("has no round hole among its elements", ref, "elements")
    if isinstance(operation, CenterDrilling):
        return max(widths, key=lambda each: _height(job, each))
    if isinstance(operation, CounterSinking) or job.tool.keyword in SINK_TOOLS:
        return max(widths, key=lambda each: (_has_taper(job, each), widths[each]))
    fitting = {each: width for each, width in widths.items() if _fits(job, width)}
    if not fitting:
        return max(widths, key=widths.__getitem__)
    return min(fitting, key=fitting.__getitem__)


def _fits(job: Job, width: float) -> bool:
    return job.tool.diameter <= width + DEFAULT_TOLERANCE


def _height(job: Job, element: Ref[Entity]) -> float:
    placement = getattr(job.program.get(element), "feature_placement", None)
    return frame_of(job.program, placement).origin[2]


def _has_taper(job: Job, element: Ref[Entity]) -> bool:
    return getattr(job.program.get(element), "change_in_diameter", None) is not None


def _sized(job: Job, ref: Ref[Entity], placed: Placed, own: Frame, *, entry_z: float) -> Hole:
    """A hole with its sizes; its depth counts from the top of the feature that is named."""
    entity = job.program.get(ref)
    depth = feature_depth(job, ref)
    diameter = narrowest = None
    if isinstance(entity, RoundHole):
        diameter = size_of(job, ref, entity)
        narrowest = narrowest_of(job, entity, diameter, depth)
    x, y, z = own.origin
    top_z = placed.frame.origin[2]
    bottom = getattr(entity, "bottom_condition", None)
    return Hole(
        ref=ref,
        frame=placed.frame,
        top=(x, y, top_z),
        entry_z=entry_z,
        depth=None if depth is None else depth + top_z - z,
        diameter=diameter,
        narrowest=narrowest,
        tolerance=tolerance_of(job, entity),
        bottom=job.program.get(bottom) if bottom is not None else None,
    )


def feature_depth(job: Job, ref: Ref[Entity]) -> float | None:
    """Depth of a feature: where its depth plane lies in its own coordinates.

    Files write the plane below the placement, at a negative z; the positive depth of an older
    draft means the same.
    """
    plane = getattr(job.program.get(ref), "depth", None)
    if plane is None:
        return None
    position = frame_of(job.program, job.program.get(plane).position)
    depth = abs(position.origin[2])
    if not 0.0 < depth < inf:
        raise job.fault(
            f"depth {depth:g} mm removes nothing: it must be positive", ref, "depth"
        )
    return depth


def size_of(job: Job, ref: Ref[Entity], hole: RoundHole) -> float:
    """Diameter at the top."""
    diameter = float(job.program.get(hole.diameter).theoretical_size)
    if not 0.0 < diameter < inf:
        raise job.fault(f"{diameter:g} mm: it must be positive", ref, "diameter")
    return diameter


def narrowest_of(job: Job, hole: RoundHole, diameter: float, depth: float | None) -> float:
    """Diameter at the depth plane of a tapered hole; its own where it does not narrow."""
    if hole.change_in_diameter is None:
        return diameter
    taper = job.program.get(hole.change_in_diameter)
    if isinstance(taper, AngleTaper):
        half = rad_from_deg(taper.angle)
        end = diameter - 2.0 * (depth or 0.0) * tan(half if 0.0 < half < 0.5 * pi else 0.0)
    else:
        end = float(job.program.get(taper.final_diameter).theoretical_size)
    return min(diameter, max(0.0, end))


def tolerance_of(job: Job, entity: Entity) -> float:
    """Upper limit of a hole's diameter."""
    if isinstance(entity, RoundHole):
        given = job.program.get(entity.diameter).implicit_tolerance
        limits = job.program.get(given) if given is not None else None
        if isinstance(limits, PlusMinusValue):
            return max(DEFAULT_TOLERANCE, limits.upper_limit)
    return DEFAULT_TOLERANCE
