"""Checks that arguments lie in the domain of a formula.

A value outside the domain is an error of the caller and raises ``ValueError`` with the name,
value, bound and unit. NaN and infinity lie outside every domain.
"""

from math import inf, pi


def require_positive(value: float, thing: str, unit: str) -> None:
    """Raise an error unless a value is a finite number greater than zero.

    Examples
    --------
    >>> require_positive(0.0, "tool diameter", "mm")
    Traceback (most recent call last):
        ...
    ValueError: tool diameter 0 mm must be greater than 0 mm and finite
    """
    if not 0.0 < value < inf:
        raise ValueError(_sentence(value, thing, unit, f"greater than 0 {unit} and finite"))


def require_not_negative(value: float, thing: str, unit: str) -> None:
    """Raise an error unless a value is a finite number of at least zero."""
    if not 0.0 <= value < inf:
        raise ValueError(_sentence(value, thing, unit, f"at least 0 {unit} and finite"))


def require_at_most(value: float, bound: float, *, thing: str, unit: str) -> None:
    """Raise an error unless a value is greater than zero and at most a bound."""
    require_positive(value, thing, unit)
    if value > bound:
        raise ValueError(_sentence(value, thing, unit, f"at most {bound:g} {unit}"))


def require_teeth(teeth: int) -> None:
    """Raise an error if a number of teeth is less than one."""
    if teeth < 1:
        raise ValueError(f"number of teeth {teeth} must be at least 1")


def require_edge_angle(cutting_edge_angle: float) -> None:
    """Raise an error unless a cutting edge angle satisfies 0 < κ_r < π rad."""
    if not 0.0 < cutting_edge_angle < pi:
        raise ValueError(
            f"cutting edge angle {cutting_edge_angle:g} rad must lie between 0 and π rad"
        )


def require_hole(tool_diameter: float, previous_diameter: float) -> None:
    """Raise an error unless the tool is larger than the existing hole."""
    require_positive(tool_diameter, "tool diameter", "mm")
    require_not_negative(previous_diameter, "previous diameter", "mm")
    if previous_diameter >= tool_diameter:
        raise ValueError(
            f"previous diameter {previous_diameter:g} mm must be less than the tool diameter "
            f"{tool_diameter:g} mm"
        )


def _sentence(value: float, thing: str, unit: str, bound: str) -> str:
    """Message with name, value, unit and bound; without double spaces if there is no unit."""
    return " ".join(f"{thing} {value:g} {unit} must be {bound}".split())
