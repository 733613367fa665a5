"""Use case of ``stepnc learn``: a model, its scores, and those of what is simpler."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from service.learning.learned import LearnedModel
from service.learning.models import ModelKind, trained
from service.learning.scores import Score, Scores, scores_of
from service.learning.table import (
    TARGETS,
    Floats,
    LearningTable,
    learning_table,
    read_table,
)
from service.requests.fields import member_of, require_bounds
from service.requests.learning import LearnRequest
from stepnc_model.errors import StepNcError

MEAN, PHYSICS = "mean", "physics"
"""Baselines: the mean of the training rows, and the virtual machine without deviation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoredModel:
    """Scores of one way to predict."""

    name: str
    scores: Scores


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LearnResult:
    """A learned model with its test."""

    model: LearnedModel
    test: int
    """Rows of the test."""
    scored: tuple[ScoredModel, ...]
    """The model first, then its baselines."""
    ceiling: Score | None
    """R² of the physics without deviation: no model of the settings can expect more."""
    warnings: tuple[str, ...]
    actual: Floats
    """Target of the test rows, (M,)."""
    predicted: Floats


def learn(path: Path, request: LearnRequest) -> LearnResult:
    """Train a model on the first rows of a data set and test it on the next ones.

    Raises
    ------
    StepNcError
        When the request, the data set or its target is not usable.
    """
    require_bounds(request)
    kind = member_of(ModelKind, request.model, "model")
    target = request.target
    if target not in TARGETS:
        raise StepNcError(f"unknown target '{target}'; known: {', '.join(TARGETS)}")
    table = read_table(path)
    wanted = request.train + request.test
    if table.num_rows < wanted:
        raise StepNcError(
            f"{path}: {table.num_rows} rows, but --train {request.train} and --test "
            f"{request.test} need {wanted}: make more, or ask for less"
        )
    rows = learning_table(table.slice(0, wanted), target, place=str(path))
    train, test = slice(0, request.train), slice(request.train, wanted)
    for name, part in (("training", train), ("test", test)):
        _require_learnable(rows.target[part], f"{path}: {target} of the {name} rows")
    predictor, warned = trained(
        kind, rows.features, rows.values[train], rows.target[train], seed=request.seed
    )
    numbers = rows.features.numbers
    box = rows.values[train, : len(numbers)]
    predicted = np.asarray(predictor.predict(rows.values[test]), dtype=np.float64)
    named = {kind.value: predicted, **_baselines(rows, kind, train, test)}
    scored = tuple(
        ScoredModel(name=name, scores=scores_of(rows.target[test], each, seed=request.seed))
        for name, each in named.items()
    )
    return LearnResult(
        model=LearnedModel(
            kind=kind,
            target=target,
            features=rows.features,
            low=dict(zip(numbers, box.min(axis=0).tolist(), strict=True)),
            high=dict(zip(numbers, box.max(axis=0).tolist(), strict=True)),
            rows=request.train,
            predictor=predictor,
        ),
        test=request.test,
        scored=scored,
        ceiling=next((each.scores.r2 for each in scored if each.name == PHYSICS), None),
        warnings=warned,
        actual=rows.target[test],
        predicted=predicted,
    )


def _baselines(
    rows: LearningTable, kind: ModelKind, train: slice, test: slice
) -> dict[str, Floats]:
    """Predictions of the test rows by what is simpler."""
    actual = rows.target[test]
    found = {MEAN: np.full(len(actual), rows.target[train].mean())}
    if kind is not ModelKind.POWER_LAW:
        law, _ = trained(
            ModelKind.POWER_LAW, rows.features, rows.values[train], rows.target[train], seed=0
        )
        found[ModelKind.POWER_LAW.value] = law.predict(rows.values[test])
    if rows.physics is not None:
        found[PHYSICS] = rows.physics[test]
    return found


def _require_learnable(target: Floats, what: str) -> None:
    """Refuse a target that is constant, or not positive.

    Raises
    ------
    StepNcError
        With the value.
    """
    if (lowest := float(target.min())) <= 0.0:
        raise StepNcError(f"{what}: {lowest:g} must be positive")
    if np.ptp(target) <= 1e-12 * abs(lowest):
        raise StepNcError(f"{what}: all are {lowest:g}: there is nothing to learn")
