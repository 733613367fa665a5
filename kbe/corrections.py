"""Learning of corrections of the specific cutting force from measured forces.

Each outcome gives ``ln(measured / expected)`` relative to the catalogue's k_c, whatever
correction its plan used. So corrections do not compound: one replaces the other, and while the
material stays the same, outcomes after an acceptance agree with those before it.

The model, for each context: ``y = ln factor + run + reading``. What changes from run to run
(edge, batch, clamping) has an unknown scatter σ; ln factor and σ follow the conjugate law of
the regression.

- *Readings.* Revolutions of one cut have correlated errors. They are modelled as a first-order
  autoregression, so n of them are worth ``n·(1 − ρ)/(1 + ρ)``, [1]_, not less than 1. The mean
  then has its own variance s², and its weight is ``σ² / (σ² + s²)``, with the σ estimated
  before the run.
- *Workingsteps.* Those of one run share edge and batch, so n of them count 1/n each: a run is
  worth one observation, however many workingsteps it has, and differences between them widen
  the scatter, because the next plan needs a factor that holds for each.
- *Forgetting.* Between runs, what was learned fades towards the prior with a half-life.

Bayesian linear regression with a conjugate prior.

``y = x·β + ε`` with ``ε ~ N(0, σ²/w)``; β and σ² are both unknown and follow a
normal-inverse-gamma distribution, before and after. A power law is linear in logarithms: a
factor is the coefficient of a column of ones, an exponent that of the logarithm of its base.
Problems are small: all matrices are (P, P) and dense.

Beliefs also fade: :func:`forgotten` is the geometric mean of posterior and prior, which is of
the same family and never less certain than the prior.

References
----------
.. [1] G. V. Bayley, J. M. Hammersley, "The 'effective' number of independent observations in
   an autocorrelated time series", Suppl. J. Royal Stat. Soc. 8 (1946), 184-197.
.. [2] A. Gelman et al., "Bayesian Data Analysis", 3rd ed., 2013, §3.3 (one mean), ch. 14.
.. [3] K. P. Murphy, "Machine Learning: A Probabilistic Perspective", 2012, §7.6.3:
   eqs. (7.69) to (7.73) the posterior, (7.76) the prediction.
.. [4] R. Kulhavý, M. B. Zarrop, "On a general concept of forgetting", Int. J. Control 58
   (1993), 905-924: fading towards an alternative rather than towards nothing.
.. [5] J. G. Ibrahim, M.-H. Chen, "Power prior distributions for regression models",
   Statistical Science 15 (2000), 46-60: a likelihood to a power between 0 and 1.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from math import inf, isfinite, log, sqrt

import numpy as np
from numpy.typing import NDArray

from kbe.statistics import StudentT
from stepnc_model.outcome import Context, ForceRatio, LearnedCorrection, ProcessOutcome
from stepnc_model.units import SECONDS_PER_DAY

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NormalInverseGamma:
    """Normal-inverse-gamma distribution of coefficients β and variance σ², [3]_.

    ``β | σ² ~ N(mean, σ² precision⁻¹)`` and ``σ² ~ inverse gamma(shape, rate)``.
    """

    mean: Floats
    """Mean of the coefficients, (P,)."""
    precision: Floats
    """Precision, (P, P), in units of 1/σ²; symmetric, positive definite."""
    shape: float
    """Shape: half the degrees of freedom, above 0."""
    rate: float
    """Rate of the inverse gamma distribution, above 0."""

    def __post_init__(self) -> None:
        """Check shapes and signs of the parameters."""
        size = len(self.mean)
        if self.mean.shape != (size,) or self.precision.shape != (size, size):
            raise ValueError(
                f"shapes do not match: mean {self.mean.shape}, precision {self.precision.shape}"
            )
        if not (self.shape > 0.0 and self.rate > 0.0):
            raise ValueError(f"shape {self.shape} and rate {self.rate} must be above 0")

    @property
    def scatter(self) -> float:
        """Standard deviation σ used by the predictions, ``√(rate / shape)``."""
        return sqrt(self.rate / self.shape)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observations:
    """Observations of a linear model, with weights and counts."""

    design: Floats
    """Design matrix, (N, P): the x of each observation."""
    values: Floats
    """Observed values y, (N,)."""
    weights: Floats
    """Weights w, (N,): σ² over the variance of each observation, above 0."""
    counts: Floats
    """Power of the likelihood of each observation, (N,), [5]_.

    1: independent; 1/n: n observations with a common error are worth one.
    """

    def __post_init__(self) -> None:
        """Check shapes, finiteness and signs."""
        rows = (len(self.values),)
        if self.design.ndim != 2 or len(self.design) != rows[0]:
            raise ValueError(f"design {self.design.shape} does not match {rows[0]} values")
        if self.weights.shape != rows or self.counts.shape != rows:
            raise ValueError("each value needs one weight and one count")
        if not all(np.isfinite(each).all() for each in (self.design, self.values)):
            raise ValueError("observations must be finite")
        if not ((self.weights > 0.0).all() and (self.counts >= 0.0).all()):
            raise ValueError("weights must be above 0, counts at least 0")


def updated(belief: NormalInverseGamma, seen: Observations) -> NormalInverseGamma:
    """Posterior distribution after observations, [3]_ eqs. (7.70) to (7.73).

    The rate uses residuals, where [3]_ subtracts squares of nearly equal numbers.
    """
    weights = seen.counts * seen.weights
    precision = belief.precision + seen.design.T @ (weights[:, None] * seen.design)
    moment = belief.precision @ belief.mean + seen.design.T @ (weights * seen.values)
    mean: Floats = np.linalg.solve(precision, moment).astype(np.float64)
    residual = seen.values - seen.design @ mean
    misfit = weights @ residual**2 + _distance(mean, belief)
    return NormalInverseGamma(
        mean=mean,
        precision=precision,
        shape=belief.shape + 0.5 * float(seen.counts.sum()),
        rate=belief.rate + 0.5 * float(misfit),
    )


def forgotten(
    belief: NormalInverseGamma, prior: NormalInverseGamma, *, share: float
) -> NormalInverseGamma:
    """Belief after forgetting: only a share of what was learned still counts.

    Proportional to ``belief^share · prior^(1 − share)``, [4]_. With the same prior this is the
    belief from the same observations with all their counts times ``share``.

    Parameters
    ----------
    belief : NormalInverseGamma
        Learned from the prior.
    prior : NormalInverseGamma
        Distribution to return to.
    share : float
        1: all is kept; 0: the prior.
    """
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"share {share} is not between 0 and 1")
    faded = 1.0 - share
    precision = faded * prior.precision + share * belief.precision
    moment = faded * prior.precision @ prior.mean + share * belief.precision @ belief.mean
    mean: Floats = np.linalg.solve(precision, moment).astype(np.float64)
    between = faded * _distance(mean, prior) + share * _distance(mean, belief)
    return NormalInverseGamma(
        mean=mean,
        precision=precision,
        shape=faded * prior.shape + share * belief.shape,
        rate=faded * prior.rate + share * belief.rate + 0.5 * between,
    )


def expected(belief: NormalInverseGamma, row: Floats) -> StudentT:
    """Distribution of ``x·β`` for a (P,) row x: the mean of many observations, [3]_ §7.6.3."""
    return _student(belief, row, own=0.0)


def predicted(belief: NormalInverseGamma, row: Floats, *, weight: float = 1.0) -> StudentT:
    """Predictive distribution of the next observation at a (P,) row x, [3]_ eq. (7.76)."""
    return _student(belief, row, own=1.0 / weight)


def _distance(mean: Floats, belief: NormalInverseGamma) -> float:
    """Squared distance from a belief's mean, in units of σ²."""
    away = mean - belief.mean
    return float(away @ belief.precision @ away)


