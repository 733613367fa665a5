"""The domain in which a formula holds: checks of what a caller hands in.

A value outside it is the caller's mistake and raises ``ValueError`` with the thing, its value,
the bound and the unit. NaN and infinity lie outside every domain.
"""

from math import inf, pi


def require_positive(value: float, thing: str, unit: str) -> None:
    """Refuse what is not a finite number greater than zero.

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
    """Refuse what is not a finite number of at least zero."""
    if not 0.0 <= value < inf:
        raise ValueError(_sentence(value, thing, unit, f"at least 0 {unit} and finite"))


def require_at_most(value: float, bound: float, *, thing: str, unit: str) -> None:
    """Refuse what is not greater than zero and at most the bound."""
    require_positive(value, thing, unit)
    if value > bound:
        raise ValueError(_sentence(value, thing, unit, f"at most {bound:g} {unit}"))


def require_teeth(teeth: int) -> None:
    """Refuse a number of teeth below one."""
    if teeth < 1:
        raise ValueError(f"number of teeth {teeth} must be at least 1")


def require_edge_angle(cutting_edge_angle: float) -> None:
    """Refuse a cutting edge angle κ_r outside 0 < κ_r < π rad."""
    if not 0.0 < cutting_edge_angle < pi:
        raise ValueError(
            f"cutting edge angle {cutting_edge_angle:g} rad must lie between 0 and π rad"
        )


def require_hole(tool_diameter: float, previous_diameter: float) -> None:
    """Refuse a hole that the tool would not cut."""
    require_positive(tool_diameter, "tool diameter", "mm")
    require_not_negative(previous_diameter, "previous diameter", "mm")
    if previous_diameter >= tool_diameter:
        raise ValueError(
            f"previous diameter {previous_diameter:g} mm must be less than the tool diameter "
            f"{tool_diameter:g} mm"
        )


def _sentence(value: float, thing: str, unit: str, bound: str) -> str:
    """Thing, value, unit and bound in one sentence; no unit leaves no gap."""
    return " ".join(f"{thing} {value:g} {unit} must be {bound}".split())
