"""Quadratic program over the next revolutions that keeps the force below its set point.

First-order axes are linear in the override u itself, not in its logarithm. With u commanded for
a revolution they go from x to ``a·x + (1 − a)·u``, a = exp(−1/T), and their mean on the way is
``m = b·x + (1 − b)·u``, b = T·(1 − a). Force rises with feed, so a force bound is a cap on m
whatever the power law, and the program stays exact where logarithms would linearise the lag:

minimise ``Σ (m_j − t_j)² + w_Δ·Σ (u_j − u_{j−1})² + w_s·Σ s_j²`` over u and s, subject to
``m_j − s_j ≤ c_j``, ``floor ≤ u_j ≤ ceiling``, ``−fall ≤ u_j − u_{j−1} ≤ rise``,

with caps c, targets t and slack s, the excess; the states x are eliminated [1]_. There is a
solution whenever u_0 lies in the band, and an s below 0 would cost without a gain. Matrices and
their pattern never change, only the linear cost and the bounds; the program is homogeneous in
the unit of the override.

References
----------
.. [1] J. M. Maciejowski, "Predictive Control with Constraints", Prentice Hall, 2002, chapters 2
   (prediction without the states) and 3 (the quadratic program, soft constraints).
"""

from dataclasses import dataclass
from math import exp, expm1

import numpy as np
from scipy import sparse

from controller.signals.ports import Floats

LENGTH = 20
"""Length H of the horizon, revolutions: nearly seven lags of a usual drive."""
MOVES = 0.6
"""Weight w_Δ of a change of override against an equal error; less passes noise to it."""
EXCESS = 10.0
"""Weight w_s of override beyond a cap against an equal amount below it.

More than ten times costs iterations and gains little.
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Horizon:
    """Prediction matrices over H revolutions for axes with one lag."""

    decay: Floats
    """Share of the present override of the axes in the mean of each revolution, (H,)."""
    response: Floats
    """Share of each command (column) in the mean of each revolution (row), (H, H)."""
    quadratic: sparse.csc_matrix
    """Upper triangle of P in the cost ``½·zᵀ·P·z + qᵀ·z``, z = (u, s), (2H, 2H)."""
    rows: sparse.csc_matrix
    """Matrix A of the constraints ``l ≤ A·z ≤ u`` on caps, band and moves, (3H, 2H)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outlook:
    """Inputs of one decision of the predictive law, with overrides in a common unit."""

    axes: float
    """Override of the axes at the end of the last revolution."""
    command: float
    """Command u_0 of the last revolution, between floor and ceiling."""
    caps: Floats
    """Caps c on the mean override of each revolution, (H,)."""
    targets: Floats
    """Targets t of the mean override of each revolution, (H,)."""
    floor: float
    ceiling: float
    rise: float
    """Greatest rise of the override per revolution."""
    fall: float
    """Greatest fall of the override per revolution."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Vectors:
    """Vectors of the quadratic program that change with each decision."""

    linear: Floats
    """Linear cost q, (2H,)."""
    lower: Floats
    """Lower bounds l, (3H,)."""
    upper: Floats
    """Upper bounds u, (3H,)."""


def remaining(lag: float) -> float:
    """Share a of the distance left after a revolution, for axes with a lag in revolutions."""
    return exp(-1.0 / lag)


def lingering(lag: float) -> float:
    """Share b of the distance that is left in the mean of a revolution."""
    return -lag * expm1(-1.0 / lag)


def horizon(lag: float, *, length: int = LENGTH) -> Horizon:
    """Build the prediction matrices for a lag in revolutions, above 0."""
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
    """Compute the linear cost and the bounds of the quadratic program."""
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