def _student(belief: NormalInverseGamma, row: Floats, *, own: float) -> StudentT:
    """Student's t at a row; ``own`` is the observation's variance in units of σ²."""
    spread = own + float(row @ np.linalg.solve(belief.precision, row))
    return StudentT(
        centre=float(row @ belief.mean),
        scale=belief.scatter * sqrt(spread),
        degrees=2.0 * belief.shape,
    )


NEAR = 0.1
"""Relative half-width of the interval whose probability is a correction's confidence."""

ONE = np.ones(1)
"""Row of the design matrix: a factor is a constant in logarithms."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorPrior:
    """Prior belief about the factor on k_c before the first run."""

    deviation: float = 0.2
    """Standard deviation of ln factor about 0: catalogue forces are ±20 % until calibrated."""
    scatter: float = 0.05
    """Standard deviation of ln factor from run to run; a guess, hence few degrees."""
    degrees: float = 4.0
    """Degrees of freedom: how many runs the guess of the scatter is worth."""

    def belief(self) -> NormalInverseGamma:
        """Prior as a distribution of (ln factor, σ²)."""
        return NormalInverseGamma(
            mean=np.zeros(1),
            precision=np.full((1, 1), (self.scatter / self.deviation) ** 2),
            shape=0.5 * self.degrees,
            rate=0.5 * self.degrees * self.scatter**2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Forgetting:
    """Half-lives of what was learned, in runs and in days; ``inf``: never forgotten."""

    runs: float = 10.0
    days: float = 180.0

    def share(self, *, runs: float, days: float) -> float:
        """Share of knowledge kept after some runs and days; negative times count as 0."""
        return float(0.5 ** (runs / self.runs + max(days, 0.0) / self.days))


NEVER = Forgetting(runs=inf, days=inf)


@dataclass(frozen=True, slots=True, kw_only=True)
class Admission:
    """Conditions for outcomes to be learned from, and the correlation of their readings."""

    fewest_readings: int = 20
    wildest: float = 5.0
    """Factor, up or down, from which a ratio is a mistake: wrong tool, wrong units."""
    correlation: float = 0.9
    """Correlation ρ of neighbouring revolutions; a guess on the safe side."""


class ExclusionReason(StrEnum):
    """Reason why an outcome is excluded from learning."""

    NO_RATIO = "no force ratio"
    NOT_FINITE = "force ratio is not a number"
    FEW_READINGS = "too few readings"
    WILD = "wild force ratio"


@dataclass(frozen=True, slots=True, kw_only=True)
class Learning:
    """Settings of the learning: prior, forgetting and admission."""

    prior: FactorPrior = field(default_factory=FactorPrior)
    forgetting: Forgetting = field(default_factory=Forgetting)
    admission: Admission = field(default_factory=Admission)


@dataclass(frozen=True, slots=True, kw_only=True)
class LearningReport:
    """Amount of data behind a correction, and what was excluded."""

    runs: int
    used: int
    """Number of outcomes used."""
    left_out: Mapping[ExclusionReason, int]
    effective_runs: float
    """Equivalent number of runs after forgetting."""
    scatter: float
    """Standard deviation of ln factor from run to run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedFactor:
    """Correction learned for one context, with its data."""

    context: Context
    correction: LearnedCorrection | None
    """Proposed correction; None if no outcome could be used."""
    mean: StudentT
    """Distribution of the mean ln factor over many runs, narrower than for a single run."""
    report: LearningReport


