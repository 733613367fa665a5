"""Ridges that circles leave: paths of a ball end mill, and the wall behind an end mill's teeth.

Ideal geometry without runout, wear or deflection. Scalars in mm.
"""

from math import sqrt

from simulator.physics.domain import require_at_most, require_positive


def scallop_height(step_over: float, tool_diameter: float) -> float:
    """Height of the ridge that a ball end mill leaves between two paths on a flat face.

    ``h = R − √(R² − s²/4)``, R = D/2, computed without cancellation. Along the path the feed
    per tooth takes the place of the step-over. On a slope it is greater.

    Parameters
    ----------
    step_over : float, mm
        At most the tool diameter.
    tool_diameter : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the step-over exceeds the diameter.

    Examples
    --------
    >>> round(scallop_height(0.5, 6.0), 4)
    0.0104
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(step_over, tool_diameter, thing="step-over", unit="mm")
    radius, half = tool_diameter / 2.0, step_over / 2.0
    return half**2 / (radius + sqrt(radius**2 - half**2))


def approximate_scallop_height(step_over: float, tool_diameter: float) -> float:
    """First term of :func:`scallop_height`: ``h ≈ s² / (4·D)``, low by 1.6 % at s = D/4.

    Raises
    ------
    ValueError
        As :func:`scallop_height`.
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(step_over, tool_diameter, thing="step-over", unit="mm")
    return step_over**2 / (4.0 * tool_diameter)


def step_over_for_scallop(height: float, tool_diameter: float) -> float:
    """Step-over that leaves a ridge: ``s = 2·√(h·(D − h))``, inverse of the exact height.

    Parameters
    ----------
    height : float, mm
        At most half the diameter.
    tool_diameter : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the height exceeds half the diameter.

    Examples
    --------
    >>> round(step_over_for_scallop(0.005, 6.0), 3)
    0.346
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(height, tool_diameter / 2.0, thing="scallop height", unit="mm")
    return 2.0 * sqrt(height * (tool_diameter - height))


def wall_roughness(feed_per_tooth: float, tool_diameter: float) -> float:
    """Ideal roughness of a wall cut with the side of a mill.

    ``R_z = f_z² / (4·D)``: circles one feed apart. Runout of the cutter replaces the feed per
    tooth by the feed per revolution.

    Parameters
    ----------
    feed_per_tooth : float, mm
        At most the tool diameter.
    tool_diameter : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the feed exceeds the diameter.

    Examples
    --------
    >>> round(wall_roughness(0.2, 10.0) * 1000, 6)
    1.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(feed_per_tooth, tool_diameter, thing="feed per tooth", unit="mm")
    return feed_per_tooth**2 / (4.0 * tool_diameter)


def feed_for_wall_roughness(roughness: float, tool_diameter: float) -> float:
    """Feed per tooth that leaves a wall's R_z: ``f_z = 2·√(D·R_z)``, in mm.

    Raises
    ------
    ValueError
        If either is not positive or the roughness exceeds a quarter of the diameter.
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(roughness, tool_diameter / 4.0, thing="roughness Rz", unit="mm")
    return 2.0 * sqrt(tool_diameter * roughness)
