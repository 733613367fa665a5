"""Force on the wear land of an edge: what wear adds to the force of a sharp one.

The land rubs on the fresh surface whatever the chip above it does, so that its force adds to
that of the chip, ``ΔF = c·VB·b``, and does not multiply it: measured, 42 N at VB 0.3 mm and a
depth of 0.25 mm at every feed. The width b is counted across the depth of cut, as it was in the
measurement. Arithmetic only; mm, N, N/mm².

Measured on turning of hardened H13 up to VB 0.3 mm, two series of force measurements. In other
work materials the coefficients are not known: the pressure on the land may fall with hardness.

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
"""N/mm², c along the cutting speed; standard deviation 80 at VB 0.3 mm, and 617 ± 443 at 0.1"""

FEED = 950.0
"""N/mm², along the feed; 690 to 1210 by the spread of the share of a new edge"""

BACK = 1580.0
"""N/mm², out of the work; 1110 to 2050 likewise"""

NORMAL = hypot(FEED, BACK)
"""N/mm², square to the edge: that of feed and back force together, for other processes"""


def land_force(coefficient: float, flank_wear: Value, width: Value) -> Value:
    """Force on a wear land, ``c · VB · b``.

    Parameters
    ----------
    coefficient : float, N/mm²
        :data:`CUTTING`, :data:`FEED`, :data:`BACK` or :data:`NORMAL`.
    flank_wear : float or array, mm
        VB.
    width : float or array, mm
        b, of all edges in the cut together.

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
