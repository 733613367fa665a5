"""Coordinate systems: placements of the file as rigid motions, from a feature to the setup.

ISO 14649-10: a feature is placed on its workpiece or in its compound feature, a workpiece in
its setup. Tool paths come out in the coordinates of the setup.
"""

from dataclasses import dataclass
from math import sqrt

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import CompoundFeature
from stepnc_model.entities.geometry import Placement
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

    def inverse(self) -> "Frame":
        """The coordinates around this system, seen from within it."""
        columns = tuple(zip(self.x, self.y, self.z, strict=True))
        back = Frame(x=columns[0], y=columns[1], z=columns[2])
        x, y, z = back.direction(self.origin)
        return Frame(origin=(-x, -y, -z), x=columns[0], y=columns[1], z=columns[2])

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
    if not isinstance(placement, Placement):
        raise _fault(program, ref, "is no placement")
    origin = point_of(program, placement.location)
    # A placement in the plane has no axis, one on an axis has no reference direction.
    z = _direction(program, ref, getattr(placement, "axis", None)) or (0.0, 0.0, 1.0)
    towards = _direction(program, ref, getattr(placement, "ref_direction", None))
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
    entity = program.get(setup)
    if not isinstance(entity, Setup):
        raise _fault(program, setup, "stands where a setup belongs")
    placed = entity.its_workpiece_setup
    if not placed:
        return Frame()
    with program.using(setup):
        return frame_of(program, program.get(placed[0]).its_origin)


def compound_of(program: Program, feature: Ref[Entity]) -> Ref[CompoundFeature] | None:
    """Compound feature that a feature is an element of."""
    compounds = program.model.of_type(CompoundFeature)
    return next((ref for ref, compound in compounds if feature in compound.elements), None)


def surrounding_frame(
    program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]
) -> Frame:
    """Frame that a feature is placed in: its compound feature's, else its workpiece's.

    ISO 14649-10: elements of a compound feature are placed relative to it, also when a
    workingstep names an element.
    """
    frame = workpiece_frame(program, setup)
    compound = compound_of(program, feature)
    if compound is None:
        return frame
    return frame.inner(frame_of(program, program.get(compound).feature_placement))


def feature_frame(program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]) -> Frame:
    """Frame of a feature in the setup."""
    placement = getattr(program.get(feature), "feature_placement", None)
    return surrounding_frame(program, setup, feature).inner(frame_of(program, placement))


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