def learned(
    outcomes: Iterable[ProcessOutcome], *, at: datetime, learning: Learning | None = None
) -> tuple[LearnedFactor, ...]:
    """Learn one correction for each context from outcomes, ordered by context.

    Parameters
    ----------
    outcomes : iterable of ProcessOutcome
        In any order; outcomes of one run share its id.
    at : datetime
        Present time, with zone; knowledge fades since the last run.
    learning : Learning, optional
        Prior, forgetting and admission.
    """
    by_context: dict[Context, list[ProcessOutcome]] = defaultdict(list)
    for outcome in outcomes:
        by_context[outcome.context].append(outcome)
    ordered = sorted(by_context, key=lambda each: (each.machine, each.material, each.tool))
    how = learning or Learning()
    return tuple(_learned(by_context[each], at=at, learning=how) for each in ordered)


def refusal(ratio: ForceRatio | None, admission: Admission) -> ExclusionReason | None:
    """Reason why a ratio is not learned from; None if it is used."""
    if ratio is None:
        return ExclusionReason.NO_RATIO
    if not (isfinite(ratio.log_mean) and isfinite(ratio.log_deviation)):
        return ExclusionReason.NOT_FINITE
    if ratio.readings < admission.fewest_readings:
        return ExclusionReason.FEW_READINGS
    if abs(ratio.log_mean) > log(admission.wildest):
        return ExclusionReason.WILD
    return None


