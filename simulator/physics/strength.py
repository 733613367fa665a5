"""Strength of a slender tool: deflection and bending stress of a clamped shank.

The tool is a beam clamped at the holder, with the force across its tip; this is conservative
because the force acts slightly above the tip. Holder and spindle are assumed to be rigid,
although their compliance often equals the tool's. Scalars in mm, N and N/mm².

References
----------
.. [1] L. Kops and D. T. Vo, "Determination of the equivalent diameter of an end mill based on
   its compliance", CIRP Annals 39(1), 1990: about 80 % of the diameter, for two and four
   flutes.
"""

from dataclasses import dataclass
from math import pi

from simulator.physics.domain import (
    require_at_most,
    require_not_negative,
    require_positive,
)

STICK_OUT = 3.0
"""Least overhang over diameter of an end mill whose overhang nothing states, customary."""

FLUTED_RATIO = 0.8  # equivalent over nominal diameter of the fluted part, [1]; customary


@dataclass(frozen=True, slots=True, kw_only=True)
class Cantilever:
    """Tool as a beam of two parts: flutes at the tip, shank at the holder."""

    overhang: float
    """Overhang L from holder to tip, mm."""
    flute_length: float
    """Length of the flutes from the tip, mm, at most the overhang; 0 for a plain bar."""
    flute_diameter: float
    """Equivalent diameter of the fluted part, mm; see :func:`equivalent_diameter`."""
    shank_diameter: float
    """Diameter of the shank, mm."""
    youngs_modulus: float
    """Young's modulus E, N/mm²."""

    def __post_init__(self) -> None:
        require_positive(self.overhang, "overhang", "mm")
        require_not_negative(self.flute_length, "flute length", "mm")
        if self.flute_length > self.overhang:
            raise ValueError(
                f"flute length {self.flute_length:g} mm must be at most the overhang, "
                f"{self.overhang:g} mm"
            )
        require_positive(self.flute_diameter, "flute diameter", "mm")
        require_positive(self.shank_diameter, "shank diameter", "mm")
        require_positive(self.youngs_modulus, "Young's modulus", "N/mm²")

    @property
    def compliance(self) -> float:
        """Deflection of the tip under 1 N, mm/N.

        ``(L_f³/I_f + (L³ − L_f³)/I_s) / 3E``; with a single diameter this is ``L³/(3·E·I)``.
        """
        flutes = self.flute_length**3 / second_moment(self.flute_diameter)
        rest = self.overhang**3 - self.flute_length**3
        return (flutes + rest / second_moment(self.shank_diameter)) / (3 * self.youngs_modulus)

    def stress(self, force: float) -> float:
        """Greatest bending stress under a force across the tip, N/mm².

        Either at the holder or where the flutes end, whichever is greater; both from
        :func:`bending_stress`.
        """
        at_holder = bending_stress(force, overhang=self.overhang, diameter=self._root_diameter)
        if self.flute_length == 0.0:
            return at_holder
        at_flutes = bending_stress(
            force, overhang=self.flute_length, diameter=self.flute_diameter
        )
        return max(at_holder, at_flutes)

    @property
    def _root_diameter(self) -> float:
        """Diameter at the holder: that of the flutes if they reach it."""
        fluted = self.flute_length == self.overhang
        return self.flute_diameter if fluted else self.shank_diameter


def end_mill(
    tool_diameter: float,
    *,
    cutting_edge_length: float | None,
    youngs_modulus: float,
    overhang: float | None = None,
) -> Cantilever:
    """Cantilever of an end mill at its stated overhang, or at the customary one.

    Parameters
    ----------
    tool_diameter : float, mm
    cutting_edge_length : float, optional, mm
    youngs_modulus : float, N/mm²
    overhang : float, optional, mm
        Stated distance from the tip to the holder.

    Raises
    ------
    ValueError
        If an argument is not positive.
    """
    if overhang is None:
        overhang = customary_overhang(tool_diameter, cutting_edge_length)
    return _plain(overhang, equivalent_diameter(tool_diameter), youngs_modulus)


def customary_overhang(tool_diameter: float, cutting_edge_length: float | None) -> float:
    """Overhang of an end mill of which none is stated: 3 D, or its edge length if longer, mm.

    Examples
    --------
    >>> customary_overhang(10.0, None)
    30.0
    """
    return max(STICK_OUT * tool_diameter, cutting_edge_length or 0.0)


def equivalent_diameter(tool_diameter: float, *, ratio: float = FLUTED_RATIO) -> float:
    """Diameter of the round bar that bends like a fluted end mill.

    ``d_eq = 0.8 · D``, [1]_.

    Parameters
    ----------
    tool_diameter : float, mm
    ratio : float
        Ratio of the diameters, 0 < ratio ≤ 1.

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If the diameter is not positive or the ratio out of range.

    Examples
    --------
    >>> equivalent_diameter(10.0)
    8.0
    """
    require_positive(tool_diameter, "tool diameter", "mm")
    require_at_most(ratio, 1.0, thing="ratio of equivalent diameter", unit="")
    return ratio * tool_diameter


def second_moment(diameter: float) -> float:
    """Second moment of area of a round bar: ``I = π·d⁴/64``, mm⁴.

    Raises
    ------
    ValueError
        If the diameter is not positive.

    Examples
    --------
    >>> round(second_moment(8.0), 2)
    201.06
    """
    require_positive(diameter, "diameter", "mm")
    return pi * diameter**4 / 64.0


def deflection(
    force: float, *, overhang: float, diameter: float, youngs_modulus: float
) -> float:
    """Deflection of the tip of a uniform bar: ``δ = F·L³ / (3·E·I)``.

    Parameters
    ----------
    force : float, N
        Force across the axis.
    overhang : float, mm
    diameter : float, mm
        Equivalent diameter for a fluted tool.
    youngs_modulus : float, N/mm²

    Returns
    -------
    float, mm

    Raises
    ------
    ValueError
        If the force is negative or another value is not positive.

    Examples
    --------
    Ø10 carbide end mill, 40 mm out, 300 N:

    >>> d_eq = equivalent_diameter(10.0)
    >>> round(deflection(300.0, overhang=40.0, diameter=d_eq, youngs_modulus=600e3), 4)
    0.0531
    """
    require_not_negative(force, "force", "N")
    bar = _plain(overhang, diameter, youngs_modulus)
    return force * bar.compliance


def _plain(overhang: float, diameter: float, youngs_modulus: float) -> Cantilever:
    """Cantilever of a bar with one diameter."""
    return Cantilever(
        overhang=overhang,
        flute_length=0.0,
        flute_diameter=diameter,
        shank_diameter=diameter,
        youngs_modulus=youngs_modulus,
    )


def bending_stress(force: float, *, overhang: float, diameter: float) -> float:
    """Greatest bending stress of a round bar: ``σ = 32·F·L / (π·d³)``.

    Parameters
    ----------
    force : float, N
    overhang, diameter : float, mm

    Returns
    -------
    float, N/mm²

    Raises
    ------
    ValueError
        If the force is negative or a length is not positive.

    Examples
    --------
    >>> round(bending_stress(300.0, overhang=40.0, diameter=8.0), 1)
    238.7
    """
    require_not_negative(force, "force", "N")
    require_positive(overhang, "overhang", "mm")
    require_positive(diameter, "diameter", "mm")
    return 32.0 * force * overhang / (pi * diameter**3)
