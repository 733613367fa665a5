"""Life of a cutting edge, and its wear up to the end of life.

Scalars in mm, s and mm/s. Taylor's constant keeps its usual meaning, the speed for a life of
one **minute**; the functions convert to seconds.

References
----------
.. [1] F. W. Taylor, "On the art of cutting metals", Trans. ASME, 1907: ``v_c · T^n = C``.
.. [2] ISO 3685: end of life at a flank wear of 0.3 mm.
"""

from math import pow, sqrt

from simulator.physics.domain import require_positive
from simulator.spec import CuttingMaterial, CuttingWindow, Taylor
from stepnc_model.units import SECONDS_PER_MINUTE

LIFE_CRITERION = 0.3  # mm, VB_B, [2]

ASSUMED_LIFE = 15.0  # min, for which catalogues usually state their cutting speeds
ASSUMED_EXPONENT = {
    CuttingMaterial.HSS: 0.125, CuttingMaterial.CARBIDE: 0.25, CuttingMaterial.CERAMIC: 0.6,
}  # fmt: skip
"""Customary n by cutting material, the prior means of ``calibrate --table``."""


def assumed_life(window: CuttingWindow) -> Taylor | None:
    """Taylor's law assumed where none is known: 15 min in the middle of the catalogue's speeds.

    Right within a factor of about 6 in nine cases of ten: ln T has a standard deviation of 1
    between shops and 0.35 between edges. None without speeds.
    """
    low, high = window.min_cutting_speed, window.max_cutting_speed
    if not low or not high:
        return None
    exponent = ASSUMED_EXPONENT[window.cutting_material]
    return Taylor(exponent=exponent, constant=sqrt(low * high) * ASSUMED_LIFE**exponent)


def tool_life(taylor: Taylor, cutting_speed: float) -> float:
    """Cutting time until an edge is worn out.

    ``T = (C / v_c)^(1/n)`` minutes, [1]_, converted to seconds. Valid for the feed and depth at
    which n and C were measured, and for similar speeds.

    Parameters
    ----------
    cutting_speed : float, mm/s

    Returns
    -------
    float, s

    Raises
    ------
    ValueError
        If the speed or a constant is out of range.

    Examples
    --------
    n = 0.5, C = 400 m/min, at 200 m/min: 4 min.

    >>> steel = Taylor(exponent=0.5, constant=400_000 / 60)
    >>> round(tool_life(steel, 200_000 / 60), 9)
    240.0
    """
    _require_usable(taylor)
    require_positive(cutting_speed, "cutting speed", "mm/s")
    return SECONDS_PER_MINUTE * pow(taylor.constant / cutting_speed, 1.0 / taylor.exponent)


def speed_for_life(taylor: Taylor, life: float) -> float:
    """Cutting speed for a given tool life, the inverse of :func:`tool_life`.

    ``v_c = C / T^n`` with T in minutes, [1]_.

    Parameters
    ----------
    life : float, s

    Returns
    -------
    float, mm/s

    Raises
    ------
    ValueError
        If the life or a constant is out of range.

    Examples
    --------
    >>> steel = Taylor(exponent=0.5, constant=400_000 / 60)
    >>> round(speed_for_life(steel, 240.0) * 60 / 1000, 9)
    200.0
    """
    _require_usable(taylor)
    require_positive(life, "tool life", "s")
    return taylor.constant / pow(life / SECONDS_PER_MINUTE, taylor.exponent)


def wear_rate(taylor: Taylor, cutting_speed: float) -> float:
    """Tool lives used up per second of cutting: ``1/T = (v_c / C)^(1/n) / 60``, 1/s.

    Raises
    ------
    ValueError
        As for :func:`tool_life`.
    """
    return 1.0 / tool_life(taylor, cutting_speed)


def _require_usable(taylor: Taylor) -> None:
    """Raise an error unless the exponent is in (0, 1) and the constant is positive."""
    if not 0.0 < taylor.exponent < 1.0:
        raise ValueError(
            f"Taylor exponent {taylor.exponent:g} must be greater than 0 and less than 1"
        )
    require_positive(taylor.constant, "Taylor constant", "mm/s")
