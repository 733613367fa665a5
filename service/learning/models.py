"""Models of scikit-learn, each with its normalisation inside.

Trees cannot follow a smooth slope, so they start where a power law ends: boosting corrects a
power law of the settings, and the trees of the forest are split at random places, whose mean is
smoother than that of best splits, [1]_.

References
----------
.. [1] P. Geurts, D. Ernst, L. Wehenkel, "Extremely randomized trees", Machine Learning 63
   (2006), pp. 3-42.
"""

import warnings
from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import Any, Protocol

import numpy as np
from sklearn.compose import ColumnTransformer, TransformedTargetRegressor
from sklearn.dummy import DummyRegressor
from sklearn.ensemble import ExtraTreesRegressor, GradientBoostingRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.linear_model import LinearRegression
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer, OneHotEncoder, StandardScaler

from service.learning.power_law import fitted_law
from service.learning.table import MAY_BE_ZERO, Features, Floats, LearningTable, joined
from stepnc_model.errors import StepNcError

IN_MEMORY = 200_000
"""Rows that are in memory at once."""

NETWORK_AT_ONCE = 20_000
"""Rows of which a network sees all in each step; more train it piece by piece."""

EPOCHS, SEEN = 10, 2_000_000
"""Times that a network sees all rows that come in pieces, and rows that it sees, at least."""

FIRST_STEP, LAST_STEP = 5e-3, 1e-5
"""Learning rates of a network whose rows come piece by piece."""

Pieces = Callable[[], Iterator[LearningTable]]
"""Yields the training rows piece by piece, as often as it is called."""


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


MOST_ROWS = {ModelKind.GP: 5_000, ModelKind.FOREST: IN_MEMORY, ModelKind.BOOSTING: IN_MEMORY}
"""Rows that can train a model: the time of a Gaussian process grows with their cube, and trees
need all rows in memory."""


def require_trainable(kind: ModelKind, rows: int) -> None:
    """Refuse more rows than a model can be trained with.

    Raises
    ------
    StepNcError
        With the number of rows and the bound.
    """
    most = MOST_ROWS.get(kind)
    if most is not None and rows > most:
        raise StepNcError(
            f"--model {kind} with {rows} rows: it must be at most {most}; "
            "use fewer with --train, or --model mlp or power-law"
        )


def trained(
    kind: ModelKind, features: Features, pieces: Pieces, *, rows: int, seed: int
) -> tuple[Predictor, tuple[str, ...]]:
    """Train a model.

    Parameters
    ----------
    kind : ModelKind
    features : Features
    pieces : callable
        Yields the rows.
    rows : int
        Number of rows.
    seed : int

    Returns
    -------
    Predictor, and what scikit-learn warned of

    Raises
    ------
    StepNcError
        When the model cannot be trained with so many rows.
    """
    require_trainable(kind, rows)
    if kind is ModelKind.POWER_LAW:
        return fitted_law(features, pieces()), ()
    if kind is ModelKind.MLP and rows > NETWORK_AT_ONCE:
        return _network_by_pieces(features, pieces, rows=rows, seed=seed), ()
    table = joined(list(pieces()))
    model = BUILDERS[kind](features, seed)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ConvergenceWarning)
        model.fit(table.values, table.target)
    return model, tuple(dict.fromkeys(str(each.message).split("\n")[0] for each in caught))


def _network_by_pieces(features: Features, pieces: Pieces, *, rows: int, seed: int) -> Any:
    """Network that sees one piece of the rows at a time, several times."""
    model = _scaled(features, DummyRegressor())
    for number, piece in enumerate(pieces()):
        if not number:
            model.fit(piece.values, piece.target)
            continue
        columns = slice(0, len(features.numbers))
        model.regressor_[0].named_transformers_["numbers"].partial_fit(piece.values[:, columns])
        model.transformer_.partial_fit(piece.target[:, None])
    epochs = max(EPOCHS, SEEN // rows)
    network = MLPRegressor(
        hidden_layer_sizes=(16, 16),
        activation="tanh",
        learning_rate_init=FIRST_STEP,
        random_state=seed,
    )
    for epoch in range(epochs):
        if epoch:
            # Steps that become smaller let it settle where noise would keep it moving.
            step = FIRST_STEP * (LAST_STEP / FIRST_STEP) ** (epoch / epochs)
            network._optimizer.learning_rate_init = step
        for piece in pieces():
            network.partial_fit(
                model.regressor_[0].transform(piece.values),
                model.transformer_.transform(piece.target[:, None]).ravel(),
            )
    model.regressor_.steps[-1] = ("mlpregressor", network)
    model.regressor = model.regressor_
    return model


def _names(features: Features) -> list[tuple[str, Any, list[int]]]:
    """Step that gives each name but the first a column."""
    first = len(features.numbers)
    if not features.names:
        return []
    categories = [list(map(float, range(len(each)))) for each in features.names.values()]
    encoder = OneHotEncoder(categories=categories, drop="first", sparse_output=False)
    return [("names", encoder, list(range(first, first + len(features.names))))]


def _standardised(features: Features) -> Any:
    """Numbers about their means, over their deviations."""
    numbers = ("numbers", StandardScaler(), list(range(len(features.numbers))))
    return ColumnTransformer([numbers, *_names(features)])


def _logarithms(features: Features) -> Any:
    """Logarithms of the numbers that are never 0."""
    places = {name: place for place, name in enumerate(features.numbers)}
    logs = [place for name, place in places.items() if name not in MAY_BE_ZERO]
    plain = [place for name, place in places.items() if name in MAY_BE_ZERO]
    return ColumnTransformer([
        ("logarithms", FunctionTransformer(np.log), logs),
        ("plain", "passthrough", plain),
        *_names(features),
    ])


def _scaled(features: Features, model: Any) -> Any:
    """Model of standardised features and target."""
    return TransformedTargetRegressor(
        make_pipeline(_standardised(features), model), transformer=StandardScaler()
    )


def _of_logarithms(features: Features, model: Any) -> Any:
    """Model of the logarithms of features and target."""
    return TransformedTargetRegressor(
        make_pipeline(_logarithms(features), model), func=np.log, inverse_func=np.exp
    )


def _mlp(features: Features, seed: int) -> Any:
    return _scaled(
        features,
        MLPRegressor(
            hidden_layer_sizes=(16, 16),
            activation="tanh",
            solver="lbfgs",
            # Less follows the noise of a few rows; more flattens the law.
            alpha=0.1,
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
    return _of_logarithms(features, ExtraTreesRegressor(n_estimators=300, random_state=seed))


def _boosting(features: Features, seed: int) -> Any:
    boosting = GradientBoostingRegressor(
        init=LinearRegression(),
        n_estimators=500,
        learning_rate=0.05,
        max_depth=2,
        min_samples_leaf=5,
        subsample=0.5,
        random_state=seed,
    )
    return _of_logarithms(features, boosting)


BUILDERS: dict[ModelKind, Callable[[Features, int], Any]] = {
    ModelKind.MLP: _mlp,
    ModelKind.GP: _gp,
    ModelKind.FOREST: _forest,
    ModelKind.BOOSTING: _boosting,
}
