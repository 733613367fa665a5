"""Linear regression with a conjugate prior: what was believed, what was seen, what is believed.

``y = x·β + ε`` with ``ε ~ N(0, σ²/w)``; β and σ² are both unknown and follow a
normal-inverse-gamma law, before and after. A power law is linear in logarithms: a factor is the
coefficient of a column of ones, an exponent that of the logarithm of its base. Small problems:
all matrices are (P, P) and dense.

Beliefs also fade: :func:`forgotten` is the geometric mean of posterior and prior, which is of
the same family and never less sure than the prior.

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
    """``β | σ² ~ N(mean, σ² precision⁻¹)`` and ``σ² ~ inverse gamma(shape, rate)``, [2]_."""

    mean: Floats
    """Mean, (P,)"""
    precision: Floats
    """Precision, (P, P), in units of 1/σ²; symmetric, positive definite"""
    shape: float
    """half the degrees of freedom, above 0"""
    rate: float
    """above 0"""

    def __post_init__(self) -> None:
        """Refuse what is no distribution."""
        size = len(self.mean)
        if self.mean.shape != (size,) or self.precision.shape != (size, size):
            raise ValueError(f"mean {self.mean.shape}, precision {self.precision.shape}")
        if not (self.shape > 0.0 and self.rate > 0.0):
            raise ValueError(f"shape {self.shape} and rate {self.rate} must be above 0")

    @property
    def scatter(self) -> float:
        """Standard deviation σ that the predictions use, ``√(rate / shape)``."""
        return sqrt(self.rate / self.shape)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observations:
    """Observations of a linear model."""

    design: Floats
    """Design, (N, P): x of each"""
    values: Floats
    """Values, (N,): y of each"""
    weights: Floats
    """Weights, (N,): w, σ² over the variance of each; above 0"""
    counts: Floats
    """(N,): power of its likelihood, [4]_. 1: one of its own; 1/n: n that err together are
    worth one"""

    def __post_init__(self) -> None:
        """Check shapes, finiteness and signs."""
        rows = (len(self.values),)
        if self.design.ndim != 2 or len(self.design) != rows[0]:
            raise ValueError(f"design {self.design.shape} for {rows[0]} values")
        if self.weights.shape != rows or self.counts.shape != rows:
            raise ValueError("each value needs one weight and one count")
        if not all(np.isfinite(each).all() for each in (self.design, self.values)):
            raise ValueError("observations must be finite")
        if not ((self.weights > 0.0).all() and (self.counts >= 0.0).all()):
            raise ValueError("weights must be above 0, counts not below")


def updated(belief: NormalInverseGamma, seen: Observations) -> NormalInverseGamma:
    """Posterior after observations, [2]_ eqs. (7.70) to (7.73).

    The rate is written with residuals, where [2]_ subtracts squares of near numbers.
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
    """Prior when only a share of what was learned still counts.

    Proportional to ``belief^share · prior^(1 − share)``, [3]_. With the same prior this is the
    belief from the same observations with all their counts times ``share``.

    Parameters
    ----------
    belief : NormalInverseGamma
        Learned from the prior.
    prior : NormalInverseGamma
        What to return to.
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
    """Distribution of the next observation at a (P,) row x, [2]_ eq. (7.76)."""
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
