"""All measured powers of all runs in one vector, and the parameters that meet them best.

Robust least squares: soft L1, so that a residual beyond three standard deviations counts by its
size and not by its square; each component by its own noise, which the fit itself tells. Units
W, s.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from simulator.calibration.features import (
    PARAMETERS,
    Design,
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
BULK, BULK_WIDTH = 0.8, 1.2816
"""share of residuals that tells the noise, and the standard deviations within which a normal
distribution holds that share; the median would be that of a standing axis"""
ROUNDS = 3
"""fits, each with the noise that the one before left"""
START = 0.1
"""share of its scale from which a parameter starts that was 0 before"""
SHARE_OF_SPREAD = 5e-3
"""noise below this share of a signal's spread is taken as this: models are never that good"""
LEAST_NOISE = 1e-9  # W
CLOSE = 1e-6
"""the fit ends when nothing changes by this share"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stack:
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
    run: Ints
    """(M,) which run"""


def stacked(runs: Sequence[RunFeatures], efficiency: float) -> Stack:
    """Measured powers below one another, in blocks of consecutive samples."""
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
    return Stack(
        tables=tuple(design(run, efficiency=efficiency) for run in runs),
        parts=tuple(tuple(run.measured) for run in runs),
        watts=np.concatenate(watts),
        part=np.concatenate(part),
        block=np.concatenate(block),
        run=np.concatenate(origin),
    )


def predicted(stack: Stack, values: Floats) -> Floats:
    """(M,) W of the stack's rows."""
    rows = [
        powers(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def jacobian(stack: Stack, values: Floats) -> Floats:
    """(M, P) W per unit of each parameter."""
    rows = [
        slopes(table, values)[part]
        for table, parts in zip(stack.tables, stack.parts, strict=True)
        for part in parts
    ]
    return np.concatenate(rows)


def solved(stack: Stack, free: Ints, *, prior: Floats, scale: Floats) -> tuple[Floats, Floats]:
    """Values of all parameters, those not free at their priors; noise of each row, (M,) W."""
    noise = _by_part(stack, stack.watts, np.std)
    floor = np.maximum(SHARE_OF_SPREAD * noise, LEAST_NOISE)
    values = prior.copy()
    # From nothing no power could rise: it is cut off at 0, and so is its slope.
    values[free] = np.where(prior > 0.0, prior, START * scale)[free]
    for _ in range(ROUNDS):
        if len(free):
            values = _least_squares(stack, free, start=values, scale=scale, noise=noise)
        left = np.abs(stack.watts - predicted(stack, values))
        noise = np.maximum(floor, _by_part(stack, left, _scatter))
    return values, noise


def _by_part(stack: Stack, rows: Floats, number: Callable[[Floats], float]) -> Floats:
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
    stack: Stack, free: Ints, *, start: Floats, scale: Floats, noise: Floats
) -> Floats:
    """Values of all parameters, the free ones fitted."""

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
        # Inexact steps hardly move where parameters are nearly alike.
        tr_solver="exact",
        ftol=CLOSE,
        xtol=CLOSE,
    )
    return whole(found.x)


def scaled(stack: Stack, free: Ints, *, values: Floats, scale: Floats, noise: Floats) -> Floats:
    """(M, F) Jacobian in units of the noise and of the scales."""
    return jacobian(stack, values)[:, free] * scale[free] / noise[:, None]
