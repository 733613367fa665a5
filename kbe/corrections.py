"""Corrections of the specific cutting force, learned from the forces that machines reported.

Each outcome tells ``ln(measured / expected)`` against the catalogue's k_c, whatever correction
its plan used. So corrections do not compound: one replaces the other, and when the material
stays the same, outcomes after an acceptance say what those before it said.

The model, for each context: ``y = ln factor + run + reading``. What changes from run to run
(edge, batch, clamping) has an unknown scatter σ; ln factor and σ follow the conjugate law of
:mod:`kbe.regression`.

- *Readings.* Revolutions of one cut err alike. They are taken as a first-order autoregression
  and n of them are worth ``n·(1 − ρ)/(1 + ρ)``, [1]_, not less than 1. The mean then has an own
  variance s², and its weight is ``σ² / (σ² + s²)``, with the σ believed before the run.
- *Workingsteps.* Those of one run share edge and batch, so n of them count 1/n each: a run is
  worth one observation, however many workingsteps it has, and what differs between them widens
  the scatter, because the next plan needs a factor that holds for each.
- *Forgetting.* Between runs, what was learned fades towards the prior by a half-life.

References
----------
.. [1] G. V. Bayley, J. M. Hammersley, "The 'effective' number of independent observations in
   an autocorrelated time series", Suppl. J. Royal Stat. Soc. 8 (1946), 184-197.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from math import inf, isfinite, log

import numpy as np

from kbe.regression import (
    NormalInverseGamma,
    Observations,
    expected,
    forgotten,
    predicted,
    updated,
)
from kbe.student import StudentT
from stepnc_model.outcome import Context, ForceRatio, LearnedCorrection, ProcessOutcome

NEAR = 0.1
"""of the factor: a correction's confidence is that the factor lies no farther off"""
SECONDS_PER_DAY = 86_400.0

ONE = np.ones(1)
"""row of the design: a factor is a constant in logarithms"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorPrior:
    """Prior belief about a factor before the first run."""

    deviation: float = 0.2
    """of ln factor about 0: catalogue forces are ±20 % until calibrated (README)"""
    scatter: float = 0.05
    """of ln factor from run to run; a guess, hence few degrees"""
    degrees: float = 4.0
    """of freedom: how many runs the guess of the scatter is worth"""

    def belief(self) -> NormalInverseGamma:
        """The same as a law of (ln factor, σ²)."""
        return NormalInverseGamma(
            mean=np.zeros(1),
            precision=np.full((1, 1), (self.scatter / self.deviation) ** 2),
            shape=0.5 * self.degrees,
            rate=0.5 * self.degrees * self.scatter**2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Forgetting:
    """After how much half of what was learned is forgotten; ``inf``: never."""

    runs: float = 10.0
    days: float = 180.0

    def share(self, *, runs: float, days: float) -> float:
        """Share of knowledge kept after some runs and days; time never runs back."""
        return float(0.5 ** (runs / self.runs + max(days, 0.0) / self.days))


NEVER = Forgetting(runs=inf, days=inf)


@dataclass(frozen=True, slots=True, kw_only=True)
class Admission:
    """Admission of outcomes to learning, and the weight of their readings."""

    fewest_readings: int = 20
    wildest: float = 5.0
    """factor from which, up or down, a ratio is a mistake: wrong tool, wrong units"""
    correlation: float = 0.9
    """ρ of neighbouring revolutions; a guess on the safe side"""


class ExclusionReason(StrEnum):
    """Why an outcome was left out."""

    NO_RATIO = "no force ratio"
    NOT_FINITE = "force ratio is no number"
    FEW_READINGS = "too few readings"
    WILD = "wild force ratio"


@dataclass(frozen=True, slots=True, kw_only=True)
class Learning:
    """Settings of the learning."""

    prior: FactorPrior = field(default_factory=FactorPrior)
    forgetting: Forgetting = field(default_factory=Forgetting)
    admission: Admission = field(default_factory=Admission)


@dataclass(frozen=True, slots=True, kw_only=True)
class LearningReport:
    """Data that a correction rests on."""

    runs: int
    used: int
    """outcomes"""
    left_out: Mapping[ExclusionReason, int]
    effective_runs: float
    """what the runs are worth after forgetting"""
    scatter: float
    """of ln factor from run to run"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedFactor:
    """Result of the learning for one context."""

    context: Context
    correction: LearnedCorrection | None
    """a proposal; None: no outcome could be used"""
    mean: StudentT
    """of ln factor, over many runs; narrower than the correction, which is for one run"""
    report: LearningReport


def learned(
    outcomes: Iterable[ProcessOutcome], *, at: datetime, learning: Learning | None = None
) -> tuple[LearnedFactor, ...]:
    """Corrections that outcomes propose, one for each context, in the order of their names.

    Parameters
    ----------
    outcomes : iterable of ProcessOutcome
        In any order; those of one run have its id.
    at : datetime
        Now, with zone: knowledge has faded since the last run.
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
    """Why nothing is learned from a ratio; None: it is used."""
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
    """Variance s² of a ratio's mean, of correlated readings, [1]_."""
    rho = admission.correlation
    independent = max(1.0, ratio.readings * (1.0 - rho) / (1.0 + rho))
    return ratio.log_deviation**2 / independent


def _learned(
    outcomes: Sequence[ProcessOutcome], *, at: datetime, learning: Learning
) -> LearnedFactor:
    """Learn a factor from the outcomes of one context."""
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
    """Order of outcomes; ids settle ties."""
    return outcome.recorded_at, outcome.run, outcome.workingstep


def _belief(
    runs: Sequence[Sequence[ForceRatio]], *, times: Sequence[datetime], learning: Learning
) -> NormalInverseGamma:
    """Run after run; ``times`` has the beginning of each, and now."""
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
    """The workingsteps of one run, together worth one observation."""
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
    """The proposal: the next run's true factor, hence without the error of readings."""
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
