"""The next revolutions as a quadratic program: overrides whose force stays below its set point.

First-order axes are linear in the override u itself, not in its logarithm. With u commanded for
a revolution they go from x to ``a·x + (1 − a)·u``, a = exp(−1/T), and their mean on the way is
``m = b·x + (1 − b)·u``, b = T·(1 − a). Force rises with feed, so a force bound is a cap on m
whatever the power law, and the program stays exact where logarithms would linearise the lag:

minimise ``Σ (m_j − t_j)² + w_Δ·Σ (u_j − u_{j−1})² + w_s·Σ s_j²`` over u and s, subject to
``m_j − s_j ≤ c_j``, ``floor ≤ u_j ≤ ceiling``, ``−fall ≤ u_j − u_{j−1} ≤ rise``,

with caps c, targets t and slack s, the excess; the states x are eliminated [1]_. There is a
solution whenever u_0 lies in the band, and an s below 0 would cost without a gain. Matrices and
their pattern never change, only the linear cost and the bounds; all is homogeneous in the unit
of the override.

References
----------
.. [1] J. M. Maciejowski, "Predictive Control with Constraints", Prentice Hall, 2002, chapters 2
   (prediction without the states) and 3 (the quadratic program, soft constraints).
"""

from dataclasses import dataclass
from math import exp, expm1

import numpy as np
from scipy import sparse

from controller.ports import Floats

LENGTH = 20
"""H, revolutions: nearly seven lags of a usual drive"""
MOVES = 0.6
"""w_Δ, of a move against an error of the same size: less shows in the command as noise"""
EXCESS = 10.0
"""w_s, of override beyond a cap against as much below it: more than ten times costs iterations
and gains little"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Horizon:
    """H revolutions of axes with one lag."""

    decay: Floats
    """(H,) share of the axes' override now in the mean of each revolution"""
    response: Floats
    """(H, H) share of each command, by column, in the mean of each revolution, by row"""
    quadratic: sparse.csc_matrix
    """(2H, 2H) upper triangle of P in the cost ``½·zᵀ·P·z + qᵀ·z``, z = (u, s)"""
    rows: sparse.csc_matrix
    """(3H, 2H) A of the constraints ``l ≤ A·z ≤ u``: caps, band, moves"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outlook:
    """Input of one decision; overrides in any one unit."""

    axes: float
    """at the end of the last revolution"""
    command: float
    """u_0 of the last revolution, between floor and ceiling"""
    caps: Floats
    """(H,) c, of the mean of each revolution"""
    targets: Floats
    """(H,) t"""
    floor: float
    ceiling: float
    rise: float
    """from one revolution to the next, at most"""
    fall: float
    """likewise"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Vectors:
    """Terms of the program that change from one decision to the next."""

    linear: Floats
    """(2H,) q"""
    lower: Floats
    """(3H,) l"""
    upper: Floats
    """(3H,) u"""


def remaining(lag: float) -> float:
    """Share a of a way that axes with this lag in revolutions have left after a revolution."""
    return exp(-1.0 / lag)


def lingering(lag: float) -> float:
    """Share b of a way that is left in the mean of a revolution."""
    return -lag * expm1(-1.0 / lag)


def horizon(lag: float, *, length: int = LENGTH) -> Horizon:
    """The program for a lag in revolutions, above 0."""
    left, mean_left = remaining(lag), lingering(lag)
    decay = mean_left * left ** np.arange(length, dtype=np.float64)
    response = np.zeros((length, length))
    for column in range(length):
        response[column, column] = 1.0 - mean_left
        response[column + 1 :, column] = (1.0 - left) * decay[: length - column - 1]
    one, none = np.eye(length), np.zeros((length, length))
    moves = one - np.eye(length, k=-1)
    commands = 2.0 * (response.T @ response + MOVES * moves.T @ moves)
    cost = np.block([[commands, none], [none, 2.0 * EXCESS * one]])
    rows = np.block([[response, -one], [one, none], [moves, none]])
    return Horizon(
        decay=decay,
        response=response,
        quadratic=sparse.csc_matrix(np.triu(cost)),
        rows=sparse.csc_matrix(rows),
    )


def vectors(over: Horizon, outlook: Outlook) -> Vectors:
    """Linear cost and bounds of the program."""
    length = len(over.decay)
    coasting = over.decay * outlook.axes
    linear = np.zeros(2 * length)
    linear[:length] = 2.0 * ((coasting - outlook.targets) @ over.response)
    linear[0] -= 2.0 * MOVES * outlook.command
    lower, upper = np.empty(3 * length), np.empty(3 * length)
    lower[:length], upper[:length] = -np.inf, outlook.caps - coasting
    lower[length : 2 * length], upper[length : 2 * length] = outlook.floor, outlook.ceiling
    lower[2 * length :], upper[2 * length :] = -outlook.fall, outlook.rise
    lower[2 * length] += outlook.command
    upper[2 * length] += outlook.command
    return Vectors(linear=linear, lower=lower, upper=upper)
