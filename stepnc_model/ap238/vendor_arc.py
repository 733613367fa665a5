"""Arcs that a writer describes beside the standard, read as the curves of their tool paths.

The AP238 files of a CAM post give straight tool paths as polylines, and an arc or helix as a
text of JSON in a property of the tool path, which then has no curve:
``{"start": [x, y, z], "end": [x, y, z], "center": [x, y, z], "plane": "XY", "clockwise": true,
"sweepRadians": a, "axialRise": h}``, in the units of the file's geometry.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, isfinite, pi, sin
from typing import Any

from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.reference_paths import PathFollower
from stepnc_model.ap238.table import Converted, ConvertedText
from stepnc_model.errors import Severity
from stepnc_model.part21.values import Enumeration, Real, Ref, Value

PROPERTY = "next-nc circular motion"

TRAJECTORY = "CUTTER_LOCATION_TRAJECTORY"

Point = tuple[float, float, float]

PLANES = {"XY": (0, 1, 2), "YZ": (1, 2, 0), "ZX": (2, 0, 1), "XZ": (2, 0, 1)}
"""Axes of each plane, and the axis across it."""

CHORD = 0.02
"""Angle of a chord of a helix, rad: 5 µm beside an arc of 100 mm radius."""

MOST_SWEEP = 1000.0 * pi
"""Greatest angle of a helix that is read, rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VendorArc:
    """Arc or helix about an axis of its plane."""

    start: Point
    end: Point
    centre: Point
    axes: tuple[int, int, int]
    """Axes of its plane, and the one across."""
    is_clockwise: bool
    sweep: float
    """Angle, rad; positive."""
    rise: float
    """Distance along the axis, in the units of the file."""


def with_vendor_arcs(
    converted: list[ConvertedText],
    instances: Instances,
    follower: PathFollower,
    scale: Callable[[int | None], float],
) -> tuple[list[ConvertedText], set[int]]:
    """Instances with the curves of tool paths that only a vendor's property describes.

    Parameters
    ----------
    converted : list of ConvertedText
        All instances of a program.
    instances : Instances
        Instances of the AP238 file.
    follower : PathFollower
        Collector of the findings.
    scale : callable
        Gives the length of one unit in a representation context, mm.

    Returns
    -------
    list of ConvertedText, set of int
        The instances, and the properties that were read.
    """
    arcs = {
        owner: (id, text)
        for id in instances.of_entity("ACTION_PROPERTY")
        if instances.value(id, "name") == PROPERTY
        and (owner := _number(instances.value(id, "definition"))) is not None
        and (text := _text(instances, id)) is not None
    }
    if not arcs:
        return converted, set()
    # The text names no unit: that of the other curves counts.
    contexts = [each.instance.context for each in converted if each.instance.context]
    unit = scale(contexts[0] if contexts else None)
    first = max(each.instance.number for each in converted) + 1
    kept: list[ConvertedText] = []
    added: list[ConvertedText] = []
    read: set[int] = set()
    for each in converted:
        place = arcs.get(each.instance.origin) if each.instance.keyword == TRAJECTORY else None
        if place is None or each.values.get("basiccurve") is not None:
            kept.append(each)
            continue
        property, text = place
        arc = vendor_arc(text)
        if arc is None:
            message = f"{PROPERTY!r} does not describe an arc in a principal plane"
            follower.remark(Severity.WARNING, message, property, "name")
            kept.append(each)
            continue
        curve = list(_curve(arc, property, first + len(added), unit))
        added += curve
        read.add(property)
        values = {**each.values, "basiccurve": Ref(curve[-1].instance.number)}
        kept.append(ConvertedText.of(each.instance, tuple(values.values())))
        follower.remark(
            Severity.NOTE, f"the curve is read from {PROPERTY!r}", each.instance.origin, ""
        )
    return [*kept, *added], read


