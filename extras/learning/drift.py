"""Drift of measured runs from a model: an alarm with a stated rate of false ones, and evidence.

The residual of a run is measured over predicted less 1. In the order of the runs, two sums
gather the standardised residuals above and below what the test of the model left, each less an
allowance, [1]_; the greatest of them is the statistic. Its bound is found by drawing as many
runs, and a test as large, from the residuals of that test: so many draws exceed it as there may
be false alarms, however many runs there are, and without a normal distribution.

What the residuals go with is found by their correlation with each setting and with the order
of the runs. A permutation of the runs breaks it; the greatest correlation of all settings in
each permutation says how great one is by chance, [2]_.

References
----------
.. [1] E. S. Page, "Continuous Inspection Schemes", Biometrika 41 (1954), pp. 100-115.
.. [2] P. H. Westfall, S. S. Young, "Resampling-Based Multiple Testing", Wiley 1993, ch. 2.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from extras.learning.scores import AT_ONCE, Score, mean_score
from extras.learning.table import Floats

ALLOWANCE = 0.5
"""k of the sums: half the shift, in standard deviations, that they find soonest."""

LEAST_SPREAD = 1e-6
"""Least standard deviation of residuals: models of exact data have none."""

PERMUTATIONS = 2_000
CHANCE = 0.05
"""Probability below which a correlation counts."""

LEAST_DRAWS = 2_000
DRAWS_BEYOND = 20
"""Draws that exceed the bound, on average, at least."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Association:
    """A setting that the residuals go with."""

    name: str
    correlation: float
    change: float
    """Change of the residual from the least to the greatest value, by a straight line."""
    chance: float
    """Probability of so great a correlation among all settings by chance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drift:
    """Diagnosis of the residuals of runs."""

    statistic: float
    """Greatest sum, in standard deviations of the test."""
    bound: float
    false_alarm: float
    """Probability of exceeding the bound where nothing has changed."""
    expected: float
    """Mean residual of the test."""
    spread: float
    """Standard deviation of the residuals of the test."""
    alarm: int | None
    """Place of the run, from 0, at which the bound was exceeded; None: it was not."""
    since: int
    """Place of the first run of the greatest sum: where the drift may have begun."""
    before: Score | None
    """Mean residual before; None: there are no runs before."""
    after: Score
    """Mean residual from there to the greatest sum."""
    associations: tuple[Association, ...]
    """Settings that the residuals go with, the strongest first."""


def drift_of(
    residuals: Floats,
    reference: Sequence[float],
    settings: Mapping[str, Floats],
    *,
    false_alarm: float,
    seed: int,
) -> Drift:
    """Diagnose the residuals of runs.

    Parameters
    ----------
    residuals : (N,) array
        In the order of the runs.
    reference : sequence of float
        Residuals of the test of the model.
    settings : mapping
        What they may go with, (N,) each.
    false_alarm : float
    seed : int
    """
    rng, known = np.random.default_rng(seed), np.asarray(reference)
    expected, spread = float(known.mean()), max(float(known.std(ddof=1)), LEAST_SPREAD)
    sums = _sums((residuals - expected) / spread)
    peak, side = np.unravel_index(int(sums.argmax()), sums.shape)
    bound = _bound(known, len(residuals), false_alarm, rng)
    beyond = np.flatnonzero((sums > bound).any(axis=1))
    at_zero = np.flatnonzero(sums[: peak + 1, side] <= 0.0)
    since = int(at_zero[-1]) + 1 if len(at_zero) and at_zero[-1] < peak else 0
    return Drift(
        statistic=float(sums.max()),
        bound=bound,
        false_alarm=false_alarm,
        expected=expected,
        spread=spread,
        alarm=int(beyond[0]) if len(beyond) else None,
        since=since,
        before=mean_score(residuals[:since], rng) if since else None,
        after=mean_score(residuals[since : int(peak) + 1], rng),
        associations=_associations(residuals, settings, rng),
    )


def _sums(standardised: Floats) -> Floats:
    """Sums above and below after each run, (N, 2)."""
    found = np.zeros((len(standardised), 2))
    sums = np.zeros(2)
    for row, value in enumerate(standardised.tolist()):
        sums = np.maximum(0.0, sums + np.array([value, -value]) - ALLOWANCE)
        found[row] = sums
    return found


def _bound(known: Floats, count: int, false_alarm: float, rng: np.random.Generator) -> float:
    """Bound of the statistic of a number of runs."""
    draws = max(LEAST_DRAWS, ceil(DRAWS_BEYOND / false_alarm))
    expected, spread = np.zeros((2, draws))
    for part in _parts(draws, len(known)):
        tests = known[rng.integers(0, len(known), (part.stop - part.start, len(known)))]
        expected[part] = tests.mean(axis=1)
        spread[part] = np.maximum(tests.std(axis=1, ddof=1), LEAST_SPREAD)
    above, below, greatest = np.zeros((3, draws))
    for _ in range(count):
        drawn = (known[rng.integers(0, len(known), draws)] - expected) / spread
        above = np.maximum(0.0, above + drawn - ALLOWANCE)
        below = np.maximum(0.0, below - drawn - ALLOWANCE)
        greatest = np.maximum(greatest, np.maximum(above, below))
    return float(np.quantile(greatest, 1.0 - false_alarm))


def _associations(
    residuals: Floats, settings: Mapping[str, Floats], rng: np.random.Generator
) -> tuple[Association, ...]:
    """Settings whose correlation with the residuals is hardly by chance."""
    varying = {name: each for name, each in settings.items() if np.ptp(each) > 0.0}
    if not varying or len(residuals) < 3 or not np.ptp(residuals) > 0.0:
        return ()
    columns = np.stack([(each - each.mean()) / each.std() for each in varying.values()], axis=1)
    about = (residuals - residuals.mean()) / residuals.std()
    found = about @ columns / len(about)
    chance = np.zeros(PERMUTATIONS)
    for part in _parts(PERMUTATIONS, len(about)):
        orders = rng.permuted(np.tile(about, (part.stop - part.start, 1)), axis=1)
        chance[part] = np.abs(orders @ columns).max(axis=1) / len(about)
    return tuple(
        Association(
            name=name,
            correlation=float(correlation),
            change=float(correlation * residuals.std() * np.ptp(each) / each.std()),
            chance=by_chance,
        )
        for correlation, (name, each) in sorted(
            zip(found.tolist(), varying.items(), strict=True), key=lambda each: -abs(each[0])
        )
        if (by_chance := _tail(chance, abs(correlation))) <= CHANCE
    )


def _parts(draws: int, size: int) -> Iterator[slice]:
    """Parts of some draws of a size, so small that they are in memory at once."""
    step = max(1, AT_ONCE // size)
    return (slice(first, min(first + step, draws)) for first in range(0, draws, step))


def _tail(draws: Floats, value: float) -> float:
    """Probability of a value or more: never 0, as no number of draws shows that."""
    return float((1 + np.count_nonzero(draws >= value)) / (1 + len(draws)))
