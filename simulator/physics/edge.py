"""Effective cutting edge angle of rounded tools.

Ball and bull-nose end mills, round inserts and the nose of a turning tool touch the work with
an arc. Scalars in mm and rad.

References
----------
.. [1] Sandvik Coromant, technical guide, formulae for round inserts and ball-nose end mills.
"""

from math import acos, asin, cos, pi, sin

from simulator.physics.domain import (
    require_edge_angle,
    require_not_negative,
    require_positive,
)


def effective_edge_angle(
    corner_radius: float, axial_depth: float, *, cutting_edge_angle: float = pi / 2.0
) -> float:
    """Edge angle of the straight edge that cuts the same chip as a rounded edge.

    ``sin κ = a_p / b``, where b is the engaged length of edge: an arc of the corner, then the
    straight edge at κ_r. With it the chip has the thickness ``h = f · sin κ``, the width b and
    the area ``f · a_p``. For a shallow cut it becomes the ``√(a_p / 2r)`` of round inserts,
    [1]_.

    Parameters
    ----------
    corner_radius : float, mm
        Nose radius of a turning tool, corner radius of a bull-nose, D/2 of a ball; 0: none.
    axial_depth : float, mm
        Depth of cut a_p.
    cutting_edge_angle : float, rad
        Angle κ_r of the straight edge.

    Returns
    -------
    float, rad
        Between 0 and π/2.

    Raises
    ------
    ValueError
        If the depth is not positive, the radius negative or the edge angle outside (0, π).

    Examples
    --------
    >>> round(effective_edge_angle(0.8, 2.5), 3)
    1.008
    >>> from math import sqrt
    >>> round(effective_edge_angle(5.0, 0.05), 4), round(asin(sqrt(0.05 / 10.0)), 4)
    (0.0707, 0.0708)
    """
    require_not_negative(corner_radius, "corner radius", "mm")
    require_positive(axial_depth, "axial depth", "mm")
    require_edge_angle(cutting_edge_angle)
    arc_height = corner_radius * (1.0 - cos(cutting_edge_angle))
    if axial_depth < arc_height:
        edge_length = corner_radius * acos(1.0 - axial_depth / corner_radius)
    else:
        straight = (axial_depth - arc_height) / sin(cutting_edge_angle)
        edge_length = corner_radius * cutting_edge_angle + straight
    return asin(min(axial_depth / edge_length, 1.0))
