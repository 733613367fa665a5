"""Estimate of cutting load and feed exponent, updated once a revolution.

``ln F = c + p·ln v`` with v the override that the axes ran: recursive least squares with a
forgetting factor for each of the two [1]_. The load c changes all the time and is forgotten
within a few revolutions; the exponent p belongs to the material, and is hardly forgotten. An
innovation that noise does not explain means another depth of cut: the load's variance is reset
[2]_, and one revolution is enough to learn it. Nothing is learned of p, nor forgotten, while
the axes hardly change their speed (no excitation). Both variances are bounded.

References
----------
.. [1] A. Vahidi, A. Stefanopoulou, H. Peng, "Recursive least squares with forgetting for online
   estimation of vehicle mass and road grade", Vehicle System Dynamics 43 (2005), 31-55.
.. [2] G. C. Goodwin, K. S. Sin, "Adaptive Filtering, Prediction and Control", 1984, chapter 3:
   least squares with covariance resetting.
"""

from dataclasses import dataclass, replace
from math import sqrt

LOAD_FORGETTING = 0.7
EXPONENT_FORGETTING = 0.99
LOAD_VARIANCE = 1.0
"""Greatest variance of ln F: the load may be off by a factor of e."""
EXPONENT_VARIANCE = 0.1**2
"""Greatest variance of p: the spread between materials."""
TINY = 1e-12
"""Least variance used in place of zero."""
SURPRISE = 4.0
"""Innovation, in standard deviations, above which it is more than noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadEstimate:
    """Estimate of the load and the exponent, with its covariance."""

    log: float
    """Logarithm c of the force at override 1, ln N."""
    exponent: float
    """Exponent p of force over feed."""
    variance: float
    """Variance of the load logarithm c."""
    exponent_variance: float
    covariance: float


def first_load(force: float, *, way: float, exponent: float, noise: float) -> LoadEstimate:
    """Initial load estimate from one force, with an assumed exponent.

    Parameters
    ----------
    force : float
        Logarithm of the force, ln N.
    way : float
        Logarithm of the override that the axes ran, ln v.
    exponent : float
        Exponent p of force over feed.
    noise : float
        Standard deviation of ``force``.
    """
    return LoadEstimate(
        log=force - exponent * way,
        exponent=exponent,
        variance=noise**2 + EXPONENT_VARIANCE * way**2,
        exponent_variance=EXPONENT_VARIANCE,
        covariance=-EXPONENT_VARIANCE * way,
    )


def learned(load: LoadEstimate, *, force: float, way: float, noise: float) -> LoadEstimate:
    """Update load and exponent after a revolution in which the axes changed their speed."""
    prior = _forgotten(load, of_load=LOAD_FORGETTING, of_exponent=EXPONENT_FORGETTING)
    return _corrected(prior, force=force, way=way, noise=noise, share=1.0)


def learned_load(load: LoadEstimate, *, force: float, way: float, noise: float) -> LoadEstimate:
    """Update the load after a revolution at nearly the same speed; the exponent stays."""
    prior = _forgotten(load, of_load=LOAD_FORGETTING, of_exponent=1.0)
    return _corrected(prior, force=force, way=way, noise=noise, share=0.0)


def _forgotten(load: LoadEstimate, *, of_load: float, of_exponent: float) -> LoadEstimate:
    """Widen the covariance by the forgetting factors, [1]_; it stays positive definite."""
    wider = min(1.0 / of_load, LOAD_VARIANCE / max(load.variance, TINY))
    other = min(1.0 / of_exponent, EXPONENT_VARIANCE / max(load.exponent_variance, TINY))
    return replace(
        load,
        variance=wider * load.variance,
        exponent_variance=other * load.exponent_variance,
        covariance=sqrt(wider * other) * load.covariance,
    )


def _corrected(
    prior: LoadEstimate, *, force: float, way: float, noise: float, share: float
) -> LoadEstimate:
    """Perform one least-squares step, with a given share of the gain of the exponent."""
    innovation = force - prior.log - prior.exponent * way
    surprising = abs(innovation) > SURPRISE * sqrt(_spread(prior, way) + noise**2)
    if surprising:
        prior = replace(prior, variance=LOAD_VARIANCE, covariance=0.0)
    spread = _spread(prior, way) + noise**2
    gain = (prior.variance + way * prior.covariance) / spread
    other = share * (prior.covariance + way * prior.exponent_variance) / spread
    # Joseph's form, (I − kφ')P(I − kφ')' + k·k'·noise², stays positive with any gain.
    a, b, c, d = 1.0 - gain, -gain * way, -other, 1.0 - other * way
    p, q, r = prior.variance, prior.covariance, prior.exponent_variance
    return LoadEstimate(
        log=prior.log + gain * innovation,
        exponent=prior.exponent + other * innovation,
        variance=a * a * p + 2.0 * a * b * q + b * b * r + (gain * noise) ** 2,
        exponent_variance=c * c * p + 2.0 * c * d * q + d * d * r + (other * noise) ** 2,
        covariance=a * c * p + (a * d + b * c) * q + b * d * r + gain * other * noise**2,
    )


def _spread(load: LoadEstimate, way: float) -> float:
    """Variance of the predicted ln F, before measurement noise."""
    known = load.variance + 2.0 * way * load.covariance + way**2 * load.exponent_variance
    # Rounding may make it slightly negative.
    return max(known, 0.0)
