"""Statistics of the deviations from the plan, for the four quantities that [1]_ evaluates.

A deviation is measured over predicted, less one. Outcomes are streamed in the order of time;
count, mean, scatter, standard error and trend need moments only, the median and the 95th
percentile a sample of bounded size (:mod:`kbe.reservoir`).

Workingsteps of one run have correlated errors, so the standard error and the trend are those of
the means of runs; mean, scatter, median and 95th percentile are of all outcomes.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Knowledge-based evaluation": cutting forces, feed-rate, machining
   time and surface quality.
"""

from copy import copy
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite, sqrt

from kbe.moments import Moments, Trend
from kbe.reservoir import Reservoir
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome

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
