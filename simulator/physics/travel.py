"""Approach, overrun and drill point length: travel of a tool beyond the machined length.

Scalars in mm.

References
----------
.. [1] Mitsubishi Materials, "Technical information", cutting time of face milling.
.. [2] M. P. Groover, "Fundamentals of Modern Manufacturing", machining operations.
"""

from math import pi, sqrt, tan

from simulator.physics.domain import require_at_most, require_positive


def centred_approach(tool_diameter: float, radial_width: float) -> float:
    """Travel from first contact to full width when the cutter is centred on the face.

    ``A = D/2 − ½·√(D² − a_e²)``, [2]_: full immersion and centred bilateral face milling. The
    same distance past the end completes the full width; clearing the face takes more.

    Parameters
    ----------
    tool_diameter : float, mm
    radial_width : float, mm
        At most the tool diameter.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the width exceeds the diameter.

    Examples
    --------
    >>> centred_approach(50.0, 30.0)
    5.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(radial_width, tool_diameter, thing="radial width", unit="mm")
    return 0.5 * (tool_diameter - sqrt(tool_diameter**2 - radial_width**2))


def one_sided_approach(tool_diameter: float, radial_width: float) -> float:
    """Travel from first contact to full width when one side of the cutter is engaged.

    ``A = √(a_e · (D − a_e))`` up to half the diameter, [2]_: peripheral milling and
    unidirectional face milling. For greater widths the foremost point of the cutter is engaged
    and the distance is ``D/2`` (the square root would fall again, to 0 for a slot). The same
    distance past the end clears the workpiece.

    Parameters
    ----------
    tool_diameter : float, mm
    radial_width : float, mm
        At most the tool diameter.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the width exceeds the diameter.

    Examples
    --------
    >>> one_sided_approach(50.0, 5.0)
    15.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(radial_width, tool_diameter, thing="radial width", unit="mm")
    if radial_width >= tool_diameter / 2.0:
        return tool_diameter / 2.0
    return sqrt(radial_width * (tool_diameter - radial_width))


def drill_point_length(tool_diameter: float, point_angle: float) -> float:
    """Height of a drill's point: the travel that a through hole needs beyond its depth.

    ``l = D / (2 · tan(σ/2))``.

    Parameters
    ----------
    tool_diameter : float, mm
    point_angle : float, rad
        Included angle σ, 0 < σ ≤ π.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If the diameter is not positive or the angle is out of range.

    Examples
    --------
    The customary 118° gives 0.3 D:

    >>> from stepnc_model.units import rad_from_deg
    >>> round(drill_point_length(10.0, rad_from_deg(118.0)), 2)
    3.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(point_angle, pi, thing="point angle", unit="rad")
    return tool_diameter / (2.0 * tan(point_angle / 2.0))
