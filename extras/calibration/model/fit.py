"""Power parameters of a machine fitted to measured runs, with 95 % intervals.

All measured powers of all runs form one vector. Parameters are fitted by robust least squares
with soft L1 loss: a residual beyond three standard deviations counts by its size, not its
square. Each component is weighted by its own noise, which the fit itself estimates.

The covariance is the sandwich estimator of [1]_ over blocks of consecutive samples, because
errors of neighbours are correlated; or over whole runs where there are enough of them and this
gives wider intervals, because a machine varies from day to day. Intervals are 95 % by Student's
t.

A parameter whose interval would be wider than its prior uncertainty is not identified: it keeps
its prior value. The correlations from the singular values of the scaled Jacobian tell with
which others it is confounded. Units W, s.

Prediction errors on data not used for fitting: other runs, or the end of a single run.

References
----------
.. [1] K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models",
   Biometrika 73 (1986), 13-22: covariance robust to correlation within clusters.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from extras.calibration.model.features import (
    PARAMETERS,
    Calibration,
    Design,
    Estimate,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
    slopes,
)
from extras.calibration.model.measured_run import Component
from extras.calibration.model.simulated_features import Skill, compared, mean_power
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Ints

BLOCK_TIME = 10.0  # s of consecutive samples that count as one observation
OUTLIER = 3.0
"""Number of standard deviations from which a residual counts linearly."""
BULK, BULK_WIDTH = 0.8, 1.2816
"""Share of residuals that determines the noise, and the number of standard deviations within
which a normal distribution has that share; the median would reflect axes at rest."""
ROUNDS = 3
"""Number of fits, each with the noise left by the previous one."""
START = 0.1
"""Start value of a parameter with prior 0, as a share of its scale."""
SHARE_OF_SPREAD = 5e-3
"""Least noise as a share of a signal's spread: no model is more accurate."""
LEAST_NOISE = 1e-9  # W
CLOSE = 1e-6
"""Relative change below which the fit has converged."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StackedPowers:
    """All measured powers of all runs, stacked in one vector of M rows."""

    tables: tuple[Design, ...]
    parts: tuple[tuple[Component, ...], ...]
    """Measured components of each run."""
    watts: Floats
    """Measured powers, (M,), W."""
    part: Ints
    """Index of the component, (M,)."""
    block: Ints
    """Index of the block of consecutive samples, (M,)."""
    run: Ints
    """Index of the run, (M,)."""


def stacked(runs: Sequence[RunFeatures], efficiency: float) -> StackedPowers:
    """Stack all measured powers, divided into blocks of consecutive samples."""
    if not any(run.measured for run in runs):
        raise CalibrationError("no measured power in any run")
    whole = sum(float(run.duration.sum()) for run in runs)
    span = min(BLOCK_TIME, whole / (2 * len(PARAMETERS)))
    watts, part, block, origin, first = [], [], [], [], 0
    order = list(Component)
    for row, run in enumerate(runs):
        number = first + ((np.cumsum(run.duration) - run.duration) / span).astype(np.int64)
        first = int(number[-1]) + 1
        for component, values in run.measured.items():
            watts.append(values)
            part.append(np.full(len(run), order.index(component)))
            block.append(number)
            origin.append(np.full(len(run), row))
    return StackedPowers(
        tables=tuple(design(run, efficiency=efficiency) for run in runs),
        parts=tuple(tuple(run.measured) for run in runs),
        watts=np.concatenate(watts),
        part=np.concatenate(part),
        block=np.concatenate(block),
        run=np.concatenate(origin),
    )


def predicted(stack: StackedPowers, values: Floats) -> Floats:
    """Predicted powers for the rows of the stack, (M,), W."""
    rows = [
        powers(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def jacobian(stack: StackedPowers, values: Floats) -> Floats:
    """Derivatives of the predicted powers by each parameter, (M, P), W per unit."""
    rows = [
        slopes(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def solved(
    stack: StackedPowers, free: Ints, *, prior: Floats, scale: Floats
) -> tuple[Floats, Floats]:
    """Fit the free parameters; return all values, and the noise of each row, (M,), W."""
    # An axis that stands draws the same power all the time.
    noise = np.maximum(_by_part(stack, stack.watts, np.std), LEAST_NOISE)
    floor = np.maximum(SHARE_OF_SPREAD * noise, LEAST_NOISE)
    values = prior.copy()
    # Starting from zero, power would be cut off at 0, and its slope would vanish.
    values[free] = np.where(prior > 0.0, prior, START * scale)[free]
    for _ in range(ROUNDS):
        if len(free):
            values = _least_squares(stack, free, start=values, scale=scale, noise=noise)
        left = np.abs(stack.watts - predicted(stack, values))
        noise = np.maximum(floor, _by_part(stack, left, _scatter))
    return values, noise


def _by_part(stack: StackedPowers, rows: Floats, number: Callable[[Floats], float]) -> Floats:
    """A statistic of each component's rows, repeated on all its rows, (M,)."""
    result = np.empty(len(rows))
    for part in np.unique(stack.part):
        here = stack.part == part
        result[here] = number(rows[here])
    return result


def _scatter(sizes: Floats) -> float:
    """Standard deviation from absolute values, ignoring the largest fifth as outliers."""
    return float(np.quantile(sizes, BULK)) / BULK_WIDTH


