"""Engagement of a milling cutter: angles and chip thickness.

The angle φ of a tooth is counted in the direction of rotation from the normal to the feed, so
that the chip is ``h = f_z · sin κ · sin φ`` thick: conventional (up) milling enters at φ = 0,
climb (down) milling leaves at φ = π. Scalars in mm and rad. The path of a tooth is taken as a
circle: good while ``f_z`` is small against the diameter.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eq. (1), Figs. 6 and 7. It lists the angles in degrees and divides
   by an angle in radians; here all are radians.
.. [2] Catalogue form of Sandvik and Palbit, ``h_m = 360·f_z·a_e·sin κ / (π·D·ω_e)``, ω_e in
   degrees.
"""

from dataclasses import dataclass
from math import acos, asin, pi, sin, sqrt

from simulator.physics.domain import (
    require_at_most,
    require_edge_angle,
    require_positive,
)

_ROUNDING = 1e-9  # share of the diameter by which a strip may reach beyond the cutter


@dataclass(frozen=True, slots=True, kw_only=True)
class Engagement:
    """Part of the circle in which a tooth cuts, 0 ≤ φ_st < φ_ex ≤ π."""

    entry_angle: float
    """φ_st, rad"""
    exit_angle: float
    """φ_ex, rad"""

    def __post_init__(self) -> None:
        if not 0.0 <= self.entry_angle < self.exit_angle <= pi:
            raise ValueError(
                f"entry angle {self.entry_angle:g} rad and exit angle {self.exit_angle:g} rad "
                "must ascend and lie between 0 and π rad"
            )

    @property
    def contact_angle(self) -> float:
        """φ_ex − φ_st in rad."""
        return self.exit_angle - self.entry_angle

    @property
    def cosine_difference(self) -> float:
        """``C = cos φ_st − cos φ_ex``, 0 < C ≤ 2; equals ``2·a_e/D`` for every position.

        Written as a product of sines, which loses no digits for a narrow cut.
        """
        middle = 0.5 * (self.entry_angle + self.exit_angle)
        return 2.0 * sin(middle) * sin(0.5 * self.contact_angle)

    @property
    def greatest_sine(self) -> float:
        """Greatest sin φ on the arc: 1 when it holds φ = π/2."""
        if self.entry_angle <= pi / 2.0 <= self.exit_angle:
            return 1.0
        return max(sin(self.entry_angle), sin(self.exit_angle))


def full_immersion() -> Engagement:
    """Full immersion, a slot: φ from 0 to π, C = 2."""
    return Engagement(entry_angle=0.0, exit_angle=pi)


def unidirectional(radial_width: float, tool_diameter: float) -> Engagement:
    """One side of the cutter, climb (down) milling.

    ``φ_ex = π``, ``φ_st = π − acos(1 − 2·a_e/D)``.

    Parameters
    ----------
    radial_width : float, mm
        0 < a_e ≤ D.
    tool_diameter : float, mm

    Raises
    ------
    ValueError
        If the width is not positive or exceeds the diameter.

    Examples
    --------
    >>> round(unidirectional(15.0, 20.0).contact_angle * 180 / pi, 6)
    120.0
    """
    angle = _one_sided_angle(radial_width, tool_diameter)
    return Engagement(entry_angle=max(pi - angle, 0.0), exit_angle=pi)


def conventional(radial_width: float, tool_diameter: float) -> Engagement:
    """One side of the cutter, conventional (up) milling.

    ``φ_st = 0``, ``φ_ex = acos(1 − 2·a_e/D)``.

    Parameters
    ----------
    radial_width : float, mm
        0 < a_e ≤ D.
    tool_diameter : float, mm

    Raises
    ------
    ValueError
        If the width is not positive or exceeds the diameter.
    """
    angle = _one_sided_angle(radial_width, tool_diameter)
    return Engagement(entry_angle=0.0, exit_angle=min(angle, pi))


def _one_sided_angle(radial_width: float, tool_diameter: float) -> float:
    """``acos(1 − 2x) = 2·asin(√x)``; the right side keeps its digits for a narrow cut."""
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(radial_width, tool_diameter, thing="radial width", unit="mm")
    return 2.0 * asin(sqrt(radial_width / tool_diameter))


def bilateral(radial_width: float, tool_diameter: float, *, offset: float = 0.0) -> Engagement:
    """The middle of the cutter, or a strip beside it.

    ``cos φ_st = (2·e + a_e)/D``, ``cos φ_ex = (2·e − a_e)/D`` with e the distance from the
    cutter's axis to the middle of the strip, positive to the side where teeth enter.

    Parameters
    ----------
    radial_width : float, mm
        0 < a_e ≤ D.
    tool_diameter : float, mm
    offset : float, mm
        ``|e| ≤ (D − a_e)/2``.

    Raises
    ------
    ValueError
        If the width is not positive or the strip reaches beyond the cutter.

    Examples
    --------
    >>> round(bilateral(10.0, 20.0).contact_angle * 180 / pi, 6)
    60.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(radial_width, tool_diameter, thing="radial width", unit="mm")
    reach = abs(offset) + radial_width / 2.0
    if reach > tool_diameter / 2.0 * (1.0 + _ROUNDING):
        raise ValueError(
            f"strip reaching {reach:g} mm from the axis must be at most half the tool "
            f"diameter, {tool_diameter / 2.0:g} mm"
        )
    entry = acos(min((2.0 * offset + radial_width) / tool_diameter, 1.0))
    exit_ = acos(max((2.0 * offset - radial_width) / tool_diameter, -1.0))
    return Engagement(entry_angle=entry, exit_angle=exit_)


def mean_chip_thickness(
    feed_per_tooth: float, engagement: Engagement, *, cutting_edge_angle: float = pi / 2.0
) -> float:
    """Chip thickness averaged over the angle of contact.

    ``h_m = f_z · sin κ · (cos φ_st − cos φ_ex) / (φ_ex − φ_st)``, [1]_ eq. (1) in radians; the
    same number as [2]_.

    Parameters
    ----------
    feed_per_tooth : float, mm
    engagement : Engagement
    cutting_edge_angle : float, rad
        κ_r, π/2 for an end mill.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If the feed is not positive or the edge angle is outside (0, π).

    Examples
    --------
    >>> round(mean_chip_thickness(0.1, unidirectional(15.0, 20.0)), 5)
    0.07162
    """
    require_positive(feed_per_tooth, "feed per tooth", "mm")
    return feed_per_tooth * mean_chip_ratio(engagement, cutting_edge_angle=cutting_edge_angle)


def mean_chip_ratio(engagement: Engagement, *, cutting_edge_angle: float = pi / 2.0) -> float:
    """``h_m / f_z``, at most 1; its inverse gives the feed for a wanted mean chip."""
    require_edge_angle(cutting_edge_angle)
    shape = engagement.cosine_difference / engagement.contact_angle
    return sin(cutting_edge_angle) * shape
