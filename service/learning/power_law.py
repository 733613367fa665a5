"""Power law of settings: ``ln y = c_0 + Σ c_i ln x_i``, fitted by least squares of logarithms.

Settings that may be 0 enter as they are, and each name but the first has a factor of its own.
The sums of the normal equations are gathered piece by piece about their means, [1]_, so that
rows need not be in memory and large means cost no digits.

References
----------
.. [1] T. F. Chan, G. H. Golub, R. J. LeVeque, "Algorithms for Computing the Sample Variance",
   The American Statistician 37 (1983), pp. 242-247.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from service.learning.table import MAY_BE_ZERO, Features, Floats, LearningTable


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
    """Power law of the rows of some tables, by least squares.

    Parameters
    ----------
    features : Features
    tables : iterable of LearningTable
    """
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
