"""Coordinate systems: placements of the file as rigid motions, from a feature to the setup.

ISO 14649-10: a feature is placed on its workpiece, a workpiece in its setup. Tool paths come
out in the coordinates of the setup.
"""

from dataclasses import dataclass
from math import sqrt

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Axis1Placement, Axis2Placement3d
from stepnc_model.entities.setup import Setup
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.toolpath.path import Point

PARALLEL = 1e-9
"""sine below which two directions are taken as one"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """A coordinate system, by its origin and axes in the system around it."""

    origin: Point = (0.0, 0.0, 0.0)
    x: Point = (1.0, 0.0, 0.0)
    y: Point = (0.0, 1.0, 0.0)
    z: Point = (0.0, 0.0, 1.0)

    def point(self, at: Point) -> Point:
        """A point of this system in the coordinates around it."""
        turned = self.direction(at)
        return (
            turned[0] + self.origin[0],
            turned[1] + self.origin[1],
            turned[2] + self.origin[2],
        )

    def direction(self, along: Point) -> Point:
        """A direction of this system in the coordinates around it."""
        a, b, c = along
        return (
            a * self.x[0] + b * self.y[0] + c * self.z[0],
            a * self.x[1] + b * self.y[1] + c * self.z[1],
            a * self.x[2] + b * self.y[2] + c * self.z[2],
        )

    def inner(self, frame: "Frame") -> "Frame":
        """A frame given in this system, in the coordinates around this one."""
        return Frame(
            origin=self.point(frame.origin),
            x=self.direction(frame.x),
            y=self.direction(frame.y),
            z=self.direction(frame.z),
        )

    @property
    def is_upright(self) -> bool:
        """Whether z points along the z around it."""
        return abs(self.z[0]) + abs(self.z[1]) < PARALLEL and self.z[2] > 0.0


def frame_of(program: Program, ref: Ref[Entity] | None) -> Frame:
    """Frame of a placement; the coordinates around it where there is none.

    Raises
    ------
    PathError
        When its axes are no directions, or parallel.
    """
    if ref is None:
        return Frame()
    placement = program.get(ref)
    if not isinstance(placement, (Axis1Placement, Axis2Placement3d)):
        raise _fault(program, ref, "is no placement in space")
    origin = point_of(program, placement.location)
    z = _direction(program, ref, placement.axis) or (0.0, 0.0, 1.0)
    towards = None
    if isinstance(placement, Axis2Placement3d):
        towards = _direction(program, ref, placement.ref_direction)
    if towards is None:
        is_along_x = abs(z[1]) + abs(z[2]) < PARALLEL
        towards = (0.0, 1.0, 0.0) if is_along_x else (1.0, 0.0, 0.0)
    across = _dot(towards, z)
    x = _unit(tuple(t - across * c for t, c in zip(towards, z, strict=True)))
    if x is None:
        raise _fault(program, ref, "its ref_direction lies along its axis")
    return Frame(origin=origin, x=x, y=_cross(z, x), z=z)


def point_of(program: Program, ref: Ref[Entity]) -> Point:
    """Coordinates of a point, missing ones 0."""
    coordinates = getattr(program.get(ref), "coordinates", None)
    if coordinates is None:
        raise _fault(program, ref, "is no point")
    x, y, z = (*coordinates, 0.0, 0.0, 0.0)[:3]
    return float(x), float(y), float(z)


def direction_of(program: Program, ref: Ref[Entity]) -> Point:
    """Unit vector of a direction."""
    found = _direction(program, ref, ref)
    if found is None:
        raise _fault(program, ref, "is no direction")
    return found


def workpiece_frame(program: Program, setup: Ref[Setup] | None) -> Frame:
    """Frame of the workpiece in its setup."""
    if setup is None:
        return Frame()
    placed = program.get(setup).its_workpiece_setup
    return frame_of(program, program.get(placed[0]).its_origin) if placed else Frame()


def feature_frame(program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]) -> Frame:
    """Frame of a feature in the setup."""
    placement = getattr(program.get(feature), "feature_placement", None)
    return workpiece_frame(program, setup).inner(frame_of(program, placement))


def _fault(program: Program, ref: Ref[Entity], message: str) -> PathError:
    return PathError(message, entity=program.label(ref), line=program.line(ref))


def _direction(program: Program, at: Ref[Entity], ref: Ref[Entity] | None) -> Point | None:
    """Unit vector of a direction that may be absent."""
    if ref is None:
        return None
    ratios = getattr(program.get(ref), "direction_ratios", None)
    if ratios is None:
        raise _fault(program, at, f"{ref} is no direction")
    unit = _unit((*map(float, ratios), 0.0, 0.0)[:3])
    if unit is None:
        raise _fault(program, ref, "its ratios are all 0: it points nowhere")
    return unit


def _unit(vector: tuple[float, ...]) -> Point | None:
    """The vector at length 1, or None when it has none."""
    size = sqrt(sum(part * part for part in vector))
    if not PARALLEL < size < float("inf"):
        return None
    return vector[0] / size, vector[1] / size, vector[2] / size


def _dot(one: Point, other: Point) -> float:
    return sum(a * b for a, b in zip(one, other, strict=True))


def _cross(one: Point, other: Point) -> Point:
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )
