"""Force of a chip: Kienzle's law and its corrections.

A chip of width b and thickness h causes the force ``F = K·k_c1.1·b·h^(1−m_c)``. Scalars in mm,
N, N/mm² and rad. Without calibration the uncertainty is about ±20 %: catalogues differ by that
much for the same steel. The effect of wear is in :mod:`simulator.physics.flank`.

References
----------
.. [1] O. Kienzle, "Die Bestimmung von Kräften und Leistungen an spanenden Werkzeugen und
   Werkzeugmaschinen", VDI-Z, 1952.
.. [2] H. Tschätsch and J. Dietrich, "Praxis der Zerspantechnik": correction factors.
.. [3] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eq. (4) takes k_s constant, which is m_c = 0 here.
"""

from dataclasses import dataclass

from simulator.physics.domain import (
    require_at_most,
    require_not_negative,
    require_positive,
)
from simulator.spec import CuttingMaterial, Kienzle
from stepnc_model.units import NMM_S_PER_WATT, deg_from_rad

SPEED_FACTORS = {
    CuttingMaterial.CARBIDE: 1.0,  # [2]; tabulated k_c1.1 is measured with carbide
    CuttingMaterial.HSS: 1.2,  # [2]; at its lower speed the work material is stronger
    CuttingMaterial.CERAMIC: 1.0,  # no value in the sources: not corrected
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceCorrection:
    """Correction factors on k_c for rake and speed; 1 for the conditions of measurement."""

    rake: float = 1.0
    """Factor K_γ of the rake angle."""
    speed: float = 1.0
    """Factor K_v of the cutting speed."""

    def __post_init__(self) -> None:
        require_positive(self.rake, "rake factor", "")
        require_positive(self.speed, "speed factor", "")

    @property
    def factor(self) -> float:
        """Combined correction factor ``K = K_γ · K_v``."""
        return self.rake * self.speed


def rake_factor(rake_angle: float, reference_rake: float) -> float:
    """Factor of the rake angle: one degree more reduces the force by one per cent.

    ``K_γ = 1 − (γ − γ₀)/100`` with the angles in **degrees**, [2]_; converted here from rad.
    Applicable to differences up to about 20°.

    Parameters
    ----------
    rake_angle : float, rad
        Rake angle γ of the tool in use.
    reference_rake : float, rad
        Rake angle γ₀ of the tool with which k_c1.1 was measured.

    Returns
    -------
    float
        Dimensionless.

    Raises
    ------
    ValueError
        If the difference is so large that the factor is not positive.

    Examples
    --------
    >>> from stepnc_model.units import rad_from_deg
    >>> round(rake_factor(rad_from_deg(12.0), rad_from_deg(6.0)), 3)
    0.94
    """
    factor = 1.0 - deg_from_rad(rake_angle - reference_rake) / 100.0
    require_positive(factor, "rake factor", "")
    return factor


def speed_factor(cutting_material: CuttingMaterial) -> float:
    """Factor of the cutting material and its usual speed, [2]_: carbide 1.0, HSS 1.2."""
    return SPEED_FACTORS[cutting_material]


def specific_cutting_force(chip_thickness: float, *, k_c11: float, m_c: float) -> float:
    """Specific cutting force of a chip of thickness h.

    ``k_c = k_c1.1 · h^(−m_c)`` with h in mm, [1]_. Tables are measured between about 0.05 and
    1 mm; below, k_c rises faster because of the edge rounding.

    Parameters
    ----------
    chip_thickness : float, mm
    k_c11 : float, N/mm²
        Specific cutting force at b = h = 1 mm.
    m_c : float
        Kienzle exponent, 0 ≤ m_c < 1; 0 keeps k_c constant, as [3]_ does.

    Returns
    -------
    float, N/mm²

    Raises
    ------
    ValueError
        If thickness or k_c1.1 is not positive or the exponent is out of range.

    Examples
    --------
    >>> specific_cutting_force(1.0, k_c11=1500.0, m_c=0.22)
    1500.0
    >>> round(specific_cutting_force(0.011319, k_c11=1500.0, m_c=0.22))
    4020
    """
    require_positive(chip_thickness, "chip thickness", "mm")
    require_positive(k_c11, "k_c1.1", "N/mm²")
    if not 0.0 <= m_c < 1.0:
        raise ValueError(f"Kienzle exponent {m_c:g} must be at least 0 and less than 1")
    return float(k_c11 * chip_thickness**-m_c)


def chip_stiffness(chip_thickness: float, *, k_c11: float, m_c: float) -> float:
    """Slope of Kienzle's law: increase of the force per mm of width and mm of thickness.

    ``dF/(b·dh) = (1 − m_c)·k_c1.1·h^(−m_c)``, from [1]_; smaller than k_c by the share m_c.
    This slope, not k_c itself, gives the response to surface waves, like K_tc in the
    linear-edge law.

    Parameters
    ----------
    chip_thickness : float, mm
    k_c11 : float, N/mm²
    m_c : float

    Returns
    -------
    float, N/mm²

    Raises
    ------
    ValueError
        As for :func:`specific_cutting_force`.

    Examples
    --------
    >>> chip_stiffness(1.0, k_c11=1500.0, m_c=0.22)
    1170.0
    """
    return (1.0 - m_c) * specific_cutting_force(chip_thickness, k_c11=k_c11, m_c=m_c)


def chip_force(
    kienzle: Kienzle, *, chip_thickness: float, chip_width: float, factor: float = 1.0
) -> float:
    """Force of one chip by Kienzle's law.

    ``F = K · k_c1.1 · b · h^(1−m_c)``, [1]_. With their own constants it also gives the feed
    force and the back force.

    Parameters
    ----------
    kienzle : Kienzle
        Constants of the required force.
    chip_thickness, chip_width : float, mm
    factor : float
        Factor K of :class:`ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If an argument is not positive.

    Examples
    --------
    >>> chip_force(Kienzle(k_c11=1500.0, m_c=0.22), chip_thickness=1.0, chip_width=2.0)
    3000.0
    """
    require_positive(chip_width, "chip width", "mm")
    require_positive(factor, "force factor", "")
    k_c = specific_cutting_force(chip_thickness, k_c11=kienzle.k_c11, m_c=kienzle.m_c)
    return factor * k_c * chip_width * chip_thickness


def cutting_power(force: float, cutting_speed: float) -> float:
    """Power of a tangential force at a cutting speed.

    ``P_c = F_c · v_c / 1000``, [1]_ eq. (5); the 1000 converts N·mm/s to W.

    Parameters
    ----------
    force : float, N
        Force along the cutting speed; in milling its mean over a revolution.
    cutting_speed : float, mm/s

    Returns
    -------
    float, W

    Raises
    ------
    ValueError
        If the force is negative or the speed not positive.

    Examples
    --------
    447.4 N at 35 m/min are the 261 W of the worked case of [1]_:

    >>> round(cutting_power(447.43, 35_000 / 60), 1)
    261.0
    """
    require_not_negative(force, "force", "N")
    require_positive(cutting_speed, "cutting speed", "mm/s")
    return force * cutting_speed / NMM_S_PER_WATT


def motor_power(cutting_power: float, efficiency: float) -> float:
    """Motor power that a cutting power requires.

    ``P = P_c / η``, [1]_ eq. (6).

    Parameters
    ----------
    cutting_power : float, W
    efficiency : float
        Efficiency η, 0 < η ≤ 1.

    Returns
    -------
    float, W

    Raises
    ------
    ValueError
        If the power is negative or the efficiency out of range.

    Examples
    --------
    >>> round(motor_power(261.0, 0.9), 9)
    290.0
    """
    require_not_negative(cutting_power, "cutting power", "W")
    require_at_most(efficiency, 1.0, thing="efficiency", unit="")
    return cutting_power / efficiency
