"""Power parameters of a machine fitted to measured runs, and how well the data know them.

The fit is that of :mod:`simulator.calibration.stack`. The covariance is the sandwich of
[1]_ over blocks of consecutive samples, because neighbours err alike, or over whole runs where
there are enough of them and that gives more, because a machine is not the same every day;
intervals are 95 % by Student's t.

A parameter whose interval would be wider than what was known before is not identified: it stays
at its prior value. Which others it cannot be told from is read off the correlations that the
singular values of the scaled Jacobian leave.

References
----------
.. [1] K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models",
   Biometrika 73 (1986), 13-22: covariance robust to correlation within clusters.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from simulator.calibration.estimates import Calibration, Estimate, Prior
from simulator.calibration.features import PARAMETERS, Parameter, RunFeatures
from simulator.calibration.measured_run import Component
from simulator.calibration.stack import (
    OUTLIER,
    Stack,
    jacobian,
    predicted,
    scaled,
    solved,
    stacked,
)
from simulator.motion.segments import Floats, Ints

CONFIDENCE = 0.95
FEWEST_RUNS = 3
"""from which the differences between runs are looked at"""
NOTABLE = 0.5
"""correlation from which a parameter is named"""
TINY = 1e-9
"""of the greatest singular value; what is less is nothing"""


def fitted(
    runs: Sequence[RunFeatures], priors: Mapping[Parameter, Prior], *, efficiency: float
) -> Calibration:
    """Parameters that make the predicted powers meet the measured ones.

    Parameters
    ----------
    runs : sequence of RunFeatures
        With measured powers.
    priors : mapping of Prior
        One for each parameter.
    efficiency : float
        Of the spindle; not fitted, since the idle power and it cannot be told apart.

    Raises
    ------
    CalibrationError
        No power was measured.
    """
    stack = stacked(runs, efficiency)
    prior = np.array([priors[name].value for name in PARAMETERS])
    scale = np.array([priors[name].scale for name in PARAMETERS])
    moved = np.abs(jacobian(stack, prior + scale)).max(axis=0) > 0.0
    known = [
        _kept(priors, int(index), value=0.0, half=np.inf, why="no measured power depends on it")
        for index in np.flatnonzero(~moved)
    ]
    free = np.flatnonzero(moved)
    while True:
        values, noise = solved(stack, free, prior=prior, scale=scale)
        half, together = _half_widths(stack, free, values=values, noise=noise, scale=scale)
        if not len(free) or half.max() <= 1.0:
            break
        worst = int(np.argmax(half))
        index = int(free[worst])
        reach = float(half[worst] * scale[index])
        why = _confusion(free, together[worst], worst)
        known.append(_kept(priors, index, value=float(values[index]), half=reach, why=why))
        free = np.delete(free, worst)
    known += [
        _estimate(int(index), value=float(values[index]), half=float(reach * scale[index]))
        for index, reach in zip(free, half, strict=True)
    ]
    order = list(Component)
    return Calibration(
        estimates=tuple(sorted(known, key=lambda each: PARAMETERS.index(each.parameter))),
        noise={
            order[part]: float(noise[stack.part == part][0]) for part in np.unique(stack.part)
        },
        blocks=int(stack.block.max()) + 1,
    )


def _half_widths(
    stack: Stack, free: Ints, *, values: Floats, noise: Floats, scale: Floats
) -> tuple[Floats, Floats]:
    """Half of each interval in units of the scales, (F,), and correlations, (F, F).

    The greatest of the sandwiches and of what independent noise alone would give: along a
    direction that the data do not know, a sandwich is nothing over nothing.
    """
    if not len(free):
        return np.empty(0), np.empty((0, 0))
    slope = scaled(stack, free, values=values, scale=scale, noise=noise)
    residual = (stack.watts - predicted(stack, values)) / noise
    weight = 1.0 / np.sqrt(1.0 + (residual / OUTLIER) ** 2)
    _, sizes, directions = np.linalg.svd(np.sqrt(weight)[:, None] * slope, full_matrices=False)
    inverse = directions.T / np.maximum(sizes, TINY * sizes[0]) ** 2 @ directions
    pulls = slope * (weight * residual)[:, None]
    clusters = [stack.block, stack.run] if stack.run.max() >= FEWEST_RUNS - 1 else [stack.block]
    scatter = np.sqrt(np.diag(inverse))
    halves = [_quantile(len(pulls)) * scatter]
    for cluster in clusters:
        count = int(cluster.max()) + 1
        pull = np.zeros((count, len(free)))
        np.add.at(pull, cluster, pulls)
        sandwich = inverse @ (pull.T @ pull) @ inverse * count / (count - 1)
        halves.append(_quantile(count) * np.sqrt(np.maximum(np.diag(sandwich), 0.0)))
    return np.max(halves, axis=0), inverse / np.outer(scatter, scatter)


def _quantile(count: int) -> float:
    """Student's t of so many independent pulls."""
    return float(student.ppf(0.5 + 0.5 * CONFIDENCE, count - 1))


def _estimate(index: int, *, value: float, half: float) -> Estimate:
    """A parameter and its interval, of which none can be negative."""
    return Estimate(
        parameter=PARAMETERS[index], value=value, low=max(0.0, value - half), high=value + half
    )


def _kept(
    priors: Mapping[Parameter, Prior], index: int, *, value: float, half: float, why: str
) -> Estimate:
    """A parameter that keeps its prior value."""
    found = _estimate(index, value=value, half=half)
    return replace(found, value=priors[PARAMETERS[index]].value, reason=why)


def _confusion(free: Ints, correlation: Floats, worst: int) -> str:
    """Why a parameter is not known, by its (F,) correlations with the others."""
    others = [
        str(PARAMETERS[index])
        for row, index in enumerate(free)
        if row != worst and abs(correlation[row]) > NOTABLE
    ]
    if not others:
        return "too small against the noise"
    return f"cannot be told apart from {', '.join(others)}"
