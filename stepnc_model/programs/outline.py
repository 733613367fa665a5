"""Sizes, depths and boundaries of ISO 14649 features, shared by tool paths and estimates.

Lengths are in mm. Contours are built from these numbers elsewhere: with exact arcs for tool
paths, as areas and lengths for estimates.
"""

from math import pi
from typing import Any

from stepnc_model.entities.conversion import slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.units import rad_from_deg

MOST = 1e6
"""Greatest length or coordinate of a part that is accepted, mm."""

BOUNDARIES = (
    "feature_boundary",
    "its_boundary",
    "profile_boundary",
    "closed_boundary",
    "open_boundary",
)
"""Attributes that hold the profile of a feature's walls."""


def size(
    program: Program, ref: Ref[TolerancedLengthMeasure] | None, owner: Ref[Entity]
) -> float:
    """Theoretical size of a toleranced length that an entity requires, mm.

    Raises
    ------
    PathError
        If the size is missing or is not a valid length.
    """
    if ref is None:
        raise program.path_error("a required size is missing", owner, _missing(program, owner))
    return _length(program, ref, "theoretical_size", what="size ")


def size_or_zero(program: Program, ref: Ref[TolerancedLengthMeasure] | None) -> float:
    """Theoretical size of a toleranced length that may be absent or 0, mm.

    Raises
    ------
    PathError
        If the size is negative or too large.
    """
    value = (program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
    if ref is not None and not 0.0 <= value < MOST:
        message = f"size {value:g} mm must not be negative or larger than any part"
        raise program.path_error(message, ref, "theoretical_size")
    return float(value)


def parameter(program: Program, ref: Ref[NumericParameter]) -> float:
    """Value of a numeric parameter that is a length, mm."""
    return _length(program, ref, "its_parameter_value")


def feature_depth(program: Program, ref: Ref[Entity]) -> float | None:
    """Depth of a feature, mm: position of its depth plane in its own coordinates.

    Files place the plane below the placement, at a negative z; the positive depth of an older
    draft has the same meaning.

    Raises
    ------
    PathError
        If the depth is 0 or too large.
    """
    plane = getattr(program.get(ref), "depth", None)
    if plane is None:
        return None
    placement = program.get(program.get(plane).position)
    depth = abs(float((*program.get(placement.location).coordinates, 0.0, 0.0, 0.0)[2]))
    if not 0.0 < depth < MOST:
        message = f"depth {depth:g} mm is not valid: it must be positive"
        raise program.path_error(message, ref, "depth")
    return depth


def known_depth(program: Program, ref: Ref[Entity]) -> float:
    """Depth of a feature, mm; a :class:`PathError` if the feature has none."""
    depth = feature_depth(program, ref)
    if depth is None:
        raise program.path_error("the feature has no depth", ref, "depth")
    return depth


def boundary_of(feature: Entity) -> Ref[Any] | None:
    """Profile of a feature's walls; None if the feature has none."""
    found = (getattr(feature, name, None) for name in BOUNDARIES)
    return next((ref for ref in found if ref is not None), None)


def vee_angle(written: float | None) -> float:
    """Included angle of a vee, rad; values below π are already radians, as in some files."""
    angle = written or 0.0
    return angle if angle < pi else rad_from_deg(angle)


def _missing(program: Program, owner: Ref[Entity]) -> str:
    """First required length that an entity does not give."""
    entity = program.get(owner)
    slots = slots_of(type(entity)).items()
    sizes = (name for name, slot in slots if TolerancedLengthMeasure in slot.references)
    return next((name for name in sizes if getattr(entity, name) is None), "")


def _length(program: Program, ref: Ref[Entity], attribute: str, what: str = "") -> float:
    """Value of an attribute that must be a valid length of a part, mm."""
    value = getattr(program.get(ref), attribute)
    if value is None or not 0.0 < value < MOST:
        message = f"{what}{value or 0.0:g} mm is not a length of a part: it must be positive"
        raise program.path_error(message, ref, attribute)
    return float(value)
