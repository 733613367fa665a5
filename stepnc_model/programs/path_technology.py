"""Technology of an operation whose given tool paths have technologies of their own.

CAM systems write one technology for each of them: a feed for the way in, another for the cut.
The operation's own technology may then serve no move at a feed, or have no feed at all. The
feed of such an operation is that of the paths that are longest, weighted by how far they lie
from the start of the operation along the tool: ways in are short, and positioning lies high.
Feeds do not count, so that the choice stays the same after they have changed. Technologies with
the same values are one.
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from math import dist

from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.entities.enums import SpeedName
from stepnc_model.entities.geometry import (
    BSplineCurve,
    CartesianPoint,
    CompositeCurve,
    Polyline,
    TrimmedCurve,
)
from stepnc_model.entities.operations import (
    CurveWithNormalVector,
    MachiningOperation,
    Toolpath,
)
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model

MOST_NESTED = 5
"""Greatest nesting of chains of curves that are measured here."""

LEAST_LENGTH = 1e-6
"""Length that counts for a path whose curve is not measured here, mm."""


def technologies_of(model: Model, operation: MachiningOperation) -> tuple[Ref[Entity], ...]:
    """Technologies that the feed of an operation stands in.

    Returns
    -------
    tuple of Ref
        That of the operation where it serves its paths; else those of the paths that weigh
        most, in the order of the paths. Empty: there is none.
    """
    own: Ref[Entity] | None = operation.its_technology
    scores: dict[tuple[object, ...], float] = {}
    alike: dict[tuple[object, ...], list[Ref[Entity]]] = {}
    fed = list(fed_paths(model, operation))
    if own is not None and _feed(model.get(own)) > 0.0 and any(ref == own for ref, _ in fed):
        return (own,)
    weigh = _weights(model, operation) if len({ref for ref, _ in fed}) > 1 else _any_weight
    for technology, path in fed:
        key = _values(model.get(technology))
        scores[key] = scores.get(key, 0.0) + max(weigh(path), LEAST_LENGTH)
        known = alike.setdefault(key, [])
        if technology not in known:
            known.append(technology)
    # A way in may turn the spindle as little as a rapid: what turns it counts first.
    turning = [key for key, refs in alike.items() if _has_speed(model.get(refs[0]))]
    chosen = turning or list(alike)
    if not chosen or (own is not None and not turning and _has_speed(model.get(own))):
        return () if own is None else (own,)
    return tuple(alike[max(chosen, key=lambda key: scores[key])])


def fed_paths(
    model: Model, operation: MachiningOperation
) -> Iterator[tuple[Ref[Entity], Toolpath]]:
    """Tool paths of an operation that run at a feed, each with the technology that gives it."""
    listed = operation.its_toolpath
    for ref in () if listed is None else model.get(listed).its_list:
        path: Entity = model.get(ref)
        if not isinstance(path, Toolpath) or path.its_speed is SpeedName.RAPID:
            continue
        technology = path.its_technology or operation.its_technology
        if technology is not None:
            yield technology, path


def _values(entity: Entity) -> tuple[object, ...]:
    """Type and values of an entity."""
    return (entity.keyword, *(getattr(entity, name) for name in attributes(entity)))


def _feed(entity: Entity) -> float:
    """Feed of a technology as it is written; 0 if none is given."""
    names = ("feedrate", "feedrate_per_tooth", "feed_per_revolution")
    return next((float(value) for name in names if (value := getattr(entity, name, None))), 0.0)


def _has_speed(entity: Entity) -> bool:
    """True if a technology turns the spindle."""
    names = ("spindle", "cutspeed", "spindle_speed", "its_speed")
    return any(getattr(entity, name, None) for name in names)


def _any_weight(_path: Toolpath) -> float:
    """Weight of a path where there is nothing to choose between."""
    return LEAST_LENGTH


def _weights(model: Model, operation: MachiningOperation) -> Callable[[Toolpath], float]:
    """Length of a path of an operation, each piece times its share of the greatest depth.

    The depth is that below the first point of the operation, in whichever sense of z.
    """
    listed = operation.its_toolpath
    paths: list[Entity] = (
        [] if listed is None else list(map(model.get, model.get(listed).its_list))
    )
    heights = [at[2] for path in paths for at in _points(model, path)]
    begin = heights[0] if heights else 0.0
    deepest = max((abs(z - begin) for z in heights), default=0.0)
    is_level = deepest < LEAST_LENGTH or isinstance(operation, TurningMachiningOperation)

    def weight(path: Toolpath) -> float:
        return sum(
            dist(one, other)
            * (1.0 if is_level else abs(0.5 * (one[2] + other[2]) - begin) / deepest)
            for one, other in pairwise(_points(model, path))
        )

    return weight


def _points(model: Model, path: Entity) -> list[tuple[float, float, float]]:
    """Points of a path's curve, or near it; none where it has none."""
    curve = getattr(path, "basiccurve", None)
    try:
        found = [] if curve is None else list(_curve_points(model, curve, MOST_NESTED))
        return [(float(at[0]), float(at[1]), float(at[2])) for at in found]
    except (AttributeError, IndexError, SchemaError, TypeError, ValueError):
        return []


def _curve_points(model: Model, ref: Ref[Entity], levels: int) -> Iterator[tuple[float, ...]]:
    """Points of a polyline or spline, ends of an arc, and those of the parts of a chain."""
    curve: Entity = model.get(ref)
    points: Iterable[Ref[CartesianPoint]] = ()
    if isinstance(curve, Polyline):
        points = curve.points
    elif isinstance(curve, BSplineCurve):
        points = curve.control_points_list
    elif isinstance(curve, TrimmedCurve):
        points = [each for each in (*curve.trim_1, *curve.trim_2) if isinstance(each, Ref)]
    elif isinstance(curve, CurveWithNormalVector):
        yield from _curve_points(model, curve.basiccurve, levels - 1)
    elif isinstance(curve, CompositeCurve) and levels > 0:
        for segment in curve.segments:
            yield from _curve_points(model, model.get(segment).parent_curve, levels - 1)
    yield from (model.get(point).coordinates for point in points)
