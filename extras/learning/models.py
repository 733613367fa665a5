"""Models of scikit-learn, each with its normalisation inside.

Trees cannot follow a smooth slope, so they start where a power law ends: boosting corrects a
power law of the settings, and the trees of the forest are split at random places, whose mean is
smoother than that of best splits, [1]_.

Factor on k_c and offset of the idle power of a measured machine, over the physics.

``P = P_physics + a + (K − 1) · P_cut``, by least squares over runs; P_cut is what the physics
says that the main drive needs for the cut. The axes feel k_c too, by their feed force: their
share counts as part of the cut, which makes K − 1 some thousandths too great. Units W.

Power law of settings: ``ln y = c_0 + Σ c_i ln x_i``, fitted by least squares of logarithms.

Settings that may be 0 enter as they are, and each name but the first has a factor of its own.
The sums of the normal equations are gathered piece by piece about their means, [2]_, so that
rows need not be in memory and large means cost no digits.

A learned model with what it needs to predict, and to judge later runs.

References
----------
.. [1] P. Geurts, D. Ernst, L. Wehenkel, "Extremely randomized trees", Machine Learning 63
   (2006), pp. 3-42.
.. [2] T. F. Chan, G. H. Golub, R. J. LeVeque, "Algorithms for Computing the Sample Variance",
   The American Statistician 37 (1983), pp. 242-247.
"""

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import sqrt
from typing import Any, Protocol

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
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

from extras.learning.table import (
    MAY_BE_ZERO,
    Features,
    Floats,
    LearningTable,
    feature_values,
    joined,
    positive_of,
    unit_of,
)
from stepnc_model.errors import StepNcError


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerLaw:
    """Power law of the features of a table."""

    features: Features
    constant: float
    """c_0"""
    coefficients: tuple[float, ...]
    """Of the columns of :func:`logarithms`."""

    def predict(self, values: Floats) -> Floats:
        """Predict targets, (N,), from features, (N, F)."""
        logs = logarithms(self.features, values)
        found: Floats = np.exp(self.constant + logs @ np.array(self.coefficients))
        return found


def logarithms(features: Features, values: Floats) -> Floats:
    """Logarithms of the numbers, and a column of 0 or 1 for each name but the first, (N, P)."""
    columns = [
        values[:, place] if name in MAY_BE_ZERO else np.log(values[:, place])
        for place, name in enumerate(features.numbers)
    ]
    for place, names in enumerate(features.names.values(), start=len(features.numbers)):
        columns += [
            (values[:, place] == code).astype(np.float64) for code in range(1, len(names))
        ]
    return np.stack(columns, axis=1)


def fitted_law(features: Features, tables: Iterable[LearningTable]) -> PowerLaw:
    """Power law of the rows of some tables, by least squares."""
    count, mean, squares = 0, np.zeros(1), np.zeros((1, 1))
    for table in tables:
        logs = logarithms(features, table.values)
        rows = np.column_stack((logs, np.log(table.target)))
        middle = rows.mean(axis=0)
        about = rows - middle
        if not count:
            mean, squares = np.zeros_like(middle), np.zeros((len(middle), len(middle)))
        total = count + len(rows)
        step = middle - mean
        squares = squares + about.T @ about
        squares += np.outer(step, step) * (count * len(rows) / total)
        mean = mean + step * (len(rows) / total)
        count = total
    # Columns that say the same share their effect, where equations alone have no solution.
    found, *_ = np.linalg.lstsq(squares[:-1, :-1], squares[:-1, -1], rcond=1e-12)
    return PowerLaw(
        features=features,
        constant=float(mean[-1] - mean[:-1] @ found),
        coefficients=tuple(found.tolist()),
    )


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
    """A trained model."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFactor:
    """Factor of a machine's force over the physics."""

    factor: float
    """Factor K on k_c."""
    factor_error: float
    """Standard error of the factor."""
    offset: float
    """Offset a of the power whatever is cut, W."""
    offset_error: float
    runs: int

    def predict(self, physics: Floats, cutting: Floats) -> Floats:
        """Power of runs, (N,), from that by the physics and its part of the cut."""
        return physics + self.offset + (self.factor - 1.0) * cutting


