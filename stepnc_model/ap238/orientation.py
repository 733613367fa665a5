"""Features of an AP238 file that are placed upside down, read the right way up.

AP238 places a feature and gives the direction of its depth apart from that. Some writers take
one direction for both: the z axis of the placement then points into the material, while the
plane of the depth is still given below the placement. Taken by the word, such a feature opens
away from the tool. Where all of this holds, the z axis is turned; the x axis stays.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import hypot

from stepnc_model.ap238.reference_paths import PathFollower
from stepnc_model.ap238.table import ConvertedText
from stepnc_model.entities.conversion import slots_of
from stepnc_model.errors import Severity
from stepnc_model.part21.values import Real, Ref, Value

PARALLEL = 1e-9
"""Sine below which two directions are parallel."""


def upright(
    converted: list[ConvertedText], follower: PathFollower, *, first: int
) -> list[ConvertedText]:
    """Instances with the axes of upside-down features turned towards the tool, each noted.

    Parameters
    ----------
    converted : list of ConvertedText
        All instances of a program.
    follower : PathFollower
        Collector of the findings.
    first : int
        First number that is free for a new instance.

    Returns
    -------
    list of ConvertedText
    """
    known = {each.instance.number: each for each in converted}
    if any(_sign(known, _of(known, each, "its_origin")) < 0 for each in _setups(converted)):
        return converted
    turned: dict[int, ConvertedText] = {}
    for feature in converted:
        place = _of(known, feature, "feature_placement")
        axis = _of(known, place, "axis")
        if place is None or axis is None or place.instance.number in turned:
            continue
        is_down = _sign(known, place) < 0 and _is_below(known, feature)
        if is_down and follower.is_course(axis.instance.origin):
            number = first + len(turned)
            up = tuple(Real(-each) for each in _numbers(_ratios(axis)))
            other = _with(axis, "direction_ratios", up)
            instance = replace(axis.instance, number=number)
            turned[number] = replace(other, instance=instance)
            turned[place.instance.number] = _with(place, "axis", Ref(number))
            text = (
                "the axis (0, 0, -1) is the direction of the depth and points away from the "
                "tool: read as (0, 0, 1)"
            )
            follower.remark(Severity.WARNING, text, place.instance.origin, "axis")
    changed = [turned.pop(each.instance.number, each) for each in converted]
    return [*changed, *turned.values()]


def _setups(converted: list[ConvertedText]) -> Iterator[ConvertedText]:
    """Placements of workpieces in their setups."""
    return (each for each in converted if each.instance.keyword == "WORKPIECE_SETUP")


def _of(
    known: dict[int, ConvertedText], each: ConvertedText | None, name: str
) -> ConvertedText | None:
    """Instance that an attribute refers to."""
    rule = None if each is None else each.instance.rule
    if each is None or rule is None or name not in slots_of(rule.entity):
        return None
    value = each.values.get(name)
    return known.get(int(value)) if isinstance(value, Ref) else None


def _with(each: ConvertedText, name: str, value: Value) -> ConvertedText:
    """Instance with another value of one attribute."""
    values = {**each.values, name: value}
    return ConvertedText.of(each.instance, tuple(values.values()))


def _numbers(value: Value) -> tuple[float, ...]:
    """Numbers of a list."""
    items = value if isinstance(value, tuple) else ()
    return tuple(float(each) for each in items if isinstance(each, int | float))


def _sign(known: dict[int, ConvertedText], place: ConvertedText | None) -> int:
    """1 and -1 for a placement whose axis is the z axis or its opposite, else 0."""
    axis = _of(known, place, "axis")
    x, y, z = (*(() if axis is None else _numbers(_ratios(axis))), 0.0, 0.0, 0.0)[:3]
    if axis is None:
        return 1
    if hypot(x, y) > PARALLEL * abs(z):
        return 0
    return 1 if z > 0.0 else -1


def _ratios(axis: ConvertedText) -> Value:
    """Ratios of a direction."""
    return axis.values.get("direction_ratios")


def _is_below(known: dict[int, ConvertedText], feature: ConvertedText) -> bool:
    """True if the plane of a feature's depth lies below its placement."""
    position = _of(known, _of(known, feature, "depth"), "position")
    point = _of(known, position, "location")
    if point is None:
        return False
    return (*_numbers(point.values.get("coordinates")), 0.0, 0.0, 0.0)[2] < 0.0
