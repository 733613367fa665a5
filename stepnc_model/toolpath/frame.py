"""Coordinate systems and patterns: placements of the file, from a feature to the setup.

ISO 14649-10: a feature is placed on its workpiece or in its compound feature, a workpiece in
its setup. Tool paths are generated in the coordinates of the setup.

A pattern (ISO 14649-10, replicate features) defines the places of its copies. The standard is
interpreted in the same way for all patterns:

* the base feature is placed relative to its pattern and is itself the first copy;
* indices of rows, columns and places on a circle count from 1, the base feature;
* ``number_of_feature`` of a circle counts the copies that exist: a circle has as many
  places as existing and omitted copies together;
* a copy on a circle keeps its orientation, turned by ``base_feature_rotation`` from each
  place to the next;
* ``replicate_locations`` are placements of copies in the coordinates of the pattern; the base
  feature comes before them if its place is different.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from math import cos, dist, hypot, sin, sqrt

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.features import (
    CircularPattern,
    CompoundFeature,
    GeneralPattern,
    RectangularPattern,
    ReplicateFeature,
)
from stepnc_model.entities.geometry import Placement
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.path import Point, cross, dot, plus, times
from stepnc_model.units import rad_from_deg

PARALLEL = 1e-9
"""Sine below which two directions are parallel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """Coordinate system, given by its origin and axes in the surrounding system."""

    origin: Point = (0.0, 0.0, 0.0)
    x: Point = (1.0, 0.0, 0.0)
    y: Point = (0.0, 1.0, 0.0)
    z: Point = (0.0, 0.0, 1.0)

    def point(self, at: Point) -> Point:
        """Convert a point from this frame to the surrounding coordinates."""
        turned = self.direction(at)
        return (
            turned[0] + self.origin[0],
            turned[1] + self.origin[1],
            turned[2] + self.origin[2],
        )

    def direction(self, along: Point) -> Point:
        """Convert a direction from this frame to the surrounding coordinates."""
        a, b, c = along
        return (
            a * self.x[0] + b * self.y[0] + c * self.z[0],
            a * self.x[1] + b * self.y[1] + c * self.z[1],
            a * self.x[2] + b * self.y[2] + c * self.z[2],
        )

    def inner(self, frame: "Frame") -> "Frame":
        """Convert a frame given in this system to the surrounding coordinates."""
        return Frame(
            origin=self.point(frame.origin),
            x=self.direction(frame.x),
            y=self.direction(frame.y),
            z=self.direction(frame.z),
        )

    def inverse(self) -> "Frame":
        """Frame of the surrounding system as seen from within this one."""
        columns = tuple(zip(self.x, self.y, self.z, strict=True))
        back = Frame(x=columns[0], y=columns[1], z=columns[2])
        x, y, z = back.direction(self.origin)
        return Frame(origin=(-x, -y, -z), x=columns[0], y=columns[1], z=columns[2])

    @property
    def is_upright(self) -> bool:
        """True if z points along the surrounding z axis."""
        return abs(self.z[0]) + abs(self.z[1]) < PARALLEL and self.z[2] > 0.0


def frame_of(program: Program, ref: Ref[Entity] | None) -> Frame:
    """Frame of a placement; the identity if there is none.

    Raises
    ------
    PathError
        If its axes are invalid or parallel.
    """
    if ref is None:
        return Frame()
    placement = program.get(ref)
    if not isinstance(placement, Placement):
        raise program.path_error("is not a placement", ref)
    origin = point_of(program, placement.location)
    # A placement in the plane has no axis; a placement on an axis has no reference direction.
    z = _direction(program, ref, getattr(placement, "axis", None)) or (0.0, 0.0, 1.0)
    towards = _direction(program, ref, getattr(placement, "ref_direction", None))
    if towards is None:
        is_along_x = abs(z[1]) + abs(z[2]) < PARALLEL
        towards = (0.0, 1.0, 0.0) if is_along_x else (1.0, 0.0, 0.0)
    across = dot(towards, z)
    x = _unit(tuple(t - across * c for t, c in zip(towards, z, strict=True)))
    if x is None:
        raise program.path_error("the ref_direction is parallel to the axis", ref)
    return Frame(origin=origin, x=x, y=cross(z, x), z=z)


def point_of(program: Program, ref: Ref[Entity]) -> Point:
    """Coordinates of a point; missing ones are 0."""
    coordinates = getattr(program.get(ref), "coordinates", None)
    if coordinates is None:
        raise program.path_error("is not a point", ref)
    x, y, z = (*coordinates, 0.0, 0.0, 0.0)[:3]
    return float(x), float(y), float(z)


def direction_of(program: Program, ref: Ref[Entity]) -> Point:
    """Unit vector of a direction entity."""
    found = _direction(program, ref, ref)
    if found is None:
        raise program.path_error("is not a direction", ref)
    return found


