"""Forces of a milling cutter as means over a revolution.

Forces within a revolution, along the helix, are in :mod:`simulator.physics.tooth_forces`.
Scalars in mm, N and rad.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eq. (4), after H. El-Hofy, "Fundamentals of Machining Processes".
   It is the sum over all teeth, averaged over a revolution, and needs f_s in mm/min with n in
   rpm; k_s is a constant there and k_c(h_m) here.
.. [2] "Milling force model for aviation aluminum alloy: academic insight and perspective
   analysis", Chin. J. Mech. Eng., 2021, Table 5, doi:10.1186/s10033-021-00536-9.
"""

from dataclasses import dataclass
from math import pi

from simulator.physics.cutting import specific_cutting_force
from simulator.physics.domain import require_edge_angle, require_positive, require_teeth
from simulator.physics.engagement import (
    Engagement,
    mean_chip_thickness,
)
from simulator.spec import Kienzle

RADIAL_SHARE = 0.3
"""Ratio F_r/F_t if only k_c is known: median of K_rc/K_tc of seven measurements on aluminium
in [2]_, which lie between 0.16 and 0.60."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MillingCut:
    """Cut of a milling cutter."""

    feed_per_tooth: float
    """Feed per tooth f_z, mm."""
    teeth: int
    """Number of teeth z."""
    axial_depth: float
    """Axial depth of cut a_p, mm."""
    engagement: Engagement
    cutting_edge_angle: float = pi / 2.0
    """Cutting edge angle κ_r, rad."""

    def __post_init__(self) -> None:
        require_positive(self.feed_per_tooth, "feed per tooth", "mm")
        require_teeth(self.teeth)
        require_positive(self.axial_depth, "axial depth", "mm")
        require_edge_angle(self.cutting_edge_angle)

    @property
    def mean_chip_thickness(self) -> float:
        """Mean chip thickness h_m, mm, [1]_ eq. (1)."""
        return mean_chip_thickness(
            self.feed_per_tooth, self.engagement, cutting_edge_angle=self.cutting_edge_angle
        )


def mean_specific_force(kienzle: Kienzle, cut: MillingCut, *, factor: float = 1.0) -> float:
    """Specific cutting force at the mean chip thickness, ``K · k_c1.1 · h_m^(−m_c)``.

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

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
        cut.mean_chip_thickness, k_c11=kienzle.k_c11, m_c=kienzle.m_c
    )


def mean_force(kienzle: Kienzle, cut: MillingCut, *, factor: float = 1.0) -> float:
    """Tangential force of all teeth, averaged over a revolution.

    ``F_mt = k_c · a_p · z·f_z · C / 2π`` with ``C = cos φ_st − cos φ_ex``, [1]_ eq. (4). With
    the cutting speed it gives the cutting power exactly (``F_mt·v_c = k_c·Q``).

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the factor is not positive.

    Examples
    --------
    El-Hofy's example, printed as 1019 N: 120 mm/min at 150 rpm is 0.8 mm per revolution.

    >>> from simulator.physics.engagement import full_immersion
    >>> slot = MillingCut(
    ...     feed_per_tooth=0.8, teeth=1, axial_depth=4.0, engagement=full_immersion()
    ... )
    >>> round(mean_force(Kienzle(k_c11=1000.0, m_c=0.0), slot), 1)
    1018.6
    """
    k_c = mean_specific_force(kienzle, cut, factor=factor)
    feed_per_revolution = cut.teeth * cut.feed_per_tooth
    share = cut.engagement.cosine_difference / (2.0 * pi)
    return k_c * cut.axial_depth * feed_per_revolution * share
