"""Roughness that the shape and feed of a tool leave, and the feed that a roughness allows.

The ideal surface is what the edge draws; a real one is rougher by wear, vibration and built-up
edge, for which an empirical floor is added. Scalars, all in **mm**: print gives Ra, Rz and Rt
in µm with the feed in mm, hence its factor of 1000, which is absent here. Ball ends and the
side of a mill are in :mod:`.scallop`.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eqs. (9), (10), (12), (14). They are printed with the feed in
   mm/min, with R_a in the formula of R_t and with the inequality of (14) reversed. Here f is
   the feed per revolution, or the feed per tooth of a perfectly set cutter.
.. [2] Mitsubishi Materials, "Technical information", theoretical surface roughness.
"""

from math import sqrt

from simulator.physics.domain import (
    require_at_most,
    require_not_negative,
    require_positive,
)

RA_FLOOR = 0.2e-3  # mm; customary least Ra of careful turning and milling, no measurement
RZ_PER_RA = 4.0  # rule of thumb for turned and milled profiles; the ideal one has 9·√3/4 = 3.9


def peak_to_valley(feed: float, corner_radius: float) -> float:
    """Ideal peak-to-valley roughness of a round corner.

    ``R_t = f² / (8·r)``, [1]_ eq. (9) corrected, [2]_; the first term of
    ``r − √(r² − f²/4)``, 1.6 % low at f = r/2. R_t stands for Rz of an ideal profile.

    Parameters
    ----------
    feed : float, mm
        Per revolution, at most twice the radius.
    corner_radius : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the feed is so large that the corner leaves steps.

    Examples
    --------
    0.2 mm/rev and a 0.8 mm corner: 6.25 µm [2]_.

    >>> round(peak_to_valley(0.2, 0.8) * 1000, 6)
    6.25
    """
    require_positive(corner_radius, "corner radius", "mm")
    require_at_most(feed, 2.0 * corner_radius, thing="feed per revolution", unit="mm")
    return feed**2 / (8.0 * corner_radius)


def arithmetic_roughness(feed: float, corner_radius: float) -> float:
    """Ideal arithmetic roughness of a round corner.

    ``R_a = f² / (18·√3·r)``, [1]_ eq. (10) corrected: the exact mean deviation of a parabolic
    profile.

    Parameters
    ----------
    feed : float, mm
        Per revolution, at most twice the radius.
    corner_radius : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        As :func:`peak_to_valley`.

    Examples
    --------
    >>> round(arithmetic_roughness(0.2, 0.8) * 1000, 4)
    1.6038
    """
    require_positive(corner_radius, "corner radius", "mm")
    require_at_most(feed, 2.0 * corner_radius, thing="feed per revolution", unit="mm")
    return feed**2 / (18.0 * sqrt(3.0) * corner_radius)


def feed_for_peak_to_valley(roughness: float, corner_radius: float) -> float:
    """Greatest feed that keeps an ideal R_t: ``f = √(8·r·R_t)``.

    Parameters
    ----------
    roughness : float, mm
        R_t.
    corner_radius : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the roughness exceeds half the radius, beyond which the
        formula does not hold.

    Examples
    --------
    >>> round(feed_for_peak_to_valley(6.25e-3, 0.8), 9)
    0.2
    """
    require_positive(corner_radius, "corner radius", "mm")
    require_at_most(roughness, corner_radius / 2.0, thing="roughness Rt", unit="mm")
    return sqrt(8.0 * corner_radius * roughness)


def feed_for_arithmetic_roughness(roughness: float, corner_radius: float) -> float:
    """Greatest feed that keeps an ideal R_a: ``f = √(18·√3·r·R_a)``.

    What [1]_ eqs. (12) and (14) mean: quality caps the feed.

    Parameters
    ----------
    roughness : float, mm
        R_a.
    corner_radius : float, mm

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is not positive or the roughness is beyond the formula.

    Examples
    --------
    Ra 1.6 µm with a 0.8 mm corner allows 0.1998 mm/rev.

    >>> round(feed_for_arithmetic_roughness(1.6e-3, 0.8), 4)
    0.1998
    """
    require_positive(corner_radius, "corner radius", "mm")
    greatest = 4.0 * corner_radius / (18.0 * sqrt(3.0))
    require_at_most(roughness, greatest, thing="roughness Ra", unit="mm")
    return sqrt(18.0 * sqrt(3.0) * corner_radius * roughness)


def real_roughness(ideal: float, *, floor: float = RA_FLOOR) -> float:
    """Roughness to expect: the ideal one plus what the process adds.

    ``R_a = R_a,ideal + floor``.

    Parameters
    ----------
    ideal : float, mm
    floor : float, mm
        What remains as the feed vanishes; measure it on the machine.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If either is negative.

    Examples
    --------
    >>> round(real_roughness(1.6e-3) * 1000, 3)
    1.8
    """
    require_not_negative(ideal, "ideal roughness", "mm")
    require_not_negative(floor, "roughness floor", "mm")
    return ideal + floor


def ideal_share(roughness: float, *, floor: float = RA_FLOOR) -> float:
    """Ideal roughness that may be left to the feed when so much is allowed in all.

    Inverse of :func:`real_roughness`.

    Parameters
    ----------
    roughness : float, mm
    floor : float, mm

    Returns
    -------
    float, mm
        Positive.

    Raises
    ------
    ValueError
        If the roughness asked for is not above the floor: no feed can reach it.
    """
    require_not_negative(floor, "roughness floor", "mm")
    if roughness <= floor:
        raise ValueError(
            f"roughness {roughness:g} mm must be greater than the floor of the process, "
            f"{floor:g} mm"
        )
    return roughness - floor


def ra_from_rz(roughness: float) -> float:
    """R_a ≈ R_z / 4, mm from mm; real profiles scatter between 1/3 and 1/7."""
    require_not_negative(roughness, "roughness Rz", "mm")
    return roughness / RZ_PER_RA


def rz_from_ra(roughness: float) -> float:
    """R_z ≈ 4·R_a, mm from mm; inverse of :func:`ra_from_rz`."""
    require_not_negative(roughness, "roughness Ra", "mm")
    return roughness * RZ_PER_RA
