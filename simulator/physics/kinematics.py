"""Speeds, feeds and removal rates of a cut from its geometry.

All arguments and results are scalars in mm, s and rev/s, so the factors 1000 and 60 of handbook
formulas are not needed.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eqs. (2), (3).
.. [2] Mitsubishi Materials, "Technical information", formulae for turning, milling, drilling.
.. [3] M. P. Groover, "Fundamentals of Modern Manufacturing", machining operations.
"""

from math import pi

from simulator.physics.domain import (
    require_positive,
    require_teeth,
)


def cutting_speed(diameter: float, spindle_speed: float) -> float:
    """Cutting speed at a rotating diameter.

    ``v_c = π · D · n``, [1]_ eq. (3).

    Parameters
    ----------
    diameter : float, mm
        Diameter of the tool in milling and drilling, of the workpiece in turning.
    spindle_speed : float, rev/s

    Returns
    -------
    float, mm/s

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    Ø125 mm at 350 rpm cuts with 137.4 m/min [2]_:

    >>> round(cutting_speed(125.0, 350 / 60) * 60 / 1000, 1)
    137.4
    """
    require_positive(diameter, "diameter", "mm")
    require_positive(spindle_speed, "spindle speed", "rev/s")
    return pi * diameter * spindle_speed


def spindle_speed(diameter: float, cutting_speed: float) -> float:
    """Spindle speed for a given cutting speed, the inverse of :func:`cutting_speed`.

    ``n = v_c / (π · D)``, [1]_ eq. (3).

    Parameters
    ----------
    diameter : float, mm
    cutting_speed : float, mm/s

    Returns
    -------
    float, rev/s

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    The worked case of [1]_: 35 m/min on Ø18 mm is 618.9 rpm.

    >>> round(spindle_speed(18.0, 35_000 / 60) * 60, 1)
    618.9
    """
    require_positive(diameter, "diameter", "mm")
    require_positive(cutting_speed, "cutting speed", "mm/s")
    return cutting_speed / (pi * diameter)


def feed(feed_per_tooth: float, spindle_speed: float, *, teeth: int = 1) -> float:
    """Feed speed of the tool against the workpiece.

    ``v_f = f_z · z · n``, [1]_ eq. (2), whose "mm/r" must read mm per tooth. With one tooth,
    the feed per tooth is the feed per revolution of turning and drilling.

    Parameters
    ----------
    feed_per_tooth : float, mm
    spindle_speed : float, rev/s
    teeth : int

    Returns
    -------
    float, mm/s

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    0.1 mm, 10 teeth, 500 rpm: 500 mm/min [2]_.

    >>> round(feed(0.1, 500 / 60, teeth=10) * 60, 9)
    500.0
    """
    require_positive(feed_per_tooth, "feed per tooth", "mm")
    require_positive(spindle_speed, "spindle speed", "rev/s")
    require_teeth(teeth)
    return feed_per_tooth * teeth * spindle_speed


def feed_per_tooth(feed: float, spindle_speed: float, *, teeth: int = 1) -> float:
    """Feed per tooth, the inverse of :func:`feed`; with one tooth, the feed per revolution.

    ``f_z = v_f / (z · n)``, [1]_ eq. (2).

    Parameters
    ----------
    feed : float, mm/s
    spindle_speed : float, rev/s
    teeth : int

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    120 mm/min at 500 rpm is 0.24 mm/rev [2]_.

    >>> round(feed_per_tooth(120 / 60, 500 / 60), 9)
    0.24
    """
    require_positive(feed, "feed", "mm/s")
    require_positive(spindle_speed, "spindle speed", "rev/s")
    require_teeth(teeth)
    return feed / (teeth * spindle_speed)


def milling_removal_rate(feed: float, *, axial_depth: float, radial_width: float) -> float:
    """Volume that a milling cutter removes per second.

    ``Q = a_p · a_e · v_f``, [3]_.

    Parameters
    ----------
    feed : float, mm/s
    axial_depth, radial_width : float, mm

    Returns
    -------
    float, mm³/s

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    >>> milling_removal_rate(5.0, axial_depth=3.0, radial_width=18.0)
    270.0
    """
    require_positive(feed, "feed", "mm/s")
    require_positive(axial_depth, "axial depth", "mm")
    require_positive(radial_width, "radial width", "mm")
    return axial_depth * radial_width * feed
