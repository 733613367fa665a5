"""Features of an AP238 file that are placed upside down, read the right way up.

AP238 places a feature and gives the direction of its depth apart from that. Some writers take
one direction for both: the z axis of the placement then points into the material, while the
plane of the depth is still given below the placement. Taken by the word, such a feature opens
away from the tool. Where all of this holds, the z axis is turned; the x axis stays.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import hypot

from stepnc_model.ap238.converted import Converted
from stepnc_model.ap238.following import PathFollower
from stepnc_model.entities.conversion import slots_of
from stepnc_model.errors import Severity
from stepnc_model.part21.values import Real, Ref, Value

PARALLEL = 1e-9
"""Sine below which two directions are parallel."""


def upright(
    converted: list[Converted], follower: PathFollower, *, first: int
) -> list[Converted]:
    """Instances with the axes of upside-down features turned towards the tool, each noted.

    Parameters
    ----------
    converted : list of Converted
        All instances of a program.
    follower : PathFollower
        Collector of the findings.
    first : int
        First number that is free for a new instance.

    Returns
    -------
    list of Converted
    """
    known = {each.number: each for each in converted}
    if any(_sign(known, _of(known, each, "its_origin")) < 0 for each in _setups(converted)):
        return converted
    turned: dict[int, Converted] = {}
    for feature in converted:
        place = _of(known, feature, "feature_placement")
        axis = _of(known, place, "axis")
        if place is None or axis is None or place.number in turned:
            continue
        is_down = _sign(known, place) < 0 and _is_below(known, feature)
        if is_down and follower.is_course(axis.origin):
            number = first + len(turned)
            name, ratios, *_ = (*axis.parameters, None, None)
            up = (name, tuple(Real(-float(each)) for each in _numbers(ratios)))
            turned[number] = replace(axis, number=number, parameters=up)
            turned[place.number] = _with(place, "axis", Ref(number))
            text = (
                "the axis (0, 0, -1) is the direction of the depth and points away from the "
                "tool: read as (0, 0, 1)"
            )
            follower.remark(Severity.WARNING, text, place.origin, "axis")
    changed = [turned.pop(each.number, each) for each in converted]
    return [*changed, *turned.values()]


def _setups(converted: list[Converted]) -> Iterator[Converted]:
    """Placements of workpieces in their setups."""
    return (each for each in converted if each.keyword == "WORKPIECE_SETUP")


def _attributes(each: Converted) -> Mapping[str, Value]:
    """Values of an instance by the names of its attributes."""
    if each.rule is None:
        return {}
    return dict(zip(slots_of(each.rule.entity), each.parameters, strict=False))


def _of(known: dict[int, Converted], each: Converted | None, name: str) -> Converted | None:
    """Instance that an attribute refers to."""
    value = None if each is None else _attributes(each).get(name)
    return known.get(int(value)) if isinstance(value, Ref) else None


def _with(each: Converted, name: str, value: Value) -> Converted:
    """Instance with another value of one attribute."""
    values = {**_attributes(each), name: value}
    return replace(each, parameters=tuple(values.values()))


def _numbers(value: Value) -> tuple[float, ...]:
    """Numbers of a list."""
    items = value if isinstance(value, tuple) else ()
    return tuple(float(each) for each in items if isinstance(each, int | float))


def _sign(known: dict[int, Converted], place: Converted | None) -> int:
    """1 and -1 for a placement whose axis is the z axis or its opposite, else 0."""
    axis = _of(known, place, "axis")
    x, y, z = (*(() if axis is None else _numbers(_ratios(axis))), 0.0, 0.0, 0.0)[:3]
    if axis is None:
        return 1
    if hypot(x, y) > PARALLEL * abs(z):
        return 0
    return 1 if z > 0.0 else -1


def _ratios(axis: Converted) -> Value:
    """Ratios of a direction."""
    return _attributes(axis).get("direction_ratios")


def _is_below(known: dict[int, Converted], feature: Converted) -> bool:
    """Whether the plane of a feature's depth lies below its placement."""
    position = _of(known, _of(known, feature, "depth"), "position")
    point = _of(known, position, "location")
    if point is None:
        return False
    return (*_numbers(_attributes(point).get("coordinates")), 0.0, 0.0, 0.0)[2] < 0.0
