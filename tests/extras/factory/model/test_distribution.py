"""Distributions: their means, and that no draw is negative."""

import numpy as np
import pytest

from extras.factory.model.distribution import Distribution, DistributionKind
from tests.every_case import every_case


@every_case(
    "distribution",
    [
        Distribution(kind=DistributionKind.CONSTANT, mean=4.0),
        Distribution(kind=DistributionKind.UNIFORM, low=2.0, high=6.0),
        Distribution(kind=DistributionKind.TRIANGULAR, low=1.0, mode=2.0, high=9.0),
        Distribution(kind=DistributionKind.EXPONENTIAL, mean=4.0),
        Distribution(kind=DistributionKind.GAMMA, mean=4.0, variation=0.5),
        Distribution(kind=DistributionKind.LOGNORMAL, mean=4.0, variation=0.5),
        Distribution(kind=DistributionKind.WEIBULL, mean=4.0, shape=2.0),
    ],
)
def test_draws_have_their_mean_and_are_never_negative(distribution: Distribution) -> None:
    numbers = distribution.draw(np.random.default_rng(5), 100_000)
    assert numbers.min() >= 0.0
    assert distribution.average == pytest.approx(4.0)
    assert numbers.mean() == pytest.approx(4.0, abs=4.5 * numbers.std() / 100_000**0.5 + 1e-12)
    assert distribution.scaled(2.0).average == pytest.approx(8.0)
    if distribution.variation == 0.5:
        assert numbers.std() / numbers.mean() == pytest.approx(0.5, rel=0.03)
