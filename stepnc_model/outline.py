"""Numbers of ISO 14649 features that tool paths and estimates share: sizes, depths, boundaries.

Lengths in mm. Whoever needs contours makes them of these: tool paths with exact arcs, estimates
as areas and lengths.
"""

from math import pi
from typing import Any

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.units import rad_from_deg

MOST = 1e6
"""mm; nothing longer is a length of a part, nothing lies further away"""

BOUNDARIES = (
    "feature_boundary",
    "its_boundary",
    "profile_boundary",
    "closed_boundary",
    "open_boundary",
)
"""attributes that hold the profile of the walls of a feature"""


def size(
    program: Program, ref: Ref[TolerancedLengthMeasure] | None, owner: Ref[Entity]
) -> float:
    """Theoretical size of a toleranced length that an entity cannot do without.

    Raises
    ------
    PathError
        When there is none, or it is no length of a part.
    """
    if ref is None:
        raise program.path_error("lacks a size", owner)
    return _length(program, ref, "theoretical_size", what="size ")


def size_or_zero(program: Program, ref: Ref[TolerancedLengthMeasure] | None) -> float:
    """Theoretical size of a toleranced length that may be absent or 0.

    Raises
    ------
    PathError
        When it is negative, or no length of a part.
    """
    value = (program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
    if ref is not None and not 0.0 <= value < MOST:
        message = f"size {value:g} mm: it must not be negative"
        raise program.path_error(message, ref, "theoretical_size")
    return float(value)


def parameter(program: Program, ref: Ref[NumericParameter]) -> float:
    """Value of a numeric parameter that is a length."""
    return _length(program, ref, "its_parameter_value")


def feature_depth(program: Program, ref: Ref[Entity]) -> float | None:
    """Depth of a feature: where its depth plane lies in its own coordinates.

    Files write the plane below the placement, at a negative z; the positive depth of an older
    draft means the same.

    Raises
    ------
    PathError
        When it is 0.
    """
    plane = getattr(program.get(ref), "depth", None)
    if plane is None:
        return None
    placement = program.get(program.get(plane).position)
    depth = abs(float((*program.get(placement.location).coordinates, 0.0, 0.0, 0.0)[2]))
    if not 0.0 < depth < MOST:
        message = f"depth {depth:g} mm removes nothing: it must be positive"
        raise program.path_error(message, ref, "depth")
    return depth


def known_depth(program: Program, ref: Ref[Entity]) -> float:
    """Depth of a feature that needs one; a :class:`PathError` where it has none."""
    depth = feature_depth(program, ref)
    if depth is None:
        raise program.path_error("has no depth", ref, "depth")
    return depth


def boundary_of(feature: Entity) -> Ref[Any] | None:
    """Profile of the walls of a feature; None of one that has no such attribute."""
    found = (getattr(feature, name, None) for name in BOUNDARIES)
    return next((ref for ref in found if ref is not None), None)


def vee_angle(written: float | None) -> float:
    """Included angle in rad; some files write radians, and no vee is as sharp as 3°."""
    angle = written or 0.0
    return angle if angle < pi else rad_from_deg(angle)


def _length(program: Program, ref: Ref[Entity], attribute: str, what: str = "") -> float:
    """A number that is a length of a part."""
    value = getattr(program.get(ref), attribute)
    if value is None or not 0.0 < value < MOST:
        message = f"{what}{value or 0.0:g} mm is not a length of a part: it must be positive"
        raise program.path_error(message, ref, attribute)
    return float(value)
