"""Catalogue of all entity classes by keyword, with the names of both editions of ISO 14649."""

from collections.abc import Iterator
from functools import cache

from stepnc_model.entities import (
    adaptive,
    executables,
    features,
    geometry,
    measures,
    milling,
    operations,
    optimisation,
    profiles,
    technology,
    tools,
    turning,
    turning_tools,
    workpiece,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Value

MODULES = (
    adaptive,
    executables,
    features,
    geometry,
    measures,
    milling,
    operations,
    optimisation,
    profiles,
    technology,
    tools,
    turning,
    turning_tools,
    workpiece,
)

OLDER_NAMES = {
    "TOOL_DIMENSION": "MILLING_TOOL_DIMENSION",
    "UNIDIRECTIONAL": "UNIDIRECTIONAL_MILLING",
    "BIDIRECTIONAL": "BIDIRECTIONAL_MILLING",
    "EXPLICIT": "EXPLICIT_STRATEGY",
    "CUTTING_TOOL": "MILLING_CUTTING_TOOL",
    "NGON_PROFILE": "NGON_CLOSED_PROFILE",
    "THREADING_TOOL": "MILLING_THREADING_TOOL",
    "COUNTERSINKING": "COUNTER_SINKING",
    "MULTISTEP_DRILLING_OPERATION": "MULTISTEP_DRILLING",
}
"""Entity names of the drafts of 2001 and of some files, with those of the 2004 standard."""


BY_ARITY: dict[tuple[str, int], type[Entity]] = {
    ("MILLING_TECHNOLOGY", 5): adaptive.AdaptiveMillingTechnology
}
"""Alternative forms of an entity, recognised by their number of parameters."""


def class_of(keyword: str, arity: int) -> type[Entity] | None:
    """Class of an instance by keyword and number of parameters; None if not supported."""
    return BY_ARITY.get((keyword, arity)) or classes().get(keyword)


@cache
def classes() -> dict[str, type[Entity]]:
    """Entity classes by keyword, including older names."""
    found = {cls.keyword: cls for module in MODULES for cls in _entities(module)}
    found.update({old: found[new] for old, new in OLDER_NAMES.items()})
    return found


def _entities(module: object) -> Iterator[type[Entity]]:
    """Entity classes of one module that can occur in a file."""
    for value in vars(module).values():
        if not isinstance(value, type) or not issubclass(value, Entity):
            continue
        if vars(value).get("keyword"):
            yield value


WEIGHTS = "RATIONAL_B_SPLINE_CURVE"
"""Part of a complex instance that gives a curve its weights."""


def flattened(
    parts: dict[str, tuple[Value, ...]],
) -> tuple[type[Entity], tuple[Value, ...]] | None:
    """Class and parameters of a complex instance that is one entity with its supertypes."""
    known = [classes()[name] for name in parts if name in classes()]
    if not known:
        return None
    leaf = max(known, key=lambda cls: len(cls.__mro__))
    if WEIGHTS in parts and leaf is geometry.BSplineCurveWithKnots:
        leaf = geometry.RationalBSplineCurveWithKnots
    # ISO 10303-21 writes the parts in the order of their names; parameters follow supertypes.
    names = [
        WEIGHTS if cls is geometry.RationalBSplineCurveWithKnots else cls.express_name().upper()
        for cls in reversed(leaf.__mro__)
        if issubclass(cls, Entity)
    ]
    if any(values for name, values in parts.items() if name not in names):
        return None
    return leaf, tuple(value for name in names for value in parts.get(name, ()))