def vendor_arc(text: str) -> VendorArc | None:
    """Arc of a text of JSON; None if it is not valid.

    Examples
    --------
    >>> arc = vendor_arc('{"start": [0, 0, 0], "end": [0, 2, 0], "center": [0, 1, 0], '
    ...     '"plane": "XY", "clockwise": true, "sweepRadians": 3.14159, "axialRise": 0}')
    >>> arc.is_clockwise, arc.axes
    (True, (0, 1, 2))
    """
    try:
        given: Any = json.loads(text)
        arc = VendorArc(
            start=_point(given["start"]),
            end=_point(given["end"]),
            centre=_point(given["center"]),
            axes=PLANES[str(given["plane"]).upper()],
            is_clockwise=given["clockwise"] is True,
            sweep=abs(float(given["sweepRadians"])),
            rise=float(given.get("axialRise", 0.0)),
        )
    except (AttributeError, KeyError, TypeError, ValueError, RecursionError):
        return None
    numbers = (*arc.start, *arc.end, *arc.centre, arc.rise)
    is_valid = all(map(isfinite, numbers)) and 0.0 < arc.sweep <= MOST_SWEEP
    return arc if is_valid else None


def _point(given: Any) -> Point:
    x, y, z = map(float, given)
    return x, y, z


def _number(value: Value) -> int | None:
    return int(value) if isinstance(value, Ref) else None


def _text(instances: Instances, property: int) -> str | None:
    """Text of a property's only descriptive item."""
    for link in instances.referrers(property, "ACTION_PROPERTY_REPRESENTATION", "property"):
        shown = _number(instances.value(link, "representation"))
        items = () if shown is None else instances.value(shown, "items")
        for item in items if isinstance(items, tuple) else ():
            number = _number(item)
            text = None if number is None else instances.value(number, "description")
            if isinstance(text, str):
                return text
    return None


def _curve(arc: VendorArc, origin: int, first: int, unit: float) -> Iterator[ConvertedText]:
    """Instances of a curve, the curve itself last."""

    def made(offset: int, keyword: str, *values: Value) -> ConvertedText:
        instance = Converted(number=first + offset, keyword=keyword, origin=origin, rule=None)
        return ConvertedText.of(instance, values)

    def point(offset: int, at: Point) -> ConvertedText:
        place = tuple(Real(unit * each) for each in at)
        return made(offset, "CARTESIAN_POINT", "", place)

    if arc.rise:
        points = list(_helix(arc))
        yield from (point(number, at) for number, at in enumerate(points))
        refs: tuple[Value, ...] = tuple(Ref(first + number) for number in range(len(points)))
        yield made(len(points), "POLYLINE", "", refs)
        return
    axes = arc.axes
    normal, towards = [0.0] * 3, [0.0] * 3
    normal[axes[2]], towards[axes[0]] = 1.0, 1.0
    yield point(0, arc.centre)
    yield made(1, "DIRECTION", "", tuple(map(Real, normal)))
    yield made(2, "DIRECTION", "", tuple(map(Real, towards)))
    yield made(3, "AXIS2_PLACEMENT_3D", "", Ref(first), Ref(first + 1), Ref(first + 2))
    radius = sum((s - c) ** 2 for s, c in zip(arc.start, arc.centre, strict=True)) ** 0.5
    yield made(4, "CIRCLE", "", Ref(first + 3), Real(unit * radius))
    yield point(5, arc.start)
    yield point(6, arc.end)
    yield made(
        7, "TRIMMED_CURVE", "", Ref(first + 4), (Ref(first + 5),), (Ref(first + 6),),
        Enumeration("F" if arc.is_clockwise else "T"), Enumeration("CARTESIAN"),
    )  # fmt: skip


def _helix(arc: VendorArc) -> Iterator[Point]:
    """Points of the chords of a helix, from its start to its end."""
    first, second, normal = arc.axes
    one, other = (arc.start[axis] - arc.centre[axis] for axis in (first, second))
    count = max(1, round(arc.sweep / CHORD))
    sense = -1.0 if arc.is_clockwise else 1.0
    for number in range(count):
        angle = sense * arc.sweep * number / count
        at = [0.0] * 3
        at[first] = arc.centre[first] + one * cos(angle) - other * sin(angle)
        at[second] = arc.centre[second] + one * sin(angle) + other * cos(angle)
        at[normal] = arc.start[normal] + arc.rise * number / count
        yield at[0], at[1], at[2]
    yield arc.end
