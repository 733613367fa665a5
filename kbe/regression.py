"""Bayesian linear regression with a conjugate prior.

``y = x·β + ε`` with ``ε ~ N(0, σ²/w)``; β and σ² are both unknown and follow a
normal-inverse-gamma distribution, before and after. A power law is linear in logarithms: a
factor is the coefficient of a column of ones, an exponent that of the logarithm of its base.
Problems are small: all matrices are (P, P) and dense.

Beliefs also fade: :func:`forgotten` is the geometric mean of posterior and prior, which is of
the same family and never less certain than the prior.

References
----------
.. [1] A. Gelman et al., "Bayesian Data Analysis", 3rd ed., 2013, §3.3 (one mean), ch. 14.
.. [2] K. P. Murphy, "Machine Learning: A Probabilistic Perspective", 2012, §7.6.3:
   eqs. (7.69) to (7.73) the posterior, (7.76) the prediction.
.. [3] R. Kulhavý, M. B. Zarrop, "On a general concept of forgetting", Int. J. Control 58
   (1993), 905-924: fading towards an alternative rather than towards nothing.
.. [4] J. G. Ibrahim, M.-H. Chen, "Power prior distributions for regression models",
   Statistical Science 15 (2000), 46-60: a likelihood to a power between 0 and 1.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from kbe.student import StudentT

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NormalInverseGamma:
    """Normal-inverse-gamma distribution of coefficients β and variance σ², [2]_.

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
    """Power of the likelihood of each observation, (N,), [4]_.

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
    """Posterior distribution after observations, [2]_ eqs. (7.70) to (7.73).

    The rate uses residuals, where [2]_ subtracts squares of nearly equal numbers.
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

    Proportional to ``belief^share · prior^(1 − share)``, [3]_. With the same prior this is the
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
    """Distribution of ``x·β`` for a (P,) row x: the mean of many observations, [2]_ §7.6.3."""
    return _student(belief, row, own=0.0)


def predicted(belief: NormalInverseGamma, row: Floats, *, weight: float = 1.0) -> StudentT:
    """Predictive distribution of the next observation at a (P,) row x, [2]_ eq. (7.76)."""
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
