"""Models: what each learns, with its normalisation inside."""

import numpy as np
import pytest

from service.learning.models import ModelKind, trained
from service.learning.scores import scores_of
from service.learning.table import Features, learning_table
from stepnc_model.errors import StepNcError
from tests.service.learning.tables import law_table

LEAST = {
    ModelKind.MLP: 0.999,
    ModelKind.GP: 0.999,
    ModelKind.FOREST: 0.9,
    ModelKind.BOOSTING: 0.9,
    ModelKind.POWER_LAW: 1.0 - 1e-9,
}
"""R² that a model reaches on 150 rows of a smooth law with two machines."""


@pytest.mark.parametrize("kind", list(ModelKind))
def test_a_model_learns_a_smooth_law_of_two_machines(kind: ModelKind) -> None:
    rows = learning_table(law_table(200, machines=("a", "b")), "total_power_w", place="here")
    assert rows.features.names == {"machine": ("a", "b")}
    model, _ = trained(kind, rows.features, rows.values[:150], rows.target[:150], seed=1)
    predicted = model.predict(rows.values[150:])
    assert scores_of(rows.target[150:], predicted, seed=1).r2.value > LEAST[kind]


@pytest.mark.parametrize("kind", [ModelKind.MLP, ModelKind.FOREST])
def test_units_of_features_do_not_matter(kind: ModelKind) -> None:
    rows = learning_table(law_table(60), "total_power_w", place="here")
    large = rows.values * np.array([1024.0, 1.0, 1 / 1024.0])
    one, _ = trained(kind, rows.features, rows.values, rows.target, seed=1)
    other, _ = trained(kind, rows.features, large, rows.target, seed=1)
    assert other.predict(large) == pytest.approx(one.predict(rows.values), rel=1e-6)


def test_a_gaussian_process_refuses_many_rows() -> None:
    features = Features(numbers=("feed_mm_s",), names={})
    with pytest.raises(StepNcError, match="gp with 5001 rows: it must be at most 5000"):
        trained(ModelKind.GP, features, np.ones((5001, 1)), np.ones(5001), seed=1)
