"""A learned model with what it needs to predict: columns, trained box and target."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from service.learning.models import ModelKind, Predictor
from service.learning.table import Features, Floats, feature_values
from stepnc_model.errors import StepNcError

UNITS = {"mm_s": "mm/s", "rad_s": "rad/s", "mm": "mm", "s": "s", "j": "J", "w": "W"}
"""Units by the ends of column names."""

ROUNDING = 1e-9
"""Share by which a value may exceed a bound because of rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LearnedModel:
    """A model, and the box of settings in which it was trained."""

    kind: ModelKind
    target: str
    features: Features
    low: Mapping[str, float]
    """Least trained value of each number."""
    high: Mapping[str, float]
    rows: int
    """Rows with which it was trained."""
    predictor: Predictor

    def predicted(self, table: pa.Table, *, place: str) -> Floats:
        """Predict the target of rows, (N,).

        Raises
        ------
        StepNcError
            When a column is missing, or a row lies outside the trained box.
        """
        values = feature_values(table, self.features, place=place)
        for column, name in enumerate(self.features.numbers):
            self._require_trained(name, values[:, column], place)
        return np.asarray(self.predictor.predict(values), dtype=np.float64)

    def _require_trained(self, name: str, values: Floats, place: str) -> None:
        """Refuse values outside the trained box: a model knows nothing there."""
        low, high, unit = self.low[name], self.high[name], unit_of(name)
        for is_bad, word, bound in (
            (values < low * (1.0 - ROUNDING), "is below", low),
            (values > high * (1.0 + ROUNDING), "exceeds", high),
        ):
            if is_bad.any():
                row = int(np.flatnonzero(is_bad)[0])
                at = f"row {row + 1}: " if len(values) > 1 else ""
                raise StepNcError(
                    f"{place}: {at}{name} {values[row]:g} {unit} {word} {bound:g} {unit}, "
                    "the bound of the rows that trained the model"
                )


def unit_of(column: str) -> str:
    """Unit of a column, by its name."""
    ends = ("_".join(column.split("_")[-count:]) for count in (2, 1))
    return next((UNITS[each] for each in ends if each in UNITS), "")