def force_factor_of(tables: Iterable[LearningTable]) -> ForceFactor | None:
    """Fit the factor on k_c to measured runs; None if the cut does not vary among them.

    Parameters
    ----------
    tables : iterable of LearningTable
        With physics and cutting power.
    """
    # Sums of x, x², y, xy and y², about the first run so that large means cost no digits.
    count, start, sums = 0, 0.0, np.zeros(5)
    for table in tables:
        if table.physics is None or table.cutting is None:
            return None
        start = start if count else float(table.cutting[0])
        cut, more = table.cutting - start, table.target - table.physics
        sums += np.array([cut.sum(), cut @ cut, more.sum(), cut @ more, more @ more])
        count += len(more)
    if count < 3:
        return None
    x, xx, y, xy, yy = sums.tolist()
    spread = xx - x * x / count
    if spread <= 1e-12 * max(xx, start * start * count):
        return None
    slope = (xy - x * y / count) / spread
    level = (y - slope * x) / count
    left = max(0.0, yy - y * y / count - slope * slope * spread) / (count - 2)
    middle = start + x / count
    return ForceFactor(
        factor=float(1.0 + slope),
        factor_error=sqrt(left / spread),
        offset=float(level - slope * start),
        offset_error=sqrt(left * (1.0 / count + middle * middle / spread)),
        runs=count,
    )


ROUNDING = 1e-9
"""Share by which a value may exceed a bound because of rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Baseline:
    """Simpler prediction from the same rows, to compare with."""

    mean: float
    """Mean of the target."""
    law: PowerLaw
    """Power law of the target."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LearnedModel:
    """A model, and the box of settings in which it was trained."""

    kind: ModelKind
    target: str
    features: Features
    physics: str
    """Column that the prediction is multiplied with; empty: the model stands alone."""
    low: Mapping[str, float]
    """Least trained value of each number."""
    high: Mapping[str, float]
    rows: int
    """Rows with which it was trained."""
    predictor: Predictor
    baseline: Baseline
    residuals: tuple[float, ...]
    """Quantiles of actual over predicted less 1 of the test rows, ascending."""
    manifest: str
    """Digest of the manifest of the data set; empty: it had none."""

    def predicted(self, table: pa.Table, *, place: str) -> Floats:
        """Predict the target of rows, (N,).

        Raises
        ------
        StepNcError
            When a column is missing, or a row lies outside the trained box.
        """
        values = feature_values(table, self.features, place=place)
        for at, text in self.outside(values):
            row = f"row {at + 1}: " if len(values) > 1 else ""
            raise StepNcError(f"{place}: {row}{text}")
        return self.predicted_of(table, values, place=place)

    def predicted_of(self, table: pa.Table, values: Floats, *, place: str) -> Floats:
        """Predict the target of rows, (N,), wherever they lie.

        Raises
        ------
        StepNcError
            When the column of the physics is missing.
        """
        found = np.asarray(self.predictor.predict(values), dtype=np.float64)
        if not self.physics:
            return found
        return found * positive_of(table, self.physics, place=place)

    def outside(self, values: Floats) -> list[tuple[int, str]]:
        """Rows outside the trained box, where a model knows nothing: places and reasons."""
        found: dict[int, str] = {}
        for column, name in enumerate(self.features.numbers):
            low, high, unit = self.low[name], self.high[name], unit_of(name)
            each = values[:, column]
            for is_bad, word, bound in (
                (each < low * (1.0 - ROUNDING), "is below", low),
                (each > high * (1.0 + ROUNDING), "exceeds", high),
            ):
                for row in np.flatnonzero(is_bad).tolist():
                    text = f"{name} {each[row]:g} {unit} {word} {bound:g} {unit}"
                    found.setdefault(
                        row, f"{text}, the bound of the rows that trained the model"
                    )
        return sorted(found.items())


def quantiles_of(residuals: Floats, most: int = 1_000) -> tuple[float, ...]:
    """Residuals in ascending order; evenly spaced quantiles if there are many."""
    places: NDArray[np.float64] = np.linspace(0.0, 1.0, min(most, len(residuals)))
    return tuple(np.quantile(residuals, places).tolist())
