"""Scoring: a model on measured runs, beside what is simpler, and drift."""

import numpy as np
import pyarrow as pa

from extras.learning.drift import drift_of
from extras.learning.model_file import load_model
from extras.learning.models import LearnedModel, ModelKind
from extras.learning.scores import MEAN, PHYSICS_ALONE, ScoredModel, scores_of
from extras.learning.source import RowSource
from extras.learning.table import PHYSICS, Floats, feature_values, positive_of, with_recorded
from extras.learning.verbs.score.request import ScoreFiles, ScoreRequest
from extras.learning.verbs.score.result import ScoreResult
from service.progress import Tell, silent
from stepnc_model.errors import StepNcError

FEWEST, MOST = 5, 100_000
"""Runs that are scored."""

ORDER = "order of the runs"


def run(request: ScoreRequest, files: ScoreFiles, *, tell: Tell = silent) -> ScoreResult:
    """Score a model on measured runs.

    Raises
    ------
    StepNcError
        When the model or the table is not usable.
    """
    runs = files.runs
    model = load_model(files.model)
    place, table = str(runs), RowSource(runs).table(0, MOST + 1)
    table = with_recorded(table, model.target, folder=runs.parent)
    if table.num_rows > MOST:
        raise StepNcError(f"{runs}: more than {MOST} runs: score the latest ones")
    values = feature_values(table, model.features, place=place)
    actual = positive_of(table, model.target, place=place)
    outside = model.outside(values)
    inside = np.setdiff1d(np.arange(len(actual)), [row for row, _ in outside])
    if len(inside) < FEWEST:
        why = f"; row {outside[0][0] + 1}: {outside[0][1]}" if outside else ""
        raise StepNcError(
            f"{runs}: {len(inside)} runs in the trained box: it must be at least {FEWEST}{why}"
        )
    table, values, actual = table.take(inside), values[inside], actual[inside]
    predicted = model.predicted_of(table, values, place=place)
    named = {model.kind.value: predicted, **_simpler(model, table, values, place)}
    return ScoreResult(
        model=model,
        rows=tuple((inside + 1).tolist()),
        left_out=tuple((row + 1, text) for row, text in outside),
        scored=tuple(
            ScoredModel(name=name, scores=scores_of(actual, each, seed=request.seed))
            for name, each in named.items()
        ),
        drift=drift_of(
            actual / predicted - 1.0,
            model.residuals,
            {**_settings(model, values), ORDER: np.arange(len(inside), dtype=np.float64)},
            false_alarm=request.false_alarm,
            seed=request.seed,
        ),
    )


def _simpler(
    model: LearnedModel, table: pa.Table, values: Floats, place: str
) -> dict[str, Floats]:
    """Predictions of runs by what is simpler."""
    found = {MEAN: np.full(len(values), model.baseline.mean)}
    if model.kind is not ModelKind.POWER_LAW or model.physics:
        name = "power-law alone" if model.physics else ModelKind.POWER_LAW.value
        found[name] = model.baseline.law.predict(values)
    exact = PHYSICS.get(model.target, "")
    if exact in table.column_names:
        found[PHYSICS_ALONE] = positive_of(table, exact, place=place)
    return found


def _settings(model: LearnedModel, values: Floats) -> dict[str, Floats]:
    """Settings that residuals may go with: numbers, and 0 or 1 for each name."""
    features = model.features
    found = {name: values[:, place] for place, name in enumerate(features.numbers)}
    for place, (column, names) in enumerate(features.names.items(), len(features.numbers)):
        for code, name in enumerate(names):
            found[f"{column} {name}"] = (values[:, place] == code).astype(np.float64)
    return found
