"""Distributions of times in a shop: what a file may say, and how numbers are drawn.

None of them gives a negative number. Draws use one uniform number each, by inversion or by
numpy, and come in blocks, since a single draw costs as much as fifty in a block.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import gamma, log, sqrt
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class DistributionKind(StrEnum):
    """Kind of a distribution."""

    CONSTANT = "constant"
    UNIFORM = "uniform"
    TRIANGULAR = "triangular"
    EXPONENTIAL = "exponential"
    GAMMA = "gamma"
    LOGNORMAL = "lognormal"
    WEIBULL = "weibull"


@dataclass(frozen=True, slots=True, kw_only=True)
class Distribution:
    """Distribution of a number that is not negative."""

    kind: DistributionKind
    low: float = 0.0
    """Least number of a uniform or triangular distribution."""
    mode: float = 0.0
    """Most frequent number of a triangular distribution."""
    high: float = 0.0
    """Greatest number of a uniform or triangular distribution."""
    mean: float = 0.0
    """Mean of all others; the number itself of a constant."""
    variation: float = 1.0
    """Standard deviation over the mean of a gamma or lognormal distribution."""
    shape: float = 1.0
    """Exponent of a Weibull distribution; above 1: more likely with age."""

    def scaled(self, factor: float) -> "Distribution":
        """Distribution of the number times a factor."""
        return Distribution(
            kind=self.kind,
            low=factor * self.low,
            mode=factor * self.mode,
            high=factor * self.high,
            mean=factor * self.mean,
            variation=self.variation,
            shape=self.shape,
        )

    @property
    def average(self) -> float:
        """Mean of the numbers."""
        match self.kind:
            case DistributionKind.UNIFORM:
                return 0.5 * (self.low + self.high)
            case DistributionKind.TRIANGULAR:
                return (self.low + self.mode + self.high) / 3.0
            case _:
                return self.mean

    @property
    def is_zero(self) -> bool:
        """True if every number is 0."""
        return self.average == 0.0

    @property
    def is_random(self) -> bool:
        """True if two numbers differ."""
        match self.kind:
            case DistributionKind.CONSTANT:
                return False
            case DistributionKind.UNIFORM | DistributionKind.TRIANGULAR:
                return self.low < self.high
            case _:
                return self.mean > 0.0

    def draw(self, generator: np.random.Generator, count: int) -> Floats:
        """Numbers of the distribution, (count,)."""
        match self.kind:
            case DistributionKind.CONSTANT:
                return np.full(count, self.mean)
            case DistributionKind.UNIFORM:
                return generator.uniform(self.low, self.high, count)
            case DistributionKind.TRIANGULAR:
                if self.low == self.high:
                    return np.full(count, self.low)
                return generator.triangular(self.low, self.mode, self.high, count)
            case DistributionKind.EXPONENTIAL:
                return generator.exponential(self.mean, count)
            case DistributionKind.GAMMA:
                shape = self.variation**-2
                return generator.gamma(shape, self.mean / shape, count)
            case DistributionKind.LOGNORMAL:
                spread = sqrt(log(1.0 + self.variation**2))
                return self.mean * generator.lognormal(-0.5 * spread**2, spread, count)
            case DistributionKind.WEIBULL:
                scale = self.mean / gamma(1.0 + 1.0 / self.shape)
                return scale * generator.weibull(self.shape, count)
        assert_never(self.kind)


def constant(value: float) -> Distribution:
    """Distribution that always gives the same number."""
    return Distribution(kind=DistributionKind.CONSTANT, mean=value)


def scattered(value: float, scatter: float) -> Distribution:
    """Uniform distribution around a number, by a relative half-width."""
    low, high = value * (1.0 - scatter), value * (1.0 + scatter)
    return Distribution(kind=DistributionKind.UNIFORM, low=low, high=high)
