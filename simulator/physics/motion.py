"""Time of a straight move from rest to rest, and the speed that a control's block time allows.

Equal acceleration and deceleration, no jerk limit. Scalars in mm and s.

References
----------
.. [1] S.-J. Shin et al., "Developing a virtual machining model to generate MTConnect
   machine-monitoring data from STEP-NC", Int. J. Prod. Res., 2016, Appendix 1 (1)-(3),
   doi:10.1080/00207543.2015.1064182. It has no case for moves too short to reach the speed,
   where its time at constant speed turns negative.
.. [2] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009: feed against spacing of points, one block in about 4 ms.
"""

from math import sqrt

from simulator.physics.domain import require_not_negative, require_positive


def peak_speed(length: float, *, speed: float, acceleration: float) -> float:
    """Greatest speed that a move from rest to rest reaches: ``min(v, √(a·L))``.

    Parameters
    ----------
    length : float, mm
    speed : float, mm/s
        Commanded.
    acceleration : float, mm/s²

    Returns
    -------
    float, mm/s

    Raises
    ------
    ValueError
        If the length is negative or another value not positive.

    Examples
    --------
    >>> round(peak_speed(100.0, speed=1600.0, acceleration=6000.0), 1)
    774.6
    """
    require_not_negative(length, "length", "mm")
    require_positive(speed, "speed", "mm/s")
    require_positive(acceleration, "acceleration", "mm/s²")
    return min(speed, sqrt(acceleration * length))


def move_time(length: float, *, speed: float, acceleration: float) -> float:
    """Time of a move from rest to rest.

    ``t = L/v + v/a`` when it is long enough to reach v (``L ≥ v²/a``), else a triangle,
    ``t = 2·√(L/a)``; [1]_ completed.

    Parameters
    ----------
    length : float, mm
    speed : float, mm/s
    acceleration : float, mm/s²

    Returns
    -------
    float, s
        0 for a move of no length.

    Raises
    ------
    ValueError
        If the length is negative or another value not positive.

    Examples
    --------
    >>> round(move_time(500.0, speed=1600.0, acceleration=6000.0), 6)
    0.579167
    >>> round(move_time(100.0, speed=1600.0, acceleration=6000.0), 6)
    0.258199
    """
    top = peak_speed(length, speed=speed, acceleration=acceleration)
    if top < speed:
        return 2.0 * sqrt(length / acceleration)
    return length / speed + speed / acceleration


def speed_of_blocks(spacing: float, block_time: float) -> float:
    """Greatest speed at which a control keeps up with points so far apart.

    ``v ≤ s / t_block``, [2]_: a control needs a time for each block whatever its length.

    Parameters
    ----------
    spacing : float, mm
        Length of one block.
    block_time : float, s

    Returns
    -------
    float, mm/s

    Raises
    ------
    ValueError
        If either is not positive.

    Examples
    --------
    >>> speed_of_blocks(0.1, 0.004)
    25.0
    """
    require_positive(spacing, "spacing of points", "mm")
    require_positive(block_time, "block time", "s")
    return spacing / block_time


def ramp_time(speed: float, acceleration: float) -> float:
    """Time of a spindle or an axis from rest to a speed: ``t = v/a``.

    Parameters
    ----------
    speed : float, mm/s or rev/s
        Magnitude; 0 takes no time.
    acceleration : float, mm/s² or rev/s²

    Returns
    -------
    float, s

    Raises
    ------
    ValueError
        If the speed is negative or the acceleration not positive.

    Examples
    --------
    >>> round(ramp_time(1750 / 60, 10.0), 4)
    2.9167
    """
    require_not_negative(speed, "speed", "mm/s or rev/s")
    require_positive(acceleration, "acceleration", "mm/s² or rev/s²")
    return speed / acceleration
