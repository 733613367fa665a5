"""Bayesian regression of the logarithm of a measured quantity, with few rows and wide priors.

``y = f(θ) + ε`` with ``θ ~ N(θ₀, S)`` and ε normal of an unknown σ, whose square has a scaled
inverse chi-square prior. For each σ of a grid θ is found by Gauss–Newton and its evidence by
Laplace's approximation (exact where f is linear); the posterior is their mixture, told by its
mean and covariance. Rows that lie far off are given less weight; rows of which only a lower
bound is known (an edge that stopped before it was worn out) count by the share of the normal
distribution above it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from simulator.motion.segments import Floats

Curve = Callable[[Floats], tuple[Floats, Floats]]
"""Values of all rows at θ, (N,), and their derivatives by θ, (N, P)."""

GRID = np.exp(np.linspace(np.log(0.2), np.log(8.0), 33))
"""Values of σ that are tried, over its prior value."""

FEWEST_WEIGHED = 6
"""Readings from which one may count less: among fewer, the majority may be chance."""

FAR = 3.0
"""Standardised residual from which a row counts less."""

STEPS = 40
ROUNDS = 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prior:
    """Prior of a model: normal parameters, and the standard deviation of one reading."""

    names: tuple[str, ...]
    mean: Floats
    sd: Floats
    sigma: float
    degrees: float
    """Degrees of freedom with which ``sigma`` is known."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Readings:
    """Measured logarithms, (N,)."""

    value: Floats
    is_bound: Floats
    """1 where only a lower bound was seen, else 0."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Posterior:
    """Normal approximation of what is known of θ and σ."""

    prior: Prior
    mean: Floats
    covariance: Floats
    sigma: float
    degrees: float
    weights: Floats
    """Weight of each reading, (N,); less than 1 for one that lies far off."""

    def interval(self, curve: Curve, extra: Floats, level: float) -> tuple[Floats, ...]:
        """Median and ends of the interval of one new reading of each row.

        Parameters
        ----------
        curve : callable
            Values and derivatives of the rows.
        extra : (N,) array
            Standard deviation that the rows' distance from the measured range adds.
        level : float
            Probability within the interval.
        """
        value, slope = curve(self.mean)
        spread = self.spread(slope, extra)
        reach = float(student.ppf(0.5 + 0.5 * level, self.degrees)) * spread
        return value, value - reach, value + reach

    def spread(self, slope: Floats, extra: Floats) -> Floats:
        """Standard deviation of one new reading of each row."""
        known = np.einsum("ij,jk,ik->i", slope, self.covariance, slope)
        found: Floats = np.sqrt(known + self.sigma**2 + extra**2)
        return found

    @property
    def learned(self) -> Floats:
        """Share of each parameter that the data determine: 1 − posterior/prior variance."""
        found: Floats = 1.0 - np.diag(self.covariance) / self.prior.sd**2
        return found


def unmeasured(prior: Prior) -> Posterior:
    """What the prior alone says."""
    return Posterior(
        prior=prior,
        mean=prior.mean,
        covariance=np.diag(prior.sd**2),
        sigma=prior.sigma,
        degrees=prior.degrees,
        weights=np.zeros(0),
    )


def learned(curve: Curve, readings: Readings, prior: Prior) -> Posterior:
    """Posterior of the parameters after the readings."""
    weights = np.ones(len(readings.value))
    if not len(weights):
        return unmeasured(prior)
    for _ in range(ROUNDS):
        found = _mixture(curve, readings, prior, weights)
        if len(weights) < FEWEST_WEIGHED:
            break
        value, _ = curve(found.mean)
        away = np.abs(readings.value - value)
        # By the median, because an outlier widens σ until it hides itself.
        seen = away[readings.is_bound == 0]
        middle = 1.4826 * float(np.median(seen)) if len(seen) else prior.sigma
        known = prior.degrees * prior.sigma**2 + len(away) * middle**2
        away = away / np.sqrt(known / (prior.degrees + len(away)))
        # A reading that stopped below the bound says nothing against the law.
        away = np.where((readings.is_bound > 0) & (readings.value < value), 0.0, away)
        new = np.where(away > FAR, FAR / np.maximum(away, FAR), 1.0) ** 2
        if np.allclose(new, weights, atol=1e-3):
            break
        weights = 0.5 * (new + weights)
    return replace(found, weights=weights)


def _mixture(curve: Curve, readings: Readings, prior: Prior, weights: Floats) -> Posterior:
    """Mixture over the grid of σ."""
    start = prior.mean
    means, spreads, evidence = [], [], []
    sigmas: Floats = prior.sigma * GRID[::-1]
    for sigma in sigmas:
        start, spread, score = _at_sigma(curve, readings, prior, (weights, sigma, start))
        means.append(start)
        spreads.append(spread)
        # Scaled inverse chi-square of σ², on a grid that is even in ln σ.
        score += -prior.degrees * (np.log(sigma) + 0.5 * (prior.sigma / sigma) ** 2)
        evidence.append(score)
    share: Floats = np.exp(np.array(evidence) - max(evidence))
    share = share / share.sum()
    mean: Floats = share @ np.array(means)
    around = [s + np.outer(m - mean, m - mean) for m, s in zip(means, spreads, strict=True)]
    return Posterior(
        prior=prior,
        mean=mean,
        covariance=np.tensordot(share, np.array(around), axes=1),
        sigma=float(np.exp(share @ np.log(sigmas))),
        degrees=prior.degrees + float(weights.sum()),
        weights=weights,
    )


def _at_sigma(
    curve: Curve, readings: Readings, prior: Prior, of: tuple[Floats, float, Floats]
) -> tuple[Floats, Floats, float]:
    """Mode, covariance and logarithm of the evidence at one σ."""
    weights, sigma, start = of
    theta: Floats = start
    precision = np.diag(prior.sd**-2)
    best = _score(curve, readings, prior, (weights, sigma, theta))
    inverse: Floats = np.diag(prior.sd**2)
    for _ in range(STEPS):
        value, slope = curve(theta)
        pull, weight = _pull(readings, value, sigma)
        gradient = slope.T @ (weights * pull) - precision @ (theta - prior.mean)
        information = precision + (slope.T * (weights * weight)) @ slope
        inverse = np.asarray(np.linalg.inv(information), dtype=np.float64)
        step = inverse @ gradient
        for _half in range(8):
            score = _score(curve, readings, prior, (weights, sigma, theta + step))
            if score >= best - 1e-12:
                break
            step = 0.5 * step
        else:
            break
        theta, best = np.asarray(theta + step, dtype=np.float64), score
        if np.max(np.abs(step) / prior.sd) < 1e-6:
            break
    _, logarithm = np.linalg.slogdet(inverse)
    return theta, inverse, best + 0.5 * float(logarithm)


def _pull(readings: Readings, value: Floats, sigma: float) -> tuple[Floats, Floats]:
    """First and second derivative of the logarithm of the likelihood by the value."""
    away = (readings.value - value) / sigma
    hazard = np.exp(norm.logpdf(away) - norm.logsf(away))
    pull = np.where(readings.is_bound > 0, hazard, away) / sigma
    weight = np.where(readings.is_bound > 0, hazard * (hazard - away), 1.0) / sigma**2
    return pull, weight


def _score(
    curve: Curve, readings: Readings, prior: Prior, of: tuple[Floats, float, Floats]
) -> float:
    weights, sigma, theta = of
    away = (readings.value - curve(theta)[0]) / sigma
    fit = np.where(readings.is_bound > 0, norm.logsf(away), -0.5 * away**2 - np.log(sigma))
    off = (theta - prior.mean) / prior.sd
    return float(weights @ fit - 0.5 * off @ off)
