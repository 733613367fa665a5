"""Factor on k_c that a correction stands for, at any quantile.

It is separate from the learning of corrections, so that a plan can use one without loading it.
"""

from dataclasses import dataclass
from math import exp

from kbe.statistics import StudentT
from stepnc_model.outcome import LearnedCorrection

SAFE = 0.9
"""Default quantile for plans: one run in ten needs more force."""
COVERAGE = 0.9
"""Probability of the displayed interval."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorInterval:
    """Interval of the next run's factor with probability 0.9, and its centre."""

    low: float
    centre: float
    high: float


def factor_at(correction: LearnedCorrection, *, quantile: float = SAFE) -> float:
    """Factor on k_c that the next run exceeds with probability 1 − quantile.

    ``exp(centre + scale·t_q)``; the centre at 0.5. Plans that keep a force bound use a higher
    quantile.
    """
    return exp(distribution(correction).quantile(quantile))


def interval(correction: LearnedCorrection) -> FactorInterval:
    """Centre of the factor, with its symmetric probability interval."""
    return FactorInterval(
        low=factor_at(correction, quantile=0.5 - 0.5 * COVERAGE),
        centre=factor_at(correction, quantile=0.5),
        high=factor_at(correction, quantile=0.5 + 0.5 * COVERAGE),
    )


def distribution(correction: LearnedCorrection) -> StudentT:
    """Predictive distribution of ln factor for the next run."""
    return StudentT(
        centre=correction.log_centre, scale=correction.log_scale, degrees=correction.degrees
    )
