"""Factor on k_c and offset of the idle power of a measured machine, over the physics.

``P = P_physics + a + (K − 1) · P_cut``, by least squares over runs; P_cut is what the physics
says that the main drive needs for the cut. The axes feel k_c too, by their feed force: their
share counts as part of the cut, which makes K − 1 some thousandths too great. Units W.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import sqrt

import numpy as np

from service.learning.table import Floats, LearningTable


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFactor:
    """What a machine needs beside the physics."""

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
