"""A learned model with what it needs to predict, and to judge later runs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from service.learning.models import ModelKind, Predictor
from service.learning.power_law import PowerLaw
from service.learning.table import Features, Floats, feature_values, positive_of, unit_of
from stepnc_model.errors import StepNcError

ROUNDING = 1e-9
"""Share by which a value may exceed a bound because of rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Baseline:
    """What is simpler than the model, from the same rows."""

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
