"""Surface roughness caused by the shape and feed of a tool.

The ideal surface is the envelope of the edge; a real one is rougher because of wear, vibration
and built-up edge, for which an empirical floor is added: ``R_a = c·f² + floor``. Scalars, all
in **mm**: handbooks give Ra and Rz in µm with the feed in mm, hence their factor of 1000, which
is absent here.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eqs. (10), (12), (14). They are printed with the feed in mm/min,
   with R_a in the formula of R_t and with the inequality of (14) reversed. Here f is the feed
   per revolution, or the feed per tooth of a perfectly set cutter.
"""

from math import sqrt

from simulator.physics.domain import require_positive

RA_FLOOR = 0.2e-3  # mm; customary least Ra of careful turning and milling, not measured
RZ_PER_RA = 4.0  # rule of thumb for turned and milled profiles; ideally 9·√3/4 = 3.9


def corner_coefficient(corner_radius: float) -> float:
    """Ideal R_a of a rounded corner over the square of the feed.

    ``R_a/f² = 1 / (18·√3·r)``, [1]_ eq. (10) corrected: the mean deviation of a parabola, which
    approximates the corner while f is small compared with 2·r. Its depth is 1.6 % low at f =
    r/2.

    Parameters
    ----------
    corner_radius : float, mm

    Returns
    -------
    float, 1/mm

    Raises
    ------
    ValueError
        If the radius is not positive.

    Examples
    --------
    0.2 mm/rev and a 0.8 mm corner: 1.6 µm.

    >>> round(corner_coefficient(0.8) * 0.2**2 * 1000, 4)
    1.6038
    """
    require_positive(corner_radius, "corner radius", "mm")
    return 1.0 / (18.0 * sqrt(3.0) * corner_radius)


def wall_coefficient(tool_diameter: float) -> float:
    """Ideal R_a of a wall cut with the flank of a mill, over the square of the feed per tooth.

    ``R_z = f_z² / (4·D)``, from circles one feed apart, divided by R_z/R_a. If the cutter has
    runout, use the feed per revolution instead of the feed per tooth.

    Parameters
    ----------
    tool_diameter : float, mm

    Returns
    -------
    float, 1/mm

    Raises
    ------
    ValueError
        If the diameter is not positive.

    Examples
    --------
    >>> round(wall_coefficient(10.0) * 0.2**2 * 1000, 6)
    0.25
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    return 1.0 / (4.0 * tool_diameter * RZ_PER_RA)
