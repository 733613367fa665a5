"""B-spline curves of a file, also rational ones, and their points.

References
----------
.. [1] L. Piegl, W. Tiller, "The NURBS Book", 2nd ed., Springer 1997, algorithm A2.1 and
   eq. (3.1): points of a B-spline curve by de Boor's recursion; eq. (4.5): rational curves.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import (
    BezierCurve,
    BSplineCurve,
    BSplineCurveWithKnots,
    RationalBSplineCurveWithKnots,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.frame import point_of
from stepnc_model.toolpath.path import Point, times


@dataclass(frozen=True, slots=True, kw_only=True)
class Spline:
    """B-spline curve, given by its degree, knots and control points."""

    degree: int
    knots: tuple[float, ...]
    poles: tuple[Point, ...]
    weights: tuple[float, ...] = ()
    """Weight of each control point, positive; empty: all the same."""

    @property
    def spans(self) -> tuple[float, ...]:
        """Distinct knot values of the curve, from its start to its end."""
        return tuple(sorted(set(self.knots[self.degree : len(self.poles) + 1])))

    def at(self, parameter: float) -> Point:
        """Point of the curve at a parameter value, [1]_."""
        if not self.weights:
            return self._at(self.poles, parameter)
        # [1]_ eq. (4.5): a curve of four dimensions, divided by its last one.
        pairs = list(zip(self.poles, self.weights, strict=True))
        x, y, z = self._at([times(pole, weight) for pole, weight in pairs], parameter)
        weight = self._at([(weight, 0.0, 0.0) for _, weight in pairs], parameter)[0]
        return x / weight, y / weight, z / weight

    def _at(self, poles: Sequence[Point], parameter: float) -> Point:
        """Point of the curve of other control points, without weights."""
        degree = self.degree
        last = len(poles) - 1
        span = min(max(bisect_right(self.knots, parameter) - 1, degree), last)
        points = list(poles[span - degree : span + 1])
        for level in range(1, degree + 1):
            for i in range(degree, level - 1, -1):
                low = self.knots[span - degree + i]
                width = self.knots[span + 1 + i - level] - low
                part = (parameter - low) / width if width > 0.0 else 0.0
                a, b = points[i - 1], points[i]
                points[i] = (
                    a[0] + part * (b[0] - a[0]),
                    a[1] + part * (b[1] - a[1]),
                    a[2] + part * (b[2] - a[2]),
                )
        return points[degree]


def spline_of(program: Program, ref: Ref[Entity]) -> Spline:
    """Read a B-spline curve.

    Raises
    ------
    PathError
        If it is not a B-spline, or its knots and control points do not match.
    """
    curve = program.get(ref)
    if not isinstance(curve, BSplineCurve):
        raise program.path_error("is not a B-spline curve", ref)
    poles = tuple(point_of(program, point) for point in curve.control_points_list)
    degree = curve.degree
    if degree < 1 or len(poles) <= degree:
        raise program.path_error(
            f"degree {degree} does not suit {len(poles)} control points", ref
        )
    knots = _knots(program, ref, curve)
    if any(a > b for a, b in pairwise(knots)):
        raise program.path_error("the knots decrease: each must be at least the previous", ref)
    if len(knots) != len(poles) + degree + 1:
        message = (
            f"{len(knots)} knots do not match {len(poles)} control points of degree {degree}"
        )
        raise program.path_error(message, ref)
    weights = _weights(program, ref, curve)
    return Spline(degree=degree, knots=knots, poles=poles, weights=weights)


def _weights(program: Program, ref: Ref[Entity], curve: BSplineCurve) -> tuple[float, ...]:
    """Weights of a rational curve; empty for one without."""
    if not isinstance(curve, RationalBSplineCurveWithKnots):
        return ()
    weights = tuple(map(float, curve.weights_data))
    if len(weights) != len(curve.control_points_list):
        text = f"{len(weights)} weights for {len(curve.control_points_list)} control points"
        raise program.path_error(text, ref)
    if min(weights) <= 0.0:
        text = f"weight {min(weights):g}: must be positive"
        raise program.path_error(text, ref)
    return weights


def _knots(program: Program, ref: Ref[Entity], curve: BSplineCurve) -> tuple[float, ...]:
    """Knot vector; open and uniform if the curve does not give one, joints of Bezier curves."""
    if isinstance(curve, BSplineCurveWithKnots):
        if len(curve.knots) != len(curve.knot_multiplicities):
            counts = (
                f"{len(curve.knots)} knots but {len(curve.knot_multiplicities)} multiplicities"
            )
            raise program.path_error(counts, ref)
        for count in curve.knot_multiplicities:
            if not 1 <= count <= curve.degree + 1:
                message = (
                    f"multiplicity {count}: must be 1 to {curve.degree + 1} for this degree"
                )
                raise program.path_error(message, ref)
        return tuple(
            float(knot)
            for knot, count in zip(curve.knots, curve.knot_multiplicities, strict=True)
            for _ in range(count)
        )
    count, degree = len(curve.control_points_list), curve.degree
    if isinstance(curve, BezierCurve):
        if (count - 1) % degree:
            text = f"{count} control points are not those of Bezier curves of degree {degree}"
            raise program.path_error(text, ref)
        pieces = (count - 1) // degree
        joints = tuple(float(piece) for piece in range(1, pieces) for _ in range(degree))
        return (0.0,) * (degree + 1) + joints + (float(pieces),) * (degree + 1)
    inner = tuple(float(index) for index in range(1, count - degree))
    return (0.0,) * (degree + 1) + inner + (float(count - degree),) * (degree + 1)
