"""The linear-edge law: a shearing share that follows the chip, a rubbing share that does not.

``F = K_tc·b·h + K_te·b``. Scalars in mm, N, N/mm² and N/mm.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: linear-edge law and its mean
   over a revolution.
"""

from math import pi

from simulator.physics.domain import require_not_negative, require_positive
from simulator.physics.milling import MillingCut
from simulator.spec import LinearEdge


def edge_chip_force(
    edge: LinearEdge, *, chip_thickness: float, chip_width: float, factor: float = 1.0
) -> float:
    """Tangential force of one chip by the linear-edge law.

    ``F_t = K · (K_tc · b · h + K_te · b)``, [1]_: the second term rubs and does not vanish with
    the feed.

    Parameters
    ----------
    edge : LinearEdge
    chip_thickness, chip_width : float, mm
        The thickness may be 0.
    factor : float
        K of :class:`ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the thickness is negative, or width or factor is not positive.

    Examples
    --------
    >>> steel = LinearEdge(k_tc=2000.0, k_te=30.0)
    >>> edge_chip_force(steel, chip_thickness=0.1, chip_width=2.0)
    460.0
    """
    require_not_negative(chip_thickness, "chip thickness", "mm")
    require_positive(chip_width, "chip width", "mm")
    require_positive(factor, "force factor", "")
    return factor * chip_width * (edge.k_tc * chip_thickness + edge.k_te)


def edge_mean_force(edge: LinearEdge, cut: MillingCut, *, factor: float = 1.0) -> float:
    """Tangential force of all teeth by the linear-edge law, averaged over a revolution.

    ``F_t = K · z/2π · (K_tc · a_p · f_z · C + K_te · b · (φ_ex − φ_st))``, [1]_ integrated over
    the arc; in a slot ``z·a_p·(K_tc·f_z/π + K_te/2)``.

    Parameters
    ----------
    edge : LinearEdge
    cut : MillingCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the factor is not positive.

    Examples
    --------
    >>> from simulator.physics.engagement import full_immersion
    >>> slot = MillingCut(
    ...     feed_per_tooth=0.1, teeth=4, axial_depth=2.0, engagement=full_immersion()
    ... )
    >>> round(edge_mean_force(LinearEdge(k_tc=767.01, k_te=27.7), slot), 2)
    306.12
    """
    require_positive(factor, "force factor", "")
    arc = cut.engagement
    shear = edge.k_tc * cut.axial_depth * cut.feed_per_tooth * arc.cosine_difference
    rubbing = edge.k_te * cut.chip_width * arc.contact_angle
    return factor * cut.teeth / (2.0 * pi) * (shear + rubbing)


def edge_peak_tooth_force(edge: LinearEdge, cut: MillingCut, *, factor: float = 1.0) -> float:
    """Tangential force of one tooth by the linear-edge law where its chip is thickest.

    ``F_t = K · b · (K_tc · h_max + K_te)``, [1]_.

    Parameters
    ----------
    edge : LinearEdge
    cut : MillingCut
    factor : float
        K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the factor is not positive.
    """
    require_positive(factor, "force factor", "")
    return factor * cut.chip_width * (edge.k_tc * cut.greatest_chip_thickness + edge.k_te)