def own_variance(ratio: ForceRatio, admission: Admission) -> float:
    """Variance s² of the mean of correlated readings, [1]_."""
    rho = admission.correlation
    independent = max(1.0, ratio.readings * (1.0 - rho) / (1.0 + rho))
    return ratio.log_deviation**2 / independent


def _learned(
    outcomes: Sequence[ProcessOutcome], *, at: datetime, learning: Learning
) -> LearnedFactor:
    """Learn a correction from the outcomes of one context."""
    left_out: Counter[ExclusionReason] = Counter()
    runs: dict[str, list[ForceRatio]] = defaultdict(list)
    began: dict[str, datetime] = {}
    for outcome in sorted(outcomes, key=_in_time):
        reason = refusal(outcome.force_ratio, learning.admission)
        if reason is not None or outcome.force_ratio is None:
            left_out[reason or ExclusionReason.NO_RATIO] += 1
            continue
        runs[outcome.run].append(outcome.force_ratio)
        began.setdefault(outcome.run, outcome.recorded_at)
    belief = _belief(list(runs.values()), times=[*began.values(), at], learning=learning)
    used = sum(map(len, runs.values()))
    context = outcomes[0].context
    return LearnedFactor(
        context=context,
        correction=_correction(belief, context, outcomes=used, at=at) if used else None,
        mean=expected(belief, ONE),
        report=LearningReport(
            runs=len(runs),
            used=used,
            left_out={each: left_out[each] for each in ExclusionReason if left_out[each]},
            effective_runs=2.0 * belief.shape - learning.prior.degrees,
            scatter=belief.scatter,
        ),
    )


def _in_time(outcome: ProcessOutcome) -> tuple[datetime, str, str]:
    """Sort key of outcomes: time, with ids for ties."""
    return outcome.recorded_at, outcome.run, outcome.workingstep


def _belief(
    runs: Sequence[Sequence[ForceRatio]], *, times: Sequence[datetime], learning: Learning
) -> NormalInverseGamma:
    """Update the belief run by run; ``times`` has the beginning of each, and now."""
    prior = belief = learning.prior.belief()
    for index, run in enumerate(runs):
        belief = updated(belief, _observations(run, belief.scatter, learning.admission))
        days = (times[index + 1] - times[index]).total_seconds() / SECONDS_PER_DAY
        passed = 1.0 if index + 1 < len(runs) else 0.0
        share = learning.forgetting.share(runs=passed, days=days)
        belief = forgotten(belief, prior, share=share)
    return belief


def _observations(
    run: Sequence[ForceRatio], scatter: float, admission: Admission
) -> Observations:
    """Observations of the workingsteps of one run, together worth one."""
    own = np.array([own_variance(each, admission) for each in run])
    return Observations(
        design=np.ones((len(run), 1)),
        values=np.array([each.log_mean for each in run]),
        weights=scatter**2 / (scatter**2 + own),
        counts=np.full(len(run), 1.0 / len(run)),
    )


def _correction(
    belief: NormalInverseGamma, context: Context, *, outcomes: int, at: datetime
) -> LearnedCorrection:
    """Proposed correction: the next run's true factor, without reading error."""
    coming = predicted(belief, ONE)
    low, high = coming.centre + log(1.0 - NEAR), coming.centre + log(1.0 + NEAR)
    return LearnedCorrection(
        context=context,
        log_centre=coming.centre,
        log_scale=coming.scale,
        degrees=coming.degrees,
        outcomes=outcomes,
        confidence=coming.between(low, high),
        proposed_at=at,
    )
