"""B-spline curves of the file, by their parameter.

References
----------
.. [1] L. Piegl, W. Tiller, "The NURBS Book", 2nd ed., Springer 1997, algorithm A2.1 and
   eq. (3.1): points of a B-spline curve by de Boor's recursion.
"""

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import BSplineCurve, BSplineCurveWithKnots
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.toolpath.frame import point_of
from stepnc_model.toolpath.path import Point


@dataclass(frozen=True, slots=True, kw_only=True)
class Spline:
    """A curve by its degree, knots and control points."""

    degree: int
    knots: tuple[float, ...]
    poles: tuple[Point, ...]

    @property
    def spans(self) -> tuple[float, ...]:
        """Parameters where its polynomials meet, from its start to its end."""
        return tuple(sorted(set(self.knots[self.degree : len(self.poles) + 1])))

    def at(self, parameter: float) -> Point:
        """Point at a parameter, [1]_."""
        degree = self.degree
        last = len(self.poles) - 1
        span = min(max(bisect_right(self.knots, parameter) - 1, degree), last)
        points = list(self.poles[span - degree : span + 1])
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
    """B-spline behind a reference.

    Raises
    ------
    PathError
        When it is none, or its knots and control points do not fit together.
    """
    curve = program.get(ref)
    if not isinstance(curve, BSplineCurve):
        raise _fault(program, ref, "is no B-spline curve")
    poles = tuple(point_of(program, point) for point in curve.control_points_list)
    degree = curve.degree
    if degree < 1 or len(poles) <= degree:
        raise _fault(program, ref, f"degree {degree} with {len(poles)} control points")
    knots = _knots(program, ref, curve)
    if any(a > b for a, b in pairwise(knots)):
        raise _fault(program, ref, "its knots fall: each must be at least the one before")
    if len(knots) != len(poles) + degree + 1:
        message = f"{len(knots)} knots for {len(poles)} control points of degree {degree}"
        raise _fault(program, ref, message)
    return Spline(degree=degree, knots=knots, poles=poles)


def _knots(program: Program, ref: Ref[Entity], curve: BSplineCurve) -> tuple[float, ...]:
    """Knot vector; open and uniform where the curve spells none out."""
    if isinstance(curve, BSplineCurveWithKnots):
        if len(curve.knots) != len(curve.knot_multiplicities):
            counts = (
                f"{len(curve.knots)} knots, {len(curve.knot_multiplicities)} multiplicities"
            )
            raise _fault(program, ref, counts)
        for times in curve.knot_multiplicities:
            if not 1 <= times <= curve.degree + 1:
                message = f"multiplicity {times}: 1 to {curve.degree + 1} for its degree"
                raise _fault(program, ref, message)
        return tuple(
            float(knot)
            for knot, times in zip(curve.knots, curve.knot_multiplicities, strict=True)
            for _ in range(times)
        )
    count, degree = len(curve.control_points_list), curve.degree
    inner = tuple(float(index) for index in range(1, count - degree))
    return (0.0,) * (degree + 1) + inner + (float(count - degree),) * (degree + 1)


def _fault(program: Program, ref: Ref[Entity], message: str) -> PathError:
    return PathError(message, entity=program.label(ref), line=program.line(ref))