def _least_squares(
    stack: StackedPowers, free: Ints, *, start: Floats, scale: Floats, noise: Floats
) -> Floats:
    """Values of all parameters after a least-squares fit of the free ones."""

    def whole(part: Floats) -> Floats:
        values = start.copy()
        values[free] = part * scale[free]
        return values

    found = least_squares(
        lambda part: (predicted(stack, whole(part)) - stack.watts) / noise,
        start[free] / scale[free],
        jac=lambda part: scaled(stack, free, values=whole(part), scale=scale, noise=noise),
        bounds=(0.0, np.inf),
        loss="soft_l1",
        f_scale=OUTLIER,
        # Inexact steps make little progress where parameters are nearly collinear.
        tr_solver="exact",
        ftol=CLOSE,
        xtol=CLOSE,
    )
    return whole(found.x)


def scaled(
    stack: StackedPowers, free: Ints, *, values: Floats, scale: Floats, noise: Floats
) -> Floats:
    """Jacobian in units of the noise and of the scales, (M, F)."""
    return jacobian(stack, values)[:, free] * scale[free] / noise[:, None]


CONFIDENCE = 0.95
FEWEST_RUNS = 3
"""Least number of runs for which differences between runs are considered."""
NOTABLE = 0.5
"""Correlation from which a parameter is reported as confounded."""
TINY = 1e-9
"""Least singular value, as a share of the greatest, that is considered nonzero."""


def fitted(
    runs: Sequence[RunFeatures],
    priors: Mapping[Parameter, ParameterPrior],
    *,
    efficiency: float,
) -> Calibration:
    """Fit parameters such that predicted powers match the measured ones.

    Parameters
    ----------
    runs : sequence of RunFeatures
        Runs with measured powers.
    priors : mapping of ParameterPrior
        Priors, one for each parameter.
    efficiency : float
        Efficiency of the spindle; not fitted, as it cannot be separated from the idle power.

    Raises
    ------
    CalibrationError
        If no power was measured.
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
    stack: StackedPowers, free: Ints, *, values: Floats, noise: Floats, scale: Floats
) -> tuple[Floats, Floats]:
    """Half-widths of the intervals over the scales, (F,), and correlations, (F, F).

    The half-width is the greatest of the sandwich estimates and the one for independent noise:
    in a direction without information in the data, a sandwich estimate is undetermined.
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
    """Quantile of Student's t for a number of independent observations."""
    return float(student.ppf(0.5 + 0.5 * CONFIDENCE, count - 1))


def _estimate(index: int, *, value: float, half: float) -> Estimate:
    """Estimate of a parameter; its interval excludes negative values."""
    return Estimate(
        parameter=PARAMETERS[index], value=value, low=max(0.0, value - half), high=value + half
    )


def _kept(
    priors: Mapping[Parameter, ParameterPrior],
    index: int,
    *,
    value: float,
    half: float,
    why: str,
) -> Estimate:
    """Estimate of a parameter that keeps its prior value."""
    found = _estimate(index, value=value, half=half)
    return replace(found, value=priors[PARAMETERS[index]].value, reason=why)


def _confusion(free: Ints, correlation: Floats, worst: int) -> str:
    """Reason why a parameter is not identified, from its (F,) correlations with the others."""
    others = [
        str(PARAMETERS[index])
        for row, index in enumerate(free)
        if row != worst and abs(correlation[row]) > NOTABLE
    ]
    if not others:
        return "too small compared with the noise"
    return f"cannot be distinguished from {', '.join(others)}"


FITTED_SHARE = 0.7
"""Share of a single run's samples used for fitting; the rest is held out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """Prediction errors of a run, or part of a run, that was not used for fitting."""

    name: str
    skills: Mapping[Component, Skill]


def held_out(
    runs: Sequence[RunFeatures],
    priors: Mapping[Parameter, ParameterPrior],
    *,
    efficiency: float,
) -> tuple[HeldOut, ...]:
    """Errors of each run predicted from the others; of a single run from its first part.

    Parameters
    ----------
    runs : sequence of RunFeatures
        Runs with measured powers.
    priors : mapping of ParameterPrior
    efficiency : float
        Efficiency of the spindle.
    """
    if len(runs) == 1:
        cut = int(FITTED_SHARE * len(runs[0]))
        pairs = [([_rows(runs[0], slice(0, cut))], _rows(runs[0], slice(cut, None)))]
    else:
        pairs = [([other for other in runs if other is not run], run) for run in runs]
    return tuple(
        HeldOut(
            name=run.name,
            skills=skills(
                run, others, fitted(others, priors, efficiency=efficiency), efficiency
            ),
        )
        for others, run in pairs
    )


def skills(
    run: RunFeatures, others: Sequence[RunFeatures], calibration: Calibration, efficiency: float
) -> dict[Component, Skill]:
    """Prediction errors of each measured power of a run, with a calibration from other runs."""
    values = calibration.values
    table = design(run, efficiency=efficiency)
    model = powers(table, values)
    idle = powers(
        design(replace(run, cutting_power=np.zeros(len(run))), efficiency=efficiency), values
    )
    known = [part for part in run.measured if all(part in other.measured for other in others)]
    return {
        part: compared(
            run.measured[part],
            model[part],
            duration=run.duration,
            model_energy=float(model[part] @ run.duration),
            idle=idle[part],
            baseline=mean_power(
                [other.measured[part] for other in others], [other.duration for other in others]
            ),
        )
        for part in known
    }


def _rows(run: RunFeatures, rows: slice) -> RunFeatures:
    """Select a range of the samples of a run."""
    return RunFeatures(
        name=run.name,
        duration=run.duration[rows],
        spindle_speed=run.spindle_speed[rows],
        spindle_acceleration=run.spindle_acceleration[rows],
        velocity=run.velocity[rows],
        acceleration=run.acceleration[rows],
        cutting_power=run.cutting_power[rows],
        coolant=run.coolant[rows],
        measured={part: watts[rows] for part, watts in run.measured.items()},
    )
