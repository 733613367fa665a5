"""Statistics of the deviations from the plan, for the four quantities that [1]_ evaluates.

A deviation is measured over predicted, less one. Outcomes are streamed in the order of time;
count, mean, scatter, standard error and trend need moments only, the median and the 95th
percentile a sample of bounded size.

Workingsteps of one run have correlated errors, so the standard error and the trend are those of
the means of runs; mean, scatter, median and 95th percentile are of all outcomes.

Reservoir sampling: a bounded random sample of a stream of any length.

Each value is equally likely to be kept. The sample is exact while the stream is no longer than
the reservoir. Its choice is drawn from a seed, so the same stream gives the same sample.

Student's t distribution with a centre and a scale, for values of unknown scatter.

Running mean, scatter and linear trend of a stream, from moments, without storing values.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Knowledge-based evaluation": cutting forces, feed-rate, machining
   time and surface quality.
.. [2] J. S. Vitter, "Random sampling with a reservoir", ACM Trans. Math. Software 11 (1985),
   37-57, algorithm R.
.. [3] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", The American
   Statistician 50 (1996), 361-365: definition 7.
.. [4] B. P. Welford, "Note on a method for calculating corrected sums of squares and
   products", Technometrics 4 (1962), 419-420.
.. [5] N. R. Draper, H. Smith, "Applied Regression Analysis", 3rd ed., 1998, §1.4: slope,
   its standard error, and t with n − 2 degrees of freedom.
"""

from copy import copy
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite, sqrt
from random import Random

from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome

CAPACITY = 1000
"""Size of the sample; the 95th percentile is then known to ±1.4 percentage points."""
SEED = 14649


class Reservoir:
    """Random sample of a stream of values (mutable state)."""

    def __init__(self, capacity: int = CAPACITY, *, seed: int = SEED) -> None:
        self._capacity = capacity
        self._random = Random(seed)
        self._kept: list[float] = []
        self._count = 0

    def add(self, value: float) -> None:
        """Add one value of the stream, [2]_."""
        self._count += 1
        if len(self._kept) < self._capacity:
            self._kept.append(value)
            return
        place = self._random.randrange(self._count)
        if place < self._capacity:
            self._kept[place] = value

    def quantile(self, share: float) -> float | None:
        """Value below which a share of the stream lies, [3]_; None without values."""
        if not self._kept:
            return None
        ranked = sorted(self._kept)
        place = share * (len(ranked) - 1)
        low = min(int(place), len(ranked) - 2) if len(ranked) > 1 else 0
        high = min(low + 1, len(ranked) - 1)
        return ranked[low] + (place - low) * (ranked[high] - ranked[low])


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentT:
    """Distribution in which ``(x − centre) / scale`` follows Student's t."""

    centre: float
    scale: float
    """Scale of the distribution, above 0."""
    degrees: float
    """Degrees of freedom, above 0."""

    def __post_init__(self) -> None:
        """Check that scale and degrees of freedom are positive."""
        if not (self.scale > 0.0 and self.degrees > 0.0):
            raise ValueError(
                f"scale {self.scale} and degrees of freedom {self.degrees} must be above 0"
            )

    def quantile(self, probability: float) -> float:
        """Value below which a share of the distribution lies, the share between 0 and 1."""
        from scipy.special import stdtrit  # noqa: PLC0415 (scipy takes a fifth of a second)

        if not 0.0 < probability < 1.0:
            raise ValueError(f"probability {probability} is not between 0 and 1")
        return self.centre + self.scale * float(stdtrit(self.degrees, probability))

    def below(self, value: float) -> float:
        """Probability of a value below the given one."""
        from scipy.special import stdtr  # noqa: PLC0415 (scipy takes a fifth of a second)

        return float(stdtr(self.degrees, (value - self.centre) / self.scale))

    def between(self, low: float, high: float) -> float:
        """Probability of a value within an interval."""
        return self.below(high) - self.below(low)


SIGNIFICANT = 0.01
"""Significance level of a trend; low, because a table tests many trends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """Linear trend of a value from run to run, by least squares, [5]_.

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
        """True if the trend is statistically significant."""
        return self.chance < SIGNIFICANT


class Moments:
    """Count, means and centred sums of points (x, y), [4]_ (mutable state)."""

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


HIGH = 0.95
"""Quantile of the high deviation: share of outcomes at or below it."""


class Evaluated(StrEnum):
    """Quantity whose deviation from the plan is evaluated."""

    ROUGHNESS = "roughness"
    TIME = "time"
    FORCE = "force"
    FEED = "feed"


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationStatistics:
    """Statistics of the deviations of one quantity; None: too few values."""

    count: int
    """Number of outcomes with a deviation."""
    missing: int
    """Number of outcomes without a deviation: not predicted, not measured, or not a number."""
    mean: float | None
    deviation: float | None
    """Standard deviation of one outcome; from 2 outcomes."""
    standard_error: float | None
    """Standard error of the mean of runs; from 2 runs."""
    median: float | None
    high: float | None
    """95th percentile of the deviations."""
    runs: int
    """Number of runs with a deviation."""
    runs_above: int
    """Number of runs whose mean lies above the plan."""
    trend: Trend | None
    """Trend from run to run; from 3 runs."""


class DeviationTally:
    """Accumulator of a stream of deviations (mutable state)."""

    def __init__(self) -> None:
        self._missing = 0
        self._outcomes = Moments()
        self._runs = Moments()
        self._above = 0
        self._sample = Reservoir()
        self._run = 0
        self._in_run = Moments()

    def add(self, value: float | None, *, run: int) -> None:
        """Add one more outcome of a run; run numbers never decrease."""
        if value is None or not isfinite(value):
            self._missing += 1
            return
        if run != self._run:
            self._runs, self._above = self._with_last()
            self._in_run, self._run = Moments(), run
        self._in_run.add(0.0, value)
        self._outcomes.add(0.0, value)
        self._sample.add(value)

    def statistics(self) -> DeviationStatistics:
        """Statistics of the deviations added so far."""
        runs, above = self._with_last()
        scatter = runs.deviation
        return DeviationStatistics(
            count=self._outcomes.count,
            missing=self._missing,
            mean=self._outcomes.mean if self._outcomes.count else None,
            deviation=self._outcomes.deviation,
            standard_error=None if scatter is None else scatter / sqrt(runs.count),
            median=self._sample.quantile(0.5),
            high=self._sample.quantile(HIGH),
            runs=runs.count,
            runs_above=above,
            trend=runs.trend,
        )

    def _with_last(self) -> tuple[Moments, int]:
        """Means of runs, and how many lie above the plan, as if the last run were complete."""
        if not self._in_run.count:
            return self._runs, self._above
        runs = copy(self._runs)
        runs.add(self._run, self._in_run.mean)
        return runs, self._above + (self._in_run.mean > 0.0)


def quantity_of(outcome: ProcessOutcome, which: Evaluated) -> EvaluatedQuantity:
    """Return one of the four evaluated quantities of an outcome."""
    quantities = {
        Evaluated.ROUGHNESS: outcome.roughness,
        Evaluated.TIME: outcome.time,
        Evaluated.FORCE: outcome.force,
        Evaluated.FEED: outcome.feed,
    }
    return quantities[which]
