"""Load and exponent of the cut, learned from force and feed once a revolution.

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
"""greatest, of ln F: the load may be off by a factor of e"""
EXPONENT_VARIANCE = 0.1**2
"""greatest, of p: between materials"""
TINY = 1e-12
"""variance, in place of none"""
SURPRISE = 4.0
"""standard deviations of an innovation that is more than noise"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadEstimate:
    """An estimate with its covariance."""

    log: float
    """c, ln N: force at override 1"""
    exponent: float
    """p"""
    variance: float
    """of c"""
    exponent_variance: float
    covariance: float


def first_load(force: float, *, way: float, exponent: float, noise: float) -> LoadEstimate:
    """Load from one force, with the exponent taken for granted.

    Parameters
    ----------
    force : float
        ln N.
    way : float
        ln v.
    exponent : float
        p.
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
    """Load and exponent after one more revolution in which the axes changed their speed."""
    prior = _forgotten(load, of_load=LOAD_FORGETTING, of_exponent=EXPONENT_FORGETTING)
    return _corrected(prior, force=force, way=way, noise=noise, share=1.0)


def learned_load(load: LoadEstimate, *, force: float, way: float, noise: float) -> LoadEstimate:
    """Load after one more revolution at nearly the same speed; the exponent stays."""
    prior = _forgotten(load, of_load=LOAD_FORGETTING, of_exponent=1.0)
    return _corrected(prior, force=force, way=way, noise=noise, share=0.0)


def _forgotten(load: LoadEstimate, *, of_load: float, of_exponent: float) -> LoadEstimate:
    """The estimate grown old, [1]_; scaled from both sides, its covariance stays positive."""
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
    """One step of least squares, with so much of the exponent's gain."""
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
    """Variance of the predicted ln F."""
    known = load.variance + 2.0 * way * load.covariance + way**2 * load.exponent_variance
    # Rounding may leave less than nothing.
    return max(known, 0.0)
