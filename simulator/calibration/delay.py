"""The delay of the main drive, from how late its measured power follows the model's.

A first-order lag of the predicted power of the cut; the time constant is the one that leaves
the least, its interval where what it leaves is no more than chance explains. Samples within a
block count as one observation, as in :mod:`simulator.calibration.stack`. Units s, W.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from simulator.calibration.estimates import Calibration
from simulator.calibration.features import RunFeatures, design, powers
from simulator.calibration.measured_run import Component
from simulator.motion.segments import Floats

LONGEST = 2.0
"""s; no main drive is slower"""

SHORTEST = 1e-3
"""s"""

CHANCE = 3.84
"""95 % quantile of χ² with one degree of freedom"""

GRID = 60
"""time constants that are tried before the best is refined"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """Time constant of the main drive, s."""

    value: float
    low: float
    high: float
    reason: str = ""
    """why it could not be identified; empty: it was"""


def fitted_delay(
    runs: Sequence[RunFeatures], calibration: Calibration, *, efficiency: float
) -> Delay:
    """Time constant of the main drive.

    Parameters
    ----------
    runs : sequence of RunFeatures
        With the power of the spindle, or the total.
    calibration : Calibration
        Of the same runs.
    efficiency : float
        Of the spindle.
    """
    parts = [_pair(run, calibration, efficiency) for run in runs]
    pairs = [pair for pair in parts if pair is not None]
    if not pairs:
        return Delay(value=0.0, low=0.0, high=np.inf, reason="no spindle or total power")
    count = sum(len(measured) for measured, _, _ in pairs)

    def left(log_delay: float) -> float:
        delay = float(np.exp(log_delay))
        return sum(
            float(((lagged(model, step, delay) - measured) ** 2).sum())
            for measured, model, step in pairs
        )

    trials = np.linspace(np.log(SHORTEST), np.log(LONGEST), GRID)
    misses = np.array([left(trial) for trial in trials])
    best = int(misses.argmin())
    bounds = trials[max(best - 1, 0)], trials[min(best + 1, GRID - 1)]
    found = minimize_scalar(left, bounds=bounds, method="bounded")
    least = min(float(found.fun), float(misses[best]))
    # Residuals within a block are not independent: so much more may be left by chance.
    bound = least * (1.0 + CHANCE / max(1, min(calibration.blocks, count)))
    inside = np.flatnonzero(misses <= bound)
    low, high = np.exp(trials[inside[[0, -1]]]) if len(inside) else np.exp(bounds)
    reason = ""
    if low <= SHORTEST * 1.01:
        reason = "shorter than these samples can show"
    elif high >= LONGEST * 0.99:
        reason = "no delay makes the model better"
    return Delay(value=float(np.exp(found.x)), low=float(low), high=float(high), reason=reason)


def lagged(power: Floats, step: float, delay: float) -> Floats:
    """Power behind a first-order lag, (N,) samples a step in s apart; straight between them."""
    ratio = step / delay
    decay = float(np.exp(-ratio))
    now = 1.0 - (1.0 - decay) / ratio
    before = 1.0 - decay - now
    shown = np.empty(len(power))
    value, last = float(power[0]), float(power[0])
    for row, load in enumerate(power.tolist()):
        value = decay * value + before * last + now * load
        shown[row], last = value, load
    return shown


def _pair(
    run: RunFeatures, calibration: Calibration, efficiency: float
) -> tuple[Floats, Floats, float] | None:
    """Measured power of the cut, the model's, and the time between samples.

    As in :mod:`simulator.machine.disturbance`, only the cut shows late: the control knows of
    the spindle's own speed in advance.
    """
    part = Component.SPINDLE if Component.SPINDLE in run.measured else Component.TOTAL
    if part not in run.measured:
        return None
    idle_run = replace(run, cutting_power=np.zeros(len(run)))
    model, idle = (
        powers(design(each, efficiency=efficiency), calibration.values)[part]
        for each in (run, idle_run)
    )
    return run.measured[part] - idle, model - idle, float(np.median(run.duration))
