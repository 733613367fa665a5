"""Power parameters of a machine fitted to measured runs, and how well the data know them.

Robust least squares (soft L1, so that a residual beyond three standard deviations counts by its
size and not by its square), each component by its own noise. The covariance is the sandwich of
[1]_ over blocks of consecutive samples, because neighbours err alike; intervals are 95 % by
Student's t with one degree of freedom per block. Differences between runs beyond what the
blocks show, a warm or a cold machine, are not in them: that is what held-out runs are for.

A parameter whose interval would be wider than what was known before is not identified: it stays
at its prior value. Which others it cannot be told from is read off the singular vector of the
scaled Jacobian that belongs to the smallest singular value.

References
----------
.. [1] K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models",
   Biometrika 73 (1986), 13-22: covariance robust to correlation within clusters.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from simulator.calibration.features import (
    PARAMETERS,
    UNITS,
    Design,
    Parameter,
    RunFeatures,
    design,
    powers,
    slopes,
)
from simulator.calibration.measured_run import Component
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Ints

BLOCK_TIME = 10.0  # s of consecutive samples that count as one observation
OUTLIER = 3.0
"""standard deviations from which a residual counts by its size only"""
CONFIDENCE = 0.95
BULK, BULK_WIDTH = 0.8, 1.2816
"""share of residuals that tells the noise, and the standard deviations within which a normal
distribution holds that share; the median would be that of a standing axis"""
ROUNDS = 3
"""fits, each with the noise that the one before left"""
START = 0.1
"""share of its scale from which a parameter starts that was 0 before"""
TINY = 1e-9
SHARE_OF_SPREAD = 1e-3
"""noise below this share of a signal's spread is taken as this: models are never that good"""
NOTABLE = 0.1
"""share in a singular vector from which a parameter is named"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Prior:
    """What is known of a parameter before."""

    value: float
    scale: float
    """by how much it may well be off"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """What is known of a parameter after."""

    parameter: Parameter
    value: float
    low: float
    high: float
    """95 % interval; of one that is not identified, what the data allow"""
    reason: str = ""
    """why it could not be identified and keeps its prior value; empty: it was"""

    @property
    def is_identified(self) -> bool:
        """Whether the data say more than was known before."""
        return not self.reason

    @property
    def unit(self) -> str:
        """Of value and interval."""
        return UNITS[self.parameter]


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Fitted parameters."""

    estimates: tuple[Estimate, ...]
    """one of each parameter"""
    noise: Mapping[Component, float]
    """W, standard deviation of what the fit leaves, by component"""
    blocks: int
    """of consecutive samples, each one observation"""

    @property
    def values(self) -> Floats:
        """(P,) values in the order of the parameters."""
        return np.array([estimate.value for estimate in self.estimates])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stack:
    """All measured powers of all runs, one below the other."""

    tables: tuple[Design, ...]
    parts: tuple[tuple[Component, ...], ...]
    """measured, by run"""
    watts: Floats
    """(M,)"""
    part: Ints
    """(M,) which component"""
    block: Ints
    """(M,) which block of consecutive samples"""


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
        No power was measured, or there are fewer blocks than parameters that could be fitted.
    """
    stack = _stacked(runs, efficiency)
    prior = np.array([priors[name].value for name in PARAMETERS])
    scale = np.array([priors[name].scale for name in PARAMETERS])
    moved = np.abs(_jacobian(stack, prior + scale)).max(axis=0) > 0.0
    free = np.flatnonzero(moved)
    lost: dict[int, Estimate] = {
        int(index): _lost(
            int(index),
            priors[PARAMETERS[index]],
            value=0.0,
            half=np.inf,
            why="no measured power depends on it",
        )
        for index in np.flatnonzero(~moved)
    }
    while True:
        values, noise = _solved(stack, free, prior=prior, scale=scale)
        half, weakest = _half_widths(stack, free, values=values, noise=noise, scale=scale)
        if not len(free) or half.max() <= 1.0:
            break
        worst = int(np.argmax(half))
        index = int(free[worst])
        lost[index] = _lost(
            index,
            priors[PARAMETERS[index]],
            value=float(values[index]),
            half=float(half[worst] * scale[index]),
            why=_confusion(free, weakest, worst),
        )
        free = np.delete(free, worst)
    found = {
        int(index): Estimate(
            parameter=PARAMETERS[index],
            value=float(values[index]),
            low=float(max(0.0, values[index] - reach * scale[index])),
            high=float(values[index] + reach * scale[index]),
        )
        for index, reach in zip(free, half, strict=True)
    }
    estimates = {**lost, **found}
    order = list(Component)
    return Calibration(
        estimates=tuple(estimates[index] for index in range(len(PARAMETERS))),
        noise={order[part]: float(noise[stack.part == part][0]) for part in np.unique(stack.part)},
        blocks=int(stack.block.max()) + 1,
    )


def _stacked(runs: Sequence[RunFeatures], efficiency: float) -> _Stack:
    """Measured powers below one another, in blocks of consecutive samples."""
    if not any(run.measured for run in runs):
        raise CalibrationError("no measured power in any run")
    whole = sum(float(run.duration.sum()) for run in runs)
    span = min(BLOCK_TIME, whole / (2 * len(PARAMETERS)))
    watts, part, block, first = [], [], [], 0
    order = list(Component)
    for run in runs:
        number = first + ((np.cumsum(run.duration) - run.duration) / span).astype(np.int64)
        first = int(number[-1]) + 1
        for component, values in run.measured.items():
            watts.append(values)
            part.append(np.full(len(run), order.index(component)))
            block.append(number)
    return _Stack(
        tables=tuple(design(run, efficiency=efficiency) for run in runs),
        parts=tuple(tuple(run.measured) for run in runs),
        watts=np.concatenate(watts),
        part=np.concatenate(part),
        block=np.concatenate(block),
    )


def _predicted(stack: _Stack, values: Floats) -> Floats:
    """(M,) W of the stack's rows."""
    rows = [
        powers(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def _jacobian(stack: _Stack, values: Floats) -> Floats:
    """(M, P) W per unit of each parameter."""
    rows = [
        slopes(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def _solved(
    stack: _Stack, free: Ints, *, prior: Floats, scale: Floats
) -> tuple[Floats, Floats]:
    """Values of all parameters, those not free at their priors; noise of each row, (M,) W."""
    noise = _by_part(stack, stack.watts, np.std)
    floor = np.maximum(SHARE_OF_SPREAD * noise, TINY)
    values = prior.copy()
    # From nothing no power could rise: it is cut off at 0, and so is its slope.
    values[free] = np.where(prior > 0.0, prior, START * scale)[free]
    for _ in range(ROUNDS):
        if len(free):
            values = _least_squares(stack, free, start=values, scale=scale, noise=noise)
        left = np.abs(stack.watts - _predicted(stack, values))
        noise = np.maximum(floor, _by_part(stack, left, _scatter))
    return values, noise


def _by_part(stack: _Stack, rows: Floats, number: Callable[[Floats], float]) -> Floats:
    """(M,) a number of each component, on every row of it."""
    result = np.empty(len(rows))
    for part in np.unique(stack.part):
        here = stack.part == part
        result[here] = number(rows[here])
    return result


def _scatter(sizes: Floats) -> float:
    """Standard deviation of what has these absolute values, but for a fifth of outliers."""
    return float(np.quantile(sizes, BULK)) / BULK_WIDTH


def _least_squares(
    stack: _Stack, free: Ints, *, start: Floats, scale: Floats, noise: Floats
) -> Floats:
    """Values of all parameters, the free ones fitted."""

    def whole(part: Floats) -> Floats:
        values = start.copy()
        values[free] = part * scale[free]
        return values

    found = least_squares(
        lambda part: (_predicted(stack, whole(part)) - stack.watts) / noise,
        start[free] / scale[free],
        jac=lambda part: _scaled(stack, free, values=whole(part), scale=scale, noise=noise),
        bounds=(0.0, np.inf),
        loss="soft_l1",
        f_scale=OUTLIER,
    )
    return whole(found.x)


def _scaled(
    stack: _Stack, free: Ints, *, values: Floats, scale: Floats, noise: Floats
) -> Floats:
    """(M, F) Jacobian in units of the noise and of the scales."""
    return _jacobian(stack, values)[:, free] * scale[free] / noise[:, None]


def _half_widths(
    stack: _Stack, free: Ints, *, values: Floats, noise: Floats, scale: Floats
) -> tuple[Floats, Floats]:
    """Half of each interval in units of the scales, and the direction known least, both (F,).

    The variance is the greater of the sandwich and of what independent noise alone would give:
    along a direction that the data do not know, the sandwich is nothing over nothing.
    """
    if not len(free):
        return np.empty(0), np.empty(0)
    jacobian = _scaled(stack, free, values=values, scale=scale, noise=noise)
    residual = (stack.watts - _predicted(stack, values)) / noise
    weight = 1.0 / np.sqrt(1.0 + (residual / OUTLIER) ** 2)
    _, sizes, directions = np.linalg.svd(np.sqrt(weight)[:, None] * jacobian, full_matrices=False)
    inverse = directions.T / np.maximum(sizes, TINY * sizes[0]) ** 2 @ directions
    blocks = int(stack.block.max()) + 1
    pull = np.zeros((blocks, len(free)))
    np.add.at(pull, stack.block, jacobian * (weight * residual)[:, None])
    freedom = max(1, blocks - len(free))
    sandwich = inverse @ (pull.T @ pull) @ inverse * blocks / freedom
    variance = np.maximum(np.diag(sandwich), np.diag(inverse))
    quantile = float(student.ppf(0.5 + 0.5 * CONFIDENCE, freedom))
    return quantile * np.sqrt(variance), directions[-1]


def _lost(index: int, prior: Prior, *, value: float, half: float, why: str) -> Estimate:
    """A parameter that keeps its prior value."""
    return Estimate(
        parameter=PARAMETERS[index],
        value=prior.value,
        low=max(0.0, value - half),
        high=value + half,
        reason=why,
    )


def _confusion(free: Ints, weakest: Floats, worst: int) -> str:
    """Why a parameter is not known, by the direction that the data know least."""
    share = np.abs(weakest)
    others = [
        str(PARAMETERS[index])
        for row, index in enumerate(free)
        if row != worst and share[row] > NOTABLE and share[worst] > NOTABLE
    ]
    if not others:
        return "too small against the noise"
    return f"cannot be told apart from {', '.join(others)}"
