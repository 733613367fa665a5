"""Force on the wear land of an edge: the additional force compared with a sharp edge.

The land rubs on the fresh surface independently of the chip, so that its force is added to that
of the chip, ``ΔF = c·VB·b``, and not multiplied: measurements show 42 N at VB 0.3 mm and a
depth of 0.25 mm at every feed. The width b is measured across the depth of cut, as in the
measurements. Arithmetic only; mm, N, N/mm².

Measured in turning hardened H13 up to VB 0.3 mm, in two series of force measurements. For other
work materials the coefficients are unknown: the pressure on the land may fall with hardness.

References
----------
.. [1] Turning of hardened AISI H13: at VB 0.1 and 0.3 mm the cutting force is 1.22 and 1.54
   times that of a new edge, the feed force 1.54 and 3.29, the back force 1.67 and 3.54 times;
   shares of a new edge 0.33 to 0.58 (feed) and 0.48 to 0.89 (back). docs/models.md derives the
   coefficients of feed and back force.
"""

from math import hypot

from simulator.physics.drive import Value

CUTTING = 490.0
"""Coefficient c along the cutting speed, N/mm²; standard deviation 80 at VB 0.3 mm; 617 ± 443
at VB 0.1 mm."""

FEED = 950.0
"""Coefficient along the feed, N/mm²; 690 to 1210 given the spread for a new edge."""

BACK = 1580.0
"""Coefficient away from the work, N/mm²; 1110 to 2050 given the spread for a new edge."""

NORMAL = hypot(FEED, BACK)
"""Coefficient normal to the edge, N/mm²: resultant of FEED and BACK, for other processes."""


def land_force(coefficient: float, flank_wear: Value, width: Value) -> Value:
    """Force on a wear land, ``c · VB · b``.

    Parameters
    ----------
    coefficient : float, N/mm²
        :data:`CUTTING`, :data:`FEED`, :data:`BACK` or :data:`NORMAL`.
    flank_wear : float or array, mm
        Flank wear VB.
    width : float or array, mm
        Total engaged width b of all edges.

    Returns
    -------
    float or array, N

    Examples
    --------
    >>> round(land_force(CUTTING, 0.3, 0.25), 2)
    36.75
    """
    force: Value = coefficient * flank_wear * width
    return force
