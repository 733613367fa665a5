"""Torque and thrust of tools that cut on their end: drills, reamers, boring bars, sinks.

Each lip cuts a chip of thickness ``h = f/z·sin κ`` and width ``b = (D − d)/(2·sin κ)``, κ half
the point angle, d the hole that was there. The chisel edge is not modelled; it adds to the
thrust of an unthinned drill, for which [2]_ gives three times the thrust and four tenths more
torque (Ø10, 0.2 mm, low-carbon steel). Scalars in mm, N, N·mm and rad.

References
----------
.. [1] Sandvik Coromant, technical guide, drilling formulae:
   ``P_c = f·v_c·D·k_c/(240·10³)`` in kW and ``F_f ≈ 0.5·k_c·D/2·f·sin κ``.
.. [2] Tungaloy, general catalogue 2020-2021, p. L068: ``M_c = K·D²·(0.630 + 16.84·f)/100`` in
   N·m and ``T_c = 570·K·D·f^0.85`` in N.
"""

from dataclasses import dataclass
from math import sin

from simulator.physics.cutting import specific_cutting_force
from simulator.physics.domain import (
    require_edge_angle,
    require_hole,
    require_positive,
    require_teeth,
)
from simulator.spec import Kienzle
from stepnc_model.units import rad_from_deg

CUSTOMARY_EDGE_ANGLE = rad_from_deg(59.0)  # half of the customary point angle of 118°
THRUST_SHARE = 0.5  # [1]; other catalogues take 0.7


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillingCut:
    """What a drill, reamer or boring bar cuts."""

    feed_per_revolution: float
    """f, mm"""
    tool_diameter: float
    """D, mm"""
    previous_diameter: float = 0.0
    """d, mm; 0 in the solid"""
    teeth: int = 2
    """lips z"""
    cutting_edge_angle: float = CUSTOMARY_EDGE_ANGLE
    """κ, half the point angle, rad; π/2 for a boring bar"""

    def __post_init__(self) -> None:
        require_positive(self.feed_per_revolution, "feed per revolution", "mm")
        require_hole(self.tool_diameter, self.previous_diameter)
        require_teeth(self.teeth)
        require_edge_angle(self.cutting_edge_angle)

    @property
    def chip_thickness(self) -> float:
        """``h = f/z · sin κ`` in mm."""
        return self.feed_per_revolution / self.teeth * sin(self.cutting_edge_angle)

    @property
    def chip_width(self) -> float:
        """``b = (D − d) / (2·sin κ)`` of one lip in mm."""
        depth = 0.5 * (self.tool_diameter - self.previous_diameter)
        return depth / sin(self.cutting_edge_angle)


def drilling_specific_force(
    kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0
) -> float:
    """Specific cutting force on the lips, ``K · k_c1.1 · h^(−m_c)``.

    Parameters
    ----------
    kienzle : Kienzle
    cut : DrillingCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N/mm²

    Raises
    ------
    ValueError
        If the factor is not positive.
    """
    require_positive(factor, "force factor", "")
    return factor * specific_cutting_force(
        cut.chip_thickness, k_c11=kienzle.k_c11, m_c=kienzle.m_c
    )


def drilling_torque(kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0) -> float:
    """Torque of all lips about the axis.

    ``M_c = k_c · f · (D² − d²) / 8``: z chips of area ``b·h`` at the middle of their lips,
    ``(D + d)/4`` from the axis. Times ``2π·n`` it is ``k_c·Q``, and for d = 0 the power of
    [1]_.

    Parameters
    ----------
    kienzle : Kienzle
    cut : DrillingCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N·mm

    Raises
    ------
    ValueError
        If the factor is not positive.

    Examples
    --------
    >>> hole = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0)
    >>> drilling_torque(Kienzle(k_c11=2000.0, m_c=0.0), hole)
    5000.0
    """
    k_c = drilling_specific_force(kienzle, cut, factor=factor)
    section = cut.tool_diameter**2 - cut.previous_diameter**2
    return k_c * cut.feed_per_revolution * section / 8.0


def drilling_thrust(
    kienzle: Kienzle,
    cut: DrillingCut,
    *,
    factor: float = 1.0,
    thrust_share: float = THRUST_SHARE,
) -> float:
    """Force along the axis.

    ``F_f = s · k_c · f · (D − d)/2 · sin κ`` with s = 0.5, [1]_.

    Parameters
    ----------
    kienzle : Kienzle
    cut : DrillingCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.
    thrust_share : float
        s, dimensionless.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If factor or share is not positive.

    Examples
    --------
    >>> from math import pi
    >>> hole = DrillingCut(
    ...     feed_per_revolution=0.2, tool_diameter=10.0, cutting_edge_angle=pi / 2
    ... )
    >>> drilling_thrust(Kienzle(k_c11=2000.0, m_c=0.0), hole)
    1000.0
    """
    require_positive(thrust_share, "thrust share", "")
    k_c = drilling_specific_force(kienzle, cut, factor=factor)
    depth = 0.5 * (cut.tool_diameter - cut.previous_diameter)
    return thrust_share * k_c * cut.feed_per_revolution * depth * sin(cut.cutting_edge_angle)
