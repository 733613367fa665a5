"""Engagement of a milling cutter: angles and chip thickness.

The angle φ of a tooth is measured in the direction of rotation from the normal of the feed, so
that the chip has the thickness ``h = f_z · sin κ · sin φ``: conventional (up) milling enters at
φ = 0, climb (down) milling exits at φ = π. Scalars in mm and rad. The path of a tooth is
approximated by a circle, which is accurate while ``f_z`` is small compared with the diameter.

Approach, overrun and drill point length: travel of a tool beyond the machined length.

Scalars in mm.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eq. (1), Figs. 6 and 7. It lists the angles in degrees and divides
   by an angle in radians; here all are radians.
.. [2] Catalogue form of Sandvik and Palbit, ``h_m = 360·f_z·a_e·sin κ / (π·D·ω_e)``, ω_e in
   degrees.
.. [3] Mitsubishi Materials, "Technical information", cutting time of face milling.
.. [4] M. P. Groover, "Fundamentals of Modern Manufacturing", machining operations.
"""

from dataclasses import dataclass
from math import acos, asin, pi, sin, sqrt, tan

from simulator.physics.domain import (
    require_at_most,
    require_edge_angle,
    require_positive,
)

_ROUNDING = 1e-9  # share of the diameter by which a strip may extend beyond the cutter


@dataclass(frozen=True, slots=True, kw_only=True)
class Engagement:
    """Angular range in which a tooth cuts, 0 ≤ φ_st < φ_ex ≤ π."""

    entry_angle: float
    """Entry angle φ_st, rad."""
    exit_angle: float
    """Exit angle φ_ex, rad."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.entry_angle < self.exit_angle <= pi:
            raise ValueError(
                f"entry angle {self.entry_angle:g} rad and exit angle {self.exit_angle:g} rad "
                "must ascend and lie between 0 and π rad"
            )

    @property
    def contact_angle(self) -> float:
        """Contact angle φ_ex − φ_st, rad."""
        return self.exit_angle - self.entry_angle

    @property
    def cosine_difference(self) -> float:
        """Cosine difference ``C = cos φ_st − cos φ_ex``, 0 < C ≤ 2; always equals ``2·a_e/D``.

        Computed as a product of sines, which stays accurate for a narrow cut.
        """
        middle = 0.5 * (self.entry_angle + self.exit_angle)
        return 2.0 * sin(middle) * sin(0.5 * self.contact_angle)

    @property
    def greatest_sine(self) -> float:
        """Greatest sin φ on the arc: 1 if it includes φ = π/2."""
        if self.entry_angle <= pi / 2.0 <= self.exit_angle:
            return 1.0
        return max(sin(self.entry_angle), sin(self.exit_angle))


def full_immersion() -> Engagement:
    """Engagement of full immersion, as in a slot: φ from 0 to π, C = 2."""
    return Engagement(entry_angle=0.0, exit_angle=pi)


def unidirectional(radial_width: float, tool_diameter: float) -> Engagement:
    """Engagement of one side of the cutter in climb (down) milling.

    ``φ_ex = π``, ``φ_st = π − acos(1 − 2·a_e/D)``.

    Parameters
    ----------
    radial_width : float, mm
        Radial width 0 < a_e ≤ D.
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
    """Engagement of one side of the cutter in conventional (up) milling.

    ``φ_st = 0``, ``φ_ex = acos(1 − 2·a_e/D)``.

    Parameters
    ----------
    radial_width : float, mm
        Radial width 0 < a_e ≤ D.
    tool_diameter : float, mm

    Raises
    ------
    ValueError
        If the width is not positive or exceeds the diameter.
    """
    angle = _one_sided_angle(radial_width, tool_diameter)
    return Engagement(entry_angle=0.0, exit_angle=min(angle, pi))


def _one_sided_angle(radial_width: float, tool_diameter: float) -> float:
    """Contact angle ``acos(1 − 2x) = 2·asin(√x)``, in the form accurate for narrow cuts."""
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(radial_width, tool_diameter, thing="radial width", unit="mm")
    return 2.0 * asin(sqrt(radial_width / tool_diameter))


def bilateral(radial_width: float, tool_diameter: float, *, offset: float = 0.0) -> Engagement:
    """Engagement of the middle of the cutter, or of a strip beside it.

    ``cos φ_st = (2·e + a_e)/D``, ``cos φ_ex = (2·e − a_e)/D`` with e the distance from the
    cutter's axis to the middle of the strip, positive towards the side where teeth enter.

    Parameters
    ----------
    radial_width : float, mm
        Radial width 0 < a_e ≤ D.
    tool_diameter : float, mm
    offset : float, mm
        Distance e, ``|e| ≤ (D − a_e)/2``.

    Raises
    ------
    ValueError
        If the width is not positive or the strip extends beyond the cutter.

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
            f"strip extends {reach:g} mm from the axis; it must not exceed half the tool "
            f"diameter, {tool_diameter / 2.0:g} mm"
        )
    entry = acos(min((2.0 * offset + radial_width) / tool_diameter, 1.0))
    exit_ = acos(max((2.0 * offset - radial_width) / tool_diameter, -1.0))
    return Engagement(entry_angle=entry, exit_angle=exit_)


def mean_chip_thickness(
    feed_per_tooth: float, engagement: Engagement, *, cutting_edge_angle: float = pi / 2.0
) -> float:
    """Mean chip thickness over the contact angle, mm.

    ``h_m = f_z · sin κ · (cos φ_st − cos φ_ex) / (φ_ex − φ_st)``, [1]_ eq. (1) in radians; the
    same value as in [2]_.

    Parameters
    ----------
    feed_per_tooth : float, mm
    cutting_edge_angle : float, rad
        Cutting edge angle κ_r, π/2 for an end mill.

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
    """Ratio ``h_m / f_z``, at most 1; its inverse gives the feed for a required mean chip."""
    require_edge_angle(cutting_edge_angle)
    shape = engagement.cosine_difference / engagement.contact_angle
    return sin(cutting_edge_angle) * shape


def centred_approach(tool_diameter: float, radial_width: float) -> float:
    """Travel from first contact to full width when the cutter is centred on the face.

    ``A = D/2 − ½·√(D² − a_e²)``, [4]_: full immersion and centred bilateral face milling. The
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

    ``A = √(a_e · (D − a_e))`` up to half the diameter, [4]_: peripheral milling and
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
