"""Geometry of ISO 10303-42 as far as ISO 14649 programs use it.

Lengths are in mm; the faces of a solid are kept in the file and not modelled here.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    BSplineCurveForm,
    KnotType,
    Logical,
    TransitionCode,
    TrimmingPreference,
)
from stepnc_model.part21.values import Ref, Typed


class RepresentationItem(Entity, abstract=True):
    """Geometric item, base of all geometry."""

    name: str


class Point(RepresentationItem, abstract=True):
    """Point in space."""


class CartesianPoint(Point):
    """Point given by its coordinates, mm."""

    coordinates: tuple[float, ...]


class Direction(RepresentationItem):
    """Direction given by its ratios; their length has no meaning."""

    direction_ratios: tuple[float, ...]


class Vector(RepresentationItem):
    """Direction with a magnitude."""

    orientation: Ref[Direction]
    magnitude: float


class Placement(RepresentationItem, abstract=True):
    """Position of a coordinate system."""

    location: Ref[CartesianPoint]


class Axis1Placement(Placement):
    """Location and axis; the axis is z unless given."""

    axis: Ref[Direction] | None = None


class Axis2Placement2d(Placement):
    """Coordinate system in the plane."""

    ref_direction: Ref[Direction] | None = None


class Axis2Placement3d(Placement):
    """Coordinate system in space: z along ``axis``, x towards ``ref_direction``."""

    axis: Ref[Direction] | None = None
    ref_direction: Ref[Direction] | None = None


class Curve(RepresentationItem, abstract=True):
    """Curve, a geometric item with one parameter."""


class Line(Curve):
    """Unbounded straight line."""

    pnt: Ref[CartesianPoint]
    dir: Ref[Vector]


class Conic(Curve, abstract=True):
    """Conic section, a plane curve of second order."""

    position: Ref[Axis2Placement2d | Axis2Placement3d]


class Circle(Conic):
    """Full circle about the z axis of its placement."""

    radius: float


class Ellipse(Conic):
    """Full ellipse; the first semi-axis lies along x."""

    semi_axis_1: float
    semi_axis_2: float


class Helix(Curve):
    """Right-hand helix about z.

    Not an entity of ISO 10303-42 but an addition of NIST's ``ex1E.stp``.
    """

    position: Ref[Axis2Placement3d]
    radius: float
    pitch: float


class BoundedCurve(Curve, abstract=True):
    """Curve with two ends."""


class Polyline(BoundedCurve):
    """Polyline of straight segments from point to point."""

    points: tuple[Ref[CartesianPoint], ...]


class TrimmedCurve(BoundedCurve):
    """Part of a curve between two points or two parameters."""

    basis_curve: Ref[Curve]
    trim_1: tuple[Ref[CartesianPoint] | Typed | float, ...]
    trim_2: tuple[Ref[CartesianPoint] | Typed | float, ...]
    sense_agreement: bool
    master_representation: TrimmingPreference


class FoundedItem(Entity, abstract=True):
    """Item that has a meaning only within another item."""


class CompositeCurveSegment(FoundedItem):
    """Curve of a composite curve, with its transition to the next one."""

    transition: TransitionCode
    same_sense: bool
    parent_curve: Ref[Curve]


class CompositeCurve(BoundedCurve):
    """Composite curve, a chain of bounded curves."""

    segments: tuple[Ref[CompositeCurveSegment], ...]
    self_intersect: Logical


class BSplineCurve(BoundedCurve):
    """B-spline curve given by its control points."""

    degree: int
    control_points_list: tuple[Ref[CartesianPoint], ...]
    curve_form: BSplineCurveForm
    closed_curve: Logical
    self_intersect: Logical


class BezierCurve(BSplineCurve):
    """Bezier curve, or several that join: each ends where the next begins."""


class BSplineCurveWithKnots(BSplineCurve):
    """B-spline curve with explicit knots."""

    knot_multiplicities: tuple[int, ...]
    knots: tuple[float, ...]
    knot_spec: KnotType


class RationalBSplineCurveWithKnots(BSplineCurveWithKnots, abstract=True):
    """B-spline curve with weights: a complex instance of two subtypes of a B-spline curve."""

    weights_data: tuple[float, ...]


class Surface(RepresentationItem, abstract=True):
    """Surface, a geometric item with two parameters."""


class ElementarySurface(Surface):
    """Elementary surface; drafts of ISO 14649 use it for a plane."""

    position: Ref[Axis2Placement3d]


class Plane(ElementarySurface):
    """Plane through the origin of its placement, normal to z."""


class CylindricalSurface(ElementarySurface):
    """Unbounded cylindrical surface about z."""

    radius: float


class BoundedSurface(Surface, abstract=True):
    """Surface with a boundary."""


class Block(RepresentationItem):
    """Box from the origin of its placement along the positive axes, mm."""

    position: Ref[Axis2Placement3d]
    x: float
    y: float
    z: float


class RightCircularCylinder(RepresentationItem):
    """Solid cylinder that rises from its placement along the axis, mm."""

    position: Ref[Axis1Placement | Axis2Placement3d]
    height: float
    radius: float


class AdvancedBrepShapeRepresentation(Entity):
    """Solid given by its faces, of which only the references are modelled."""

    name: str
    items: tuple[Ref[Entity], ...]
    context_of_items: Ref[Entity]
