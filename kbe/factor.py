"""The factor on k_c that a correction stands for, at any degree of caution.

Apart from what learns corrections, so that a plan can take one without loading that.
"""

from dataclasses import dataclass
from math import exp

from kbe.student import StudentT
from stepnc_model.outcome import LearnedCorrection

SAFE = 0.9
"""quantile that a plan takes: one run in ten needs more force"""
COVERAGE = 0.9
"""probability of the interval that is shown"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorInterval:
    """Interval of the next run's factor with probability 0.9, and its centre."""

    low: float
    centre: float
    high: float


def factor_at(correction: LearnedCorrection, *, quantile: float = SAFE) -> float:
    """Factor on k_c that the next run exceeds with probability 1 − quantile.

    ``exp(centre + scale·t_q)``; at 0.5 the centre. A plan that keeps a force bound takes more.
    """
    return exp(distribution(correction).quantile(quantile))


def interval(correction: LearnedCorrection) -> FactorInterval:
    """Centre, and the interval with as much probability below as above."""
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
