"""Boundaries and courses of travel of features, measured.

Arcs of composite curves count by their chords here; the tool path, which keeps arcs, replaces
this estimate.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import hypot, pi, sin, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import (
    CartesianPoint,
    CompositeCurve,
    Polyline,
    TrimmedCurve,
)
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    CircularClosedProfile,
    CompleteCircularPath,
    GeneralClosedProfile,
    GeneralPath,
    GeneralProfile,
    LinearPath,
    LinearProfile,
    NgonClosedProfile,
    PartialCircularPath,
    PartialCircularProfile,
    RectangularClosedProfile,
    RoundedUProfile,
    SquareUProfile,
    VeeProfile,
)
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.units import rad_from_deg

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Outline:
    """Area and length of a boundary."""

    area: float
    length: float
    width: float


def size(program: Program, ref: Ref[TolerancedLengthMeasure]) -> float:
    """Theoretical size of a toleranced length, mm."""
    value = float(program.get(ref).theoretical_size)
    if not 0.0 < value < 1e6:
        raise program.error(
            f"size {value:g} mm is not a length of a part", ref, "theoretical_size"
        )
    return value


def closed_outline(program: Program, ref: Ref[Entity]) -> Outline:
    """Outline of a closed profile."""
    profile = program.get(ref)
    if isinstance(profile, RectangularClosedProfile):
        width, length = (
            size(program, profile.profile_width),
            size(program, profile.profile_length),
        )
        return Outline(
            area=width * length, length=2.0 * (width + length), width=min(width, length)
        )
    if isinstance(profile, CircularClosedProfile):
        return circle_outline(size(program, profile.diameter))
    if isinstance(profile, NgonClosedProfile):
        return _ngon(program, profile)
    if isinstance(profile, GeneralClosedProfile):
        return _polygon(list(points_of(program, profile.closed_profile_shape)))
    raise program.error("is no closed profile", ref)


def open_outline(program: Program, ref: Ref[Entity]) -> Outline:
    """Outline of an open profile, closed by the straight line between its ends."""
    profile = program.get(ref)
    if isinstance(profile, GeneralProfile):
        points = list(points_of(program, profile.its_profile))
        closed = _polygon(points)
        gap = hypot(points[0][0] - points[-1][0], points[0][1] - points[-1][1])
        return Outline(area=closed.area, length=closed.length - gap, width=closed.width)
    if isinstance(profile, PartialCircularProfile):
        radius = size(program, profile.radius)
        sweep = rad_from_deg(profile.sweep_angle)
        area = 0.5 * radius**2 * (sweep - sin(sweep))
        return Outline(area=area, length=radius * sweep, width=radius)
    if isinstance(profile, LinearProfile):
        length = parameter(program, profile.profile_length)
        return Outline(area=0.0, length=length, width=length)
    width = swept_width(program, ref, 0.0)
    return Outline(area=0.0, length=width, width=width)


def circle_outline(diameter: float) -> Outline:
    """Outline of a circle."""
    return Outline(area=0.25 * pi * diameter**2, length=pi * diameter, width=diameter)


def _ngon(program: Program, profile: NgonClosedProfile) -> Outline:
    """Regular polygon by its circumscribed circle or its width across flats."""
    sides, half = profile.number_of_sides, 0.5 * size(program, profile.diameter)
    angle = pi / sides
    edge = 2.0 * half * (sin(angle) if profile.circumscribed_or_across_flats else tan(angle))
    inner = 0.5 * edge / tan(angle)
    return Outline(area=0.5 * sides * edge * inner, length=sides * edge, width=2.0 * inner)


def _polygon(points: list[Point]) -> Outline:
    """Area by the shoelace formula, length and narrower extent of a closed polygon."""
    ring = [*points, points[0]]
    twice = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise(ring))
    length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(ring))
    extents = [max(p[axis] for p in points) - min(p[axis] for p in points) for axis in (0, 1)]
    return Outline(area=0.5 * abs(twice), length=length, width=min(extents))


def points_of(program: Program, ref: Ref[Entity]) -> Iterator[Point]:
    """Corner points of a bounded curve, arcs by their ends."""
    curve = program.get(ref)
    if isinstance(curve, Polyline):
        for point in curve.points:
            yield _point(program, point)
    elif isinstance(curve, CompositeCurve):
        for segment in curve.segments:
            yield from points_of(program, program.get(segment).parent_curve)
    elif isinstance(curve, TrimmedCurve):
        for trims in (curve.trim_1, curve.trim_2):
            for trim in trims:
                if isinstance(trim, Ref):
                    yield _point(program, trim)
    else:
        raise program.error("a curve of this kind cannot be measured yet", ref)


def _point(program: Program, ref: Ref[Entity]) -> Point:
    point = program.get(ref)
    if not isinstance(point, CartesianPoint):
        raise program.error("is no point", ref)
    x, y, z = (*point.coordinates, 0.0, 0.0)[:3]
    return float(x), float(y), float(z)


def travel_length(program: Program, ref: Ref[Entity]) -> float:
    """Length of a travel path, mm."""
    path = program.get(ref)
    if isinstance(path, LinearPath):
        return size(program, path.distance)
    if isinstance(path, CompleteCircularPath):
        return 2.0 * pi * size(program, path.radius)
    if isinstance(path, PartialCircularPath):
        return size(program, path.radius) * rad_from_deg(path.sweep_angle)
    if isinstance(path, GeneralPath):
        points = list(points_of(program, path.swept_path))
        return sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(points))
    raise program.error("is no course of travel", ref)


def swept_width(program: Program, ref: Ref[Entity], depth: float) -> float:
    """Width at the top of a slot's profile, mm."""
    profile = program.get(ref)
    if isinstance(profile, (SquareUProfile, RoundedUProfile)):
        return size(program, profile.width)
    if isinstance(profile, VeeProfile):
        return 2.0 * depth * tan(0.5 * vee_angle(profile.profile_angle))
    if isinstance(profile, PartialCircularProfile):
        return 2.0 * size(program, profile.radius)
    if isinstance(profile, GeneralProfile):
        return _polygon(list(points_of(program, profile.its_profile))).width
    raise program.error("its width cannot be told from a profile of this kind", ref)


def vee_angle(written: float) -> float:
    """Included angle in rad; some files write radians, and no vee is as sharp as 3°."""
    return written if written < pi else rad_from_deg(written)


def parameter(program: Program, ref: Ref[NumericParameter]) -> float:
    """Value of a numeric parameter, mm."""
    value = float(program.get(ref).its_parameter_value)
    if value <= 0.0:
        raise program.error(f"{value:g} mm is no length", ref, "its_parameter_value")
    return value