def workpiece_frame(program: Program, setup: Ref[Setup] | None) -> Frame:
    """Frame of the workpiece in its setup."""
    if setup is None:
        return Frame()
    entity = program.get(setup)
    if not isinstance(entity, Setup):
        raise program.path_error("is not a setup, where one is expected", setup)
    placed = entity.its_workpiece_setup
    if not placed:
        return Frame()
    with program.using(setup):
        return frame_of(program, program.get(placed[0]).its_origin)


def compound_of(program: Program, feature: Ref[Entity]) -> Ref[CompoundFeature] | None:
    """Compound feature that has a feature as an element, or None."""
    compounds = program.model.of_type(CompoundFeature)
    return next((ref for ref, compound in compounds if feature in compound.elements), None)


def surrounding_frame(
    program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]
) -> Frame:
    """Frame in which a feature is placed: that of its compound feature, or its workpiece.

    ISO 14649-10: elements of a compound feature are placed relative to it, even if a
    workingstep names an element directly.
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


def _direction(program: Program, at: Ref[Entity], ref: Ref[Entity] | None) -> Point | None:
    """Unit vector of a direction that may be absent."""
    if ref is None:
        return None
    ratios = getattr(program.get(ref), "direction_ratios", None)
    if ratios is None:
        raise program.path_error(f"{ref} is not a direction", at)
    unit = _unit((*map(float, ratios), 0.0, 0.0)[:3])
    if unit is None:
        raise program.path_error("the direction ratios are all 0", ref)
    return unit


def _unit(vector: tuple[float, ...]) -> Point | None:
    """Vector scaled to length 1; None for a zero vector."""
    size = sqrt(sum(part * part for part in vector))
    if not PARALLEL < size < float("inf"):
        return None
    return vector[0] / size, vector[1] / size, vector[2] / size


MAX_COPIES = 10_000
"""Greatest number of copies of a pattern; more indicates an error."""

SAME_PLACE = 1e-6
"""Distance below which two placements are the same copy, mm."""

ON_CIRCLE = 0.01
"""Greatest distance of the base feature from its pattern's circle, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedFeature:
    """Feature that is not a pattern, with its position in the setup."""

    feature: Ref[Entity]
    frame: Frame
    """Frame of the feature, in setup coordinates."""


def placements(
    program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]
) -> Iterator[PlacedFeature]:
    """Places of a feature: its own, or those of all copies of a pattern, in order.

    Parameters
    ----------
    setup : Ref or None
        Setup of the workingstep.
    feature : Ref
        A feature, or a pattern of features or of patterns.

    Yields
    ------
    PlacedFeature
        At most ``MAX_COPIES`` places.

    Raises
    ------
    PathError
        If a pattern contains itself, lacks a size, omits or moves a place that does not exist,
        or has too many copies.
    """
    within = surrounding_frame(program, setup, feature)
    for count, placed in enumerate(_expanded(program, feature, within, ())):
        if count == MAX_COPIES:
            raise program.path_error(f"the pattern has more than {MAX_COPIES} copies", feature)
        yield placed


def _expanded(
    program: Program, feature: Ref[Entity], within: Frame, outer: tuple[Ref[Entity], ...]
) -> Iterator[PlacedFeature]:
    """Copies of a feature that is placed within a frame."""
    if feature in outer:
        raise program.path_error(
            "the pattern contains itself", feature, "replicate_base_feature"
        )
    entity = program.get(feature)
    own = frame_of(program, getattr(entity, "feature_placement", None))
    if not isinstance(entity, ReplicateFeature):
        yield PlacedFeature(feature=feature, frame=within.inner(own))
        return
    pattern = within.inner(own)
    base = entity.replicate_base_feature
    first = frame_of(program, getattr(program.get(base), "feature_placement", None))
    undone = first.inverse()
    with program.using(feature):
        copies = _copies(program, feature, entity, first)
        for copy in copies:
            # The base feature places itself: what remains is the move from it to the copy.
            shifted = pattern.inner(copy.inner(undone))
            yield from _expanded(program, base, shifted, (*outer, feature))


def _copies(
    program: Program, ref: Ref[Entity], pattern: ReplicateFeature, first: Frame
) -> Iterator[Frame]:
    """Frames of the copies in the coordinates of their pattern."""
    if isinstance(pattern, GeneralPattern):
        return _general(program, pattern, first)
    if isinstance(pattern, CircularPattern):
        return _circular(program, ref, pattern, first)
    if isinstance(pattern, RectangularPattern):
        return _rectangular(program, ref, pattern, first)
    raise program.path_error("this kind of pattern is not supported", ref)


def _general(program: Program, pattern: GeneralPattern, first: Frame) -> Iterator[Frame]:
    """Frames of the base feature and the copies of a general pattern, without duplicates."""
    done: list[Frame] = []
    copies = (frame_of(program, each) for each in pattern.replicate_locations)
    for frame in chain((first,), copies):
        if not any(_is_same(frame, other) for other in done):
            done.append(frame)
            yield frame


