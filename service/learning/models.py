"""Models of scikit-learn, each with its normalisation inside."""

import warnings
from collections.abc import Callable
from enum import StrEnum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.compose import ColumnTransformer, TransformedTargetRegressor
from sklearn.ensemble import GradientBoostingRegressor, RandomForestRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.linear_model import LinearRegression
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer, OneHotEncoder, StandardScaler

from service.learning.table import Features
from stepnc_model.errors import StepNcError

Floats = NDArray[np.float64]

MOST_GP_ROWS = 5_000
"""Rows with which a Gaussian process is trained at most: its time grows with their cube."""


class Predictor(Protocol):
    """What has learned."""

    def predict(self, values: Floats) -> Floats:
        """Predict targets, (N,), from features, (N, F)."""


class ModelKind(StrEnum):
    """Kind of model."""

    MLP = "mlp"
    GP = "gp"
    FOREST = "forest"
    BOOSTING = "boosting"
    POWER_LAW = "power-law"


def trained(
    kind: ModelKind, features: Features, values: Floats, target: Floats, *, seed: int
) -> tuple[Predictor, tuple[str, ...]]:
    """Train a model.

    Parameters
    ----------
    kind : ModelKind
    features : Features
    values : (N, F) array
    target : (N,) array
    seed : int

    Returns
    -------
    Predictor, and what scikit-learn warned of

    Raises
    ------
    StepNcError
        When the model cannot be trained with these rows.
    """
    if kind is ModelKind.GP and len(target) > MOST_GP_ROWS:
        raise StepNcError(
            f"--model gp with {len(target)} rows: it must be at most {MOST_GP_ROWS}; "
            "use fewer with --train, or another model"
        )
    model = BUILDERS[kind](features, seed)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ConvergenceWarning)
        model.fit(values, target)
    return model, tuple(dict.fromkeys(str(each.message).split("\n")[0] for each in caught))


def _prepared(features: Features, numbers: Any) -> Any:
    """Numbers as they are prepared, and one column for each name."""
    first = len(features.numbers)
    names = list(range(first, first + len(features.names)))
    steps = [("numbers", numbers, list(range(first)))]
    if names:
        categories = [list(map(float, range(len(each)))) for each in features.names.values()]
        steps.append((
            "names",
            OneHotEncoder(categories=categories, drop="first", sparse_output=False),
            names,
        ))
    return ColumnTransformer(steps)


def _scaled(features: Features, model: Any) -> Any:
    """Model of standardised features and target."""
    return TransformedTargetRegressor(
        make_pipeline(_prepared(features, StandardScaler()), model),
        transformer=StandardScaler(),
    )


def _mlp(features: Features, seed: int) -> Any:
    return _scaled(
        features,
        MLPRegressor(
            hidden_layer_sizes=(16, 16),
            activation="tanh",
            solver="lbfgs",
            alpha=1e-3,
            max_iter=5_000,
            max_fun=100_000,
            random_state=seed,
        ),
    )  # fmt: skip


def _gp(features: Features, seed: int) -> Any:
    columns = len(features.numbers) + sum(len(each) - 1 for each in features.names.values())
    kernel = ConstantKernel(1.0, (1e-3, 1e5)) * RBF(
        np.ones(columns), (1e-2, 1e4)
    ) + WhiteKernel(1e-3, (1e-10, 1e1))
    return _scaled(features, GaussianProcessRegressor(kernel, random_state=seed))


def _forest(features: Features, seed: int) -> Any:
    forest = RandomForestRegressor(n_estimators=200, min_samples_leaf=2, random_state=seed)
    return make_pipeline(_prepared(features, StandardScaler()), forest)


def _boosting(features: Features, seed: int) -> Any:
    boosting = GradientBoostingRegressor(
        n_estimators=500, learning_rate=0.05, min_samples_leaf=5, random_state=seed
    )
    return make_pipeline(_prepared(features, StandardScaler()), boosting)


def _power_law(features: Features, _seed: int) -> Any:
    """Product of powers of the settings, by least squares of logarithms."""
    return TransformedTargetRegressor(
        make_pipeline(_prepared(features, FunctionTransformer(np.log)), LinearRegression()),
        func=np.log,
        inverse_func=np.exp,
    )


BUILDERS: dict[ModelKind, Callable[[Features, int], Any]] = {
    ModelKind.MLP: _mlp,
    ModelKind.GP: _gp,
    ModelKind.FOREST: _forest,
    ModelKind.BOOSTING: _boosting,
    ModelKind.POWER_LAW: _power_law,
}
