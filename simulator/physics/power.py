"""Power that a cut needs; the power that a spindle provides is in :mod:`.spindle`.

Scalars in N, mm/s and W.

References
----------
.. [1] F. Ridwan, X. Xu and G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010; eqs. (5), (6). The constraint "N_m ≤ N_mc" is printed the wrong
   way round: the predicted motor power must not exceed the motor's.
"""

from simulator.physics.domain import (
    require_at_most,
    require_not_negative,
    require_positive,
)
from stepnc_model.units import NMM_S_PER_WATT


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
