"""Patterns of features as the places of their copies (ISO 14649-10, replicate features).

How the standard is read here, the same for all patterns:

* the base feature is placed relative to its pattern, and is itself the first copy;
* indices of rows, columns and places on a circle count from 1, the base feature;
* ``number_of_feature`` of a circle counts the copies that are there: a circle has as many
  places as copies and omitted ones together;
* a copy on a circle keeps its orientation, turned by ``base_feature_rotation`` from each
  place to the next;
* ``replicate_locations`` are placements of copies in the coordinates of the pattern; the base
  feature at a place of its own comes before them.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from math import cos, dist, hypot, sin

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    CircularPattern,
    GeneralPattern,
    RectangularPattern,
    ReplicateFeature,
)
from stepnc_model.entities.setup import Setup
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.toolpath.frame import Frame, direction_of, frame_of, surrounding_frame
from stepnc_model.toolpath.path import Point
from stepnc_model.units import rad_from_deg

MAX_COPIES = 10_000
"""features of one pattern; more is a trap"""

SAME_PLACE = 1e-6
"""mm between two placements of one and the same copy"""

ON_CIRCLE = 0.01
"""mm by which the base feature may lie beside the circle that its pattern names"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Placed:
    """A feature that is no pattern, where it stands."""

    feature: Ref[Entity]
    frame: Frame
    """its own, in the coordinates of the setup"""


def placements(
    program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]
) -> Iterator[Placed]:
    """Places of a feature: its own, or those of all copies of a pattern, in order.

    Parameters
    ----------
    program : Program
    setup : Ref or None
        Setup of the workingstep.
    feature : Ref
        A feature, or a pattern of features or of patterns.

    Yields
    ------
    Placed
        At most ``MAX_COPIES`` of them.

    Raises
    ------
    PathError
        When a pattern contains itself, lacks a size, has no such place as it omits or moves,
        or has too many copies.
    """
    within = surrounding_frame(program, setup, feature)
    for count, placed in enumerate(_expanded(program, feature, within, ())):
        if count == MAX_COPIES:
            raise _fault(program, feature, f"more than {MAX_COPIES} copies")
        yield placed


def _expanded(
    program: Program, feature: Ref[Entity], within: Frame, outer: tuple[Ref[Entity], ...]
) -> Iterator[Placed]:
    """Copies of a feature that is placed within a frame."""
    if feature in outer:
        raise _fault(program, feature, "contains itself", "replicate_base_feature")
    entity = program.get(feature)
    own = frame_of(program, getattr(entity, "feature_placement", None))
    if not isinstance(entity, ReplicateFeature):
        yield Placed(feature=feature, frame=within.inner(own))
        return
    pattern = within.inner(own)
    base = entity.replicate_base_feature
    first = frame_of(program, getattr(program.get(base), "feature_placement", None))
    undone = _inverse(first)
    with program.using(feature):
        copies = _copies(program, feature, entity, first)
        for copy in copies:
            # The base places itself: what is left is the way from it to the copy.
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
    raise _fault(program, ref, "a pattern of this kind cannot be laid out")


def _general(program: Program, pattern: GeneralPattern, first: Frame) -> Iterator[Frame]:
    """Base feature and copies, each once."""
    done: list[Frame] = []
    copies = (frame_of(program, each) for each in pattern.replicate_locations)
    for frame in chain((first,), copies):
        if not any(_is_same(frame, other) for other in done):
            done.append(frame)
            yield frame


def _circular(
    program: Program, ref: Ref[Entity], pattern: CircularPattern, first: Frame
) -> Iterator[Frame]:
    """Copies about the z axis of the pattern, counter-clockwise."""
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
    """Base feature on the circle: where it is placed, else on the x axis of the pattern."""
    away = hypot(first.origin[0], first.origin[1])
    if pattern.base_feature_diameter is None:
        return first
    radius = 0.5 * program.get(pattern.base_feature_diameter).theoretical_size
    if away < ON_CIRCLE:
        return replace(first, origin=(radius, 0.0, first.origin[2]))
    if abs(away - radius) > ON_CIRCLE:
        message = f"radius {radius:g} mm, but the base feature lies {away:g} mm from the centre"
        raise _fault(program, ref, message, "base_feature_diameter")
    return first


def _turned(frame: Frame, *, around: float, about: float) -> Frame:
    """A frame moved around the z axis, and turned about its own."""
    return Frame(
        origin=_rotated(frame.origin, around),
        x=_rotated(frame.x, about),
        y=_rotated(frame.y, about),
        z=_rotated(frame.z, about),
    )


def _rectangular(
    program: Program, ref: Ref[Entity], pattern: RectangularPattern, first: Frame
) -> Iterator[Frame]:
    """Copies row by row, each row along its direction."""
    rows = 1 if pattern.number_of_rows is None else pattern.number_of_rows
    columns = pattern.number_of_columns
    _check_count(program, ref, rows, "number_of_rows")
    _check_count(program, ref, columns, "number_of_columns")
    _check_count(program, ref, rows * columns, "number_of_columns")
    along = direction_of(program, pattern.its_direction)
    column_step = _times(along, program.get(pattern.spacing).theoretical_size)
    row_step = (0.0, 0.0, 0.0)
    if rows > 1:
        if pattern.row_spacing is None or pattern.row_layout_direction is None:
            raise _fault(program, ref, "several rows need a spacing and a direction")
        across = direction_of(program, pattern.row_layout_direction)
        row_step = _times(across, program.get(pattern.row_spacing).theoretical_size)
    missing = {
        (omit.row_index, omit.column_index)
        for omit in map(program.get, pattern.missing_base_feature)
    }
    extra = {
        (each.row_index, each.column_index): _times(
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
                origin = _plus(first.origin, _times(row_step, row - 1))
                origin = _plus(origin, _times(column_step, column - 1))
                origin = _plus(origin, extra.get((row, column), (0.0, 0.0, 0.0)))
                yield replace(first, origin=origin)


def _check_count(program: Program, ref: Ref[Entity], count: int, attribute: str) -> None:
    if not 1 <= count <= MAX_COPIES:
        message = f"{count} copies: a pattern has 1 to {MAX_COPIES}"
        raise _fault(program, ref, message, attribute)


def _check_index(program: Program, ref: Ref[Entity], index: int, count: int) -> None:
    if not 1 <= index <= count:
        message = f"index {index}: the places of this pattern count from 1 to {count}"
        raise _fault(program, ref, message)


def _inverse(frame: Frame) -> Frame:
    """Frame of the coordinates around a frame, in the frame's own."""
    columns = tuple(zip(frame.x, frame.y, frame.z, strict=True))
    turned = Frame(x=columns[0], y=columns[1], z=columns[2])
    return replace(turned, origin=_times(turned.direction(frame.origin), -1.0))


def _rotated(vector: Point, angle: float) -> Point:
    a, b, c = vector
    return a * cos(angle) - b * sin(angle), a * sin(angle) + b * cos(angle), c


def _times(vector: Point, factor: float) -> Point:
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def _plus(one: Point, other: Point) -> Point:
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def _is_same(one: Frame, other: Frame) -> bool:
    pairs = ((one.origin, other.origin), (one.x, other.x), (one.z, other.z))
    return all(dist(a, b) < SAME_PLACE for a, b in pairs)


def _fault(program: Program, ref: Ref[Entity], message: str, attribute: str = "") -> PathError:
    return PathError(
        message, entity=program.label(ref), attribute=attribute, line=program.line(ref)
    )
