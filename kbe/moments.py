"""Running mean, scatter and linear trend of a stream, from moments, without storing values.

References
----------
.. [1] B. P. Welford, "Note on a method for calculating corrected sums of squares and
   products", Technometrics 4 (1962), 419-420.
.. [2] N. R. Draper, H. Smith, "Applied Regression Analysis", 3rd ed., 1998, §1.4: slope,
   its standard error, and t with n − 2 degrees of freedom.
"""

from dataclasses import dataclass
from math import sqrt

from kbe.student import StudentT

SIGNIFICANT = 0.01
"""Significance level of a trend; low, because a table tests many trends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """Linear trend of a value from run to run, by least squares, [2]_.

    Runs are assumed independent.
    """

    per_run: float
    standard_error: float
    runs: int
    """Number of runs with a value, at least 3."""
    chance: float
    """Probability of a slope as steep, up or down, if there is no trend."""

    @property
    def is_significant(self) -> bool:
        """Whether the trend is statistically significant."""
        return self.chance < SIGNIFICANT


class Moments:
    """Count, means and centred sums of points (x, y), [1]_ (mutable state)."""

    def __init__(self) -> None:
        self.count = 0
        self.mean = 0.0
        """Mean of the y values."""
        self._centre = 0.0
        self._xx = self._xy = self._yy = 0.0

    def add(self, x: float, y: float) -> None:
        """Add one point (x, y)."""
        self.count += 1
        from_x, from_y = x - self._centre, y - self.mean
        self._centre += from_x / self.count
        self.mean += from_y / self.count
        self._xx += from_x * (x - self._centre)
        self._xy += from_x * (y - self.mean)
        self._yy += from_y * (y - self.mean)

    @property
    def deviation(self) -> float | None:
        """Standard deviation of y; None for fewer than two points."""
        return sqrt(self._yy / (self.count - 1)) if self.count > 1 else None

    @property
    def trend(self) -> Trend | None:
        """Least-squares line; None for fewer than three points, or points at one x."""
        if self.count < 3 or self._xx <= 0.0:
            return None
        slope = self._xy / self._xx
        degrees = self.count - 2
        # Rounding may make the residual of collinear points slightly negative.
        left = max(0.0, self._yy - slope * self._xy)
        error = sqrt(left / degrees / self._xx)
        return Trend(
            per_run=slope,
            standard_error=error,
            runs=self.count,
            chance=_chance(slope, error, degrees),
        )


def _chance(slope: float, error: float, degrees: int) -> float:
    """Two-sided probability of a slope if there is no trend."""
    if error == 0.0:
        return 0.0 if slope != 0.0 else 1.0
    return 2.0 * StudentT(centre=0.0, scale=error, degrees=degrees).below(-abs(slope))