def _circular(
    program: Program, ref: Ref[Entity], pattern: CircularPattern, first: Frame
) -> Iterator[Frame]:
    """Frames of copies around the z axis of the pattern, counter-clockwise."""
    missing = {program.get(each).index for each in pattern.missing_base_feature}
    places = pattern.number_of_feature + len(missing)
    _check_count(program, ref, places, "number_of_feature")
    offsets = [program.get(each) for each in pattern.relocated_base_feature]
    extra = {each.index: each.angular_offset for each in offsets}
    for index in missing | extra.keys():
        _check_index(program, ref, index, places)
    base = _on_circle(program, ref, pattern, first)
    for index in range(1, places + 1):
        if index not in missing:
            around = (index - 1) * pattern.angle_increment + extra.get(index, 0.0)
            about = (index - 1) * (pattern.base_feature_rotation or 0.0)
            yield _turned(base, around=rad_from_deg(around), about=rad_from_deg(about))


def _on_circle(
    program: Program, ref: Ref[Entity], pattern: CircularPattern, first: Frame
) -> Frame:
    """Base feature on the circle: as placed, or else on the x axis of the pattern."""
    away = hypot(first.origin[0], first.origin[1])
    if pattern.base_feature_diameter is None:
        return first
    radius = 0.5 * program.get(pattern.base_feature_diameter).theoretical_size
    if away < ON_CIRCLE:
        return replace(first, origin=(radius, 0.0, first.origin[2]))
    if abs(away - radius) > ON_CIRCLE:
        message = f"radius {radius:g} mm, but the base feature is {away:g} mm from the centre"
        raise program.path_error(message, ref, "base_feature_diameter")
    return first


def _turned(frame: Frame, *, around: float, about: float) -> Frame:
    """Frame moved around the pattern's z axis, and rotated about its own."""
    return Frame(
        origin=_rotated(frame.origin, around),
        x=_rotated(frame.x, about),
        y=_rotated(frame.y, about),
        z=_rotated(frame.z, about),
    )


def _rectangular(
    program: Program, ref: Ref[Entity], pattern: RectangularPattern, first: Frame
) -> Iterator[Frame]:
    """Frames of copies row by row, each row along its direction."""
    rows = 1 if pattern.number_of_rows is None else pattern.number_of_rows
    columns = pattern.number_of_columns
    _check_count(program, ref, rows, "number_of_rows")
    _check_count(program, ref, columns, "number_of_columns")
    _check_count(program, ref, rows * columns, "number_of_columns")
    along = direction_of(program, pattern.its_direction)
    column_step = times(along, program.get(pattern.spacing).theoretical_size)
    row_step = (0.0, 0.0, 0.0)
    if rows > 1:
        if pattern.row_spacing is None or pattern.row_layout_direction is None:
            raise program.path_error(
                "a pattern with several rows needs a row spacing and direction", ref
            )
        across = direction_of(program, pattern.row_layout_direction)
        row_step = times(across, program.get(pattern.row_spacing).theoretical_size)
    missing = {
        (omit.row_index, omit.column_index)
        for omit in map(program.get, pattern.missing_base_feature)
    }
    extra = {
        (each.row_index, each.column_index): times(
            direction_of(program, each.offset_direction), each.offset_distance
        )
        for each in map(program.get, pattern.relocated_base_feature)
    }
    for row, column in missing | extra.keys():
        _check_index(program, ref, row, rows)
        _check_index(program, ref, column, columns)
    for row in range(1, rows + 1):
        for column in range(1, columns + 1):
            if (row, column) not in missing:
                origin = plus(first.origin, times(row_step, row - 1))
                origin = plus(origin, times(column_step, column - 1))
                origin = plus(origin, extra.get((row, column), (0.0, 0.0, 0.0)))
                yield replace(first, origin=origin)


def _check_count(program: Program, ref: Ref[Entity], count: int, attribute: str) -> None:
    if not 1 <= count <= MAX_COPIES:
        message = f"{count} copies: a pattern must have 1 to {MAX_COPIES}"
        raise program.path_error(message, ref, attribute)


def _check_index(program: Program, ref: Ref[Entity], index: int, count: int) -> None:
    if not 1 <= index <= count:
        message = f"index {index}: the places of this pattern are numbered 1 to {count}"
        raise program.path_error(message, ref)


def _rotated(vector: Point, angle: float) -> Point:
    a, b, c = vector
    return a * cos(angle) - b * sin(angle), a * sin(angle) + b * cos(angle), c


def _is_same(one: Frame, other: Frame) -> bool:
    pairs = ((one.origin, other.origin), (one.x, other.x), (one.z, other.z))
    return all(dist(a, b) < SAME_PLACE for a, b in pairs)
