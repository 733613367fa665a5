"""Models: what each learns, with its normalisation inside."""

from collections.abc import Iterator

import numpy as np
import pytest

from extras.learning import models
from extras.learning.models import ModelKind, Predictor, trained
from extras.learning.scores import scores_of
from extras.learning.table import Features, LearningTable, features_of, learning_table
from stepnc_model.errors import StepNcError
from tests.extras.learning.tables import law_table

LEAST = {
    ModelKind.MLP: 0.999,
    ModelKind.GP: 0.999,
    ModelKind.FOREST: 0.98,
    ModelKind.BOOSTING: 0.9999,
    ModelKind.POWER_LAW: 1.0 - 1e-9,
}
"""R² that a model reaches on 150 rows of a smooth law with two machines."""


def rows_of(count: int, *, noise: float = 0.0) -> LearningTable:
    table = law_table(count, noise=noise, machines=("a", "b"))
    features, _ = features_of([table], place="here")
    return learning_table(table, features, "total_power_w", place="here")


def part_of(rows: LearningTable, first: int, last: int) -> LearningTable:
    part = slice(first, last)
    return LearningTable(
        features=rows.features,
        values=rows.values[part],
        target=rows.target[part],
        physics=None,
    )


def taught(kind: ModelKind, rows: LearningTable, *, piece: int = 10_000) -> Predictor:
    """Model of rows that come in pieces."""

    def pieces() -> Iterator[LearningTable]:
        for first in range(0, len(rows), piece):
            yield part_of(rows, first, first + piece)

    model, _ = trained(kind, rows.features, pieces, rows=len(rows), seed=1)
    return model


def r2_of(model: Predictor, rows: LearningTable) -> float:
    score = scores_of(rows.target, model.predict(rows.values), seed=1).r2
    assert score is not None
    return score.value


@pytest.mark.parametrize("kind", list(ModelKind))
def test_a_model_learns_a_smooth_law_of_two_machines(kind: ModelKind) -> None:
    rows = rows_of(200)
    assert rows.features.names == {"machine": ("a", "b")}
    model = taught(kind, part_of(rows, 0, 150), piece=40)
    assert r2_of(model, part_of(rows, 150, 200)) > LEAST[kind]


@pytest.mark.parametrize("kind", [ModelKind.MLP, ModelKind.FOREST])
def test_units_of_features_do_not_matter(kind: ModelKind) -> None:
    rows = rows_of(60)
    scale = np.array([1024.0, 1.0, 1 / 1024.0, 1.0])
    large = LearningTable(
        features=rows.features, values=rows.values * scale, target=rows.target, physics=None
    )
    one, other = taught(kind, rows), taught(kind, large)
    tolerance = 1e-6 if kind is ModelKind.MLP else 0.05
    assert other.predict(large.values) == pytest.approx(one.predict(rows.values), rel=tolerance)


@pytest.mark.parametrize("kind", [ModelKind.POWER_LAW, ModelKind.MLP])
def test_pieces_teach_as_much_as_all_rows_at_once(
    kind: ModelKind, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = rows_of(6_200, noise=0.02)
    train, test = part_of(rows, 0, 6_000), part_of(rows, 6_000, 6_200)
    whole = taught(kind, train)
    monkeypatch.setattr(models, "NETWORK_AT_ONCE", 1_000)
    monkeypatch.setattr(models, "SEEN", 600_000)
    pieces = taught(kind, train, piece=700)
    if kind is ModelKind.POWER_LAW:
        assert pieces.predict(test.values) == pytest.approx(whole.predict(test.values))
    assert r2_of(pieces, test) > r2_of(whole, test) - 1e-3


@pytest.mark.parametrize(("kind", "most"), [(ModelKind.GP, 5_000), (ModelKind.FOREST, 200_000)])
def test_models_refuse_more_rows_than_they_can_hold(kind: ModelKind, most: int) -> None:
    features = Features(numbers=("feed_mm_s",), names={})
    text = f"--model {kind} with {most + 1} rows: it must be at most {most}; use fewer with"
    with pytest.raises(StepNcError, match=text):
        trained(kind, features, lambda: iter(()), rows=most + 1, seed=1)
