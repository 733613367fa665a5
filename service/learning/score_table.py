"""Scores of ways to predict as a table, and the names of what is simpler."""

from dataclasses import dataclass
from typing import Any

from service.learning.learned import LearnedModel
from service.learning.scores import Score, Scores
from service.rendering.columns import Column

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
