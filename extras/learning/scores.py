"""Scores of predictions: R², MAE, RMSE and MAPE, with bootstrap intervals of 95 %.

The rows of the test are drawn anew with replacement, and the scores computed of each draw; the
interval has the middle 95 % of them. It says how much the choice of test rows matters, not how
much the choice of training rows does.

Scores of ways to predict as a table, and the names of what is simpler.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from extras.learning.models import LearnedModel
from service.rendering.columns import Column

Floats = NDArray[np.float64]

DRAWS = 1_000
"""Draws of the bootstrap."""

AT_ONCE = 1 << 20
"""Rows that are drawn together, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """A figure with the interval of 95 % of its bootstrap."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Scores:
    """Scores of predictions."""

    r2: Score | None
    """Coefficient of determination R²; None if the actual values are all the same."""
    mae: Score
    """Mean absolute error, in the unit of the target."""
    rmse: Score
    """Root of the mean squared error, in the unit of the target."""
    mape: Score
    """Mean absolute error over the actual value, in %."""


def scores_of(actual: Floats, predicted: Floats, *, seed: int) -> Scores:
    """Scores of predictions with their intervals.

    Parameters
    ----------
    actual, predicted : (N,) array
        No actual value is zero.
    seed : int
        Seed of the bootstrap.
    """
    rng = np.random.default_rng(seed)
    size = max(1, AT_ONCE // len(actual))
    drawn = [
        _figures(actual[rows], predicted[rows])
        for first in range(0, DRAWS, size)
        for rows in [rng.integers(0, len(actual), (min(size, DRAWS - first), len(actual)))]
    ]
    low, high = np.quantile(np.concatenate(drawn), (0.025, 0.975), axis=0)
    value = _figures(actual[None], predicted[None])[0]
    r2, mae, rmse, mape = (
        Score(value=float(each), low=float(least), high=float(most))
        for each, least, most in zip(value, low, high, strict=True)
    )
    is_constant = np.ptp(actual) <= 1e-12 * abs(float(actual[0]))
    return Scores(r2=None if is_constant else r2, mae=mae, rmse=rmse, mape=mape)


def mean_score(values: Floats, rng: np.random.Generator) -> Score:
    """Mean of values with the interval of its bootstrap."""
    size = max(1, AT_ONCE // len(values))
    drawn = [
        values[rng.integers(0, len(values), (min(size, DRAWS - first), len(values)))].mean(
            axis=1
        )
        for first in range(0, DRAWS, size)
    ]
    low, high = np.quantile(np.concatenate(drawn), (0.025, 0.975)).tolist()
    return Score(value=float(values.mean()), low=low, high=high)


def _figures(actual: Floats, predicted: Floats) -> Floats:
    """R², MAE, RMSE and MAPE of D draws of N rows, (D, 4)."""
    error = predicted - actual
    squares = np.mean(error**2, axis=1)
    spread = np.var(actual, axis=1)
    # A draw of equal rows has no spread; its R² is as low as it gets, not a division by zero.
    r2 = 1.0 - squares / np.maximum(spread, np.finfo(float).tiny * 1e8)
    mape = 100.0 * np.mean(np.abs(error / actual), axis=1)
    return np.stack((r2, np.mean(np.abs(error), axis=1), np.sqrt(squares), mape), axis=1)


MEAN, PHYSICS_ALONE, FITTED = "mean", "physics", "k_c and idle power"
"""Baselines: the mean of the training rows; the virtual machine without deviation, and with a
factor on k_c and an offset of the idle power that fit the training rows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoredModel:
    """Scores of one way to predict."""

    name: str
    scores: Scores


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvePoint:
    """Scores of the model after some training rows."""

    rows: int
    scores: Scores


def score_columns(unit: str) -> tuple[Column[ScoredModel], ...]:
    """Columns of the scores; errors in the unit of the target."""
    name: Column[ScoredModel] = Column(
        heading="model", is_key=True, is_words=True, value=lambda row: row.name
    )
    return (name, *error_columns(unit))


def error_columns(unit: str) -> tuple[Column[Any], ...]:
    """Columns of the scores of a row."""
    return (
        Column(heading="R²", is_right=True, value=lambda row: _fraction(row.scores.r2)),
        Column(heading=f"MAE {unit}", is_right=True, value=lambda row: _text(row.scores.mae)),
        Column(heading=f"RMSE {unit}", is_right=True, value=lambda row: _text(row.scores.rmse)),
        Column(heading="MAPE %", is_right=True, value=lambda row: _text(row.scores.mape)),
    )


def _fraction(score: Score | None) -> str:
    if score is None:
        return "–"
    return f"{score.value:.5f} ({score.low:.5f} to {score.high:.5f})"


def _text(score: Score) -> str:
    return f"{score.value:.3g} ({score.low:.3g} to {score.high:.3g})"


def model_name(model: LearnedModel) -> str:
    """Target and kind of a model."""
    on = " on the physics" if model.physics else ""
    return f"{model.target} by {model.kind.value}{on}"
