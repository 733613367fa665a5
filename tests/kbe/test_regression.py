"""Conjugate regression against integrals on a grid, itself in pieces, and chance."""

from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from scipy.integrate import simpson

from kbe.corrections import (
    Floats,
    NormalInverseGamma,
    Observations,
    expected,
    forgotten,
    predicted,
    updated,
)
from tests.every_case import every_case

ONE = np.ones(1)
PRIOR = NormalInverseGamma(mean=np.zeros(1), precision=np.eye(1) / 16.0, shape=2.0, rate=0.005)


def seen(design: Floats, values: Floats, *, weights: Floats | None = None) -> Observations:
    ones = np.ones(len(values))
    return Observations(
        design=design, values=values, weights=ones if weights is None else weights, counts=ones
    )


def random_problem(seed: int) -> tuple[NormalInverseGamma, Observations]:
    """A power law of two variables, ``ln y = ln c + e₁ ln x₁ + e₂ ln x₂``."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(3, 3))
    prior = NormalInverseGamma(
        mean=random.normal(size=3),
        precision=root @ root.T + 0.1 * np.eye(3),
        shape=float(random.uniform(0.5, 4.0)),
        rate=float(random.uniform(0.1, 2.0)),
    )
    count = int(random.integers(1, 9))
    return prior, Observations(
        design=np.column_stack([np.ones(count), random.normal(size=(count, 2))]),
        values=random.normal(size=count),
        weights=random.uniform(0.1, 2.0, count),
        counts=random.uniform(0.1, 1.0, count),
    )


def assert_same(found: NormalInverseGamma, wanted: NormalInverseGamma) -> None:
    np.testing.assert_allclose(found.precision, wanted.precision, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.mean, wanted.mean, rtol=1e-7, atol=1e-9)
    assert found.shape == pytest.approx(wanted.shape, rel=1e-12)
    assert found.rate == pytest.approx(wanted.rate, rel=1e-7)


class Grid:
    """Prior times likelihood of one mean with unknown scatter, on a grid, normalised."""

    def __init__(self, values: Floats, weights: Floats, counts: Floats) -> None:
        self.mean = np.linspace(-1.0, 1.5, 1001)[:, None]
        self.scatter = np.geomspace(0.01, 0.6, 601)
        log = stats.invgamma.logpdf(self.scatter**2, PRIOR.shape, scale=PRIOR.rate)
        log = log + np.log(2.0 * self.scatter)  # of σ, where scipy has the density of σ²
        log = log + stats.norm.logpdf(self.mean, 0.0, 4.0 * self.scatter)
        for value, weight, count in zip(values, weights, counts, strict=True):
            own = self.scatter / sqrt(weight)
            log = log + count * stats.norm.logpdf(value, self.mean, own)
        density = np.exp(log - log.max())
        self.density = density / self._whole(density)

    def expectation(self, of: Floats) -> float:
        return self._whole(self.density * of)

    def _whole(self, density: Floats) -> float:
        inner = simpson(density, x=self.scatter, axis=1)
        return float(simpson(inner, x=self.mean[:, 0]))


VALUES = np.array([0.21, 0.30, 0.26])
WEIGHTS = np.array([1.0, 0.4, 0.8])
COUNTS = np.array([1.0, 0.5, 0.5])


@pytest.fixture(scope="module")
def grid() -> Grid:
    return Grid(VALUES, WEIGHTS, COUNTS)


def believed() -> NormalInverseGamma:
    return updated(
        PRIOR,
        Observations(design=np.ones((3, 1)), values=VALUES, weights=WEIGHTS, counts=COUNTS),
    )


def test_mean_and_its_spread_are_those_of_the_integral(grid: Grid) -> None:
    found = expected(believed(), ONE)
    assert found.centre == pytest.approx(grid.expectation(grid.mean), abs=1e-5)
    variance = grid.expectation((grid.mean - found.centre) ** 2)
    law = stats.t(found.degrees, found.centre, found.scale)
    # The grid ends where the law still has a few in 100 000.
    assert law.var() == pytest.approx(variance, rel=2e-3)


@every_case("value", [0.1, 0.2, 0.26, 0.3, 0.5])
@every_case("weight", [1.0, 0.25])
def test_prediction_is_that_of_the_integral(grid: Grid, value: float, weight: float) -> None:
    scale = np.broadcast_to(grid.scatter / sqrt(weight), grid.density.shape)
    wanted = grid.expectation(stats.norm.cdf(value, grid.mean, scale))
    found = predicted(believed(), ONE, weight=weight).below(value)
    assert found == pytest.approx(wanted, abs=1e-5)


def test_one_mean_is_that_of_gelman() -> None:
    """[1] §3.3: κ_n, ν_n, μ_n and ν_n·σ_n² in closed form."""
    kappa, nu, sigma2 = 1.0 / 16.0, 4.0, 0.0025
    count, mean = 3, VALUES.mean()
    found = updated(PRIOR, seen(np.ones((3, 1)), VALUES))
    assert found.precision[0, 0] == pytest.approx(kappa + count)
    assert found.mean[0] == pytest.approx(count * mean / (kappa + count))
    assert 2.0 * found.shape == nu + count
    squares = ((VALUES - mean) ** 2).sum()
    between = kappa * count / (kappa + count) * mean**2
    assert 2.0 * found.rate == pytest.approx(nu * sigma2 + squares + between)


@given(seed=st.integers(0, 10_000))
def test_one_after_the_other_is_all_at_once(seed: int) -> None:
    prior, all_of_them = random_problem(seed)
    belief = prior
    for row in range(len(all_of_them.values)):
        one = slice(row, row + 1)
        piece = Observations(
            design=all_of_them.design[one],
            values=all_of_them.values[one],
            weights=all_of_them.weights[one],
            counts=all_of_them.counts[one],
        )
        belief = updated(belief, piece)
    assert_same(belief, updated(prior, all_of_them))


@given(seed=st.integers(0, 10_000), share=st.floats(0.0, 1.0))
def test_forgetting_is_a_likelihood_to_a_power(seed: int, share: float) -> None:
    prior, observations = random_problem(seed)
    belief = updated(prior, observations)
    fainter = Observations(
        design=observations.design,
        values=observations.values,
        weights=observations.weights,
        counts=share * observations.counts,
    )
    assert_same(forgotten(belief, prior, share=share), updated(prior, fainter))


def test_all_forgotten_is_the_prior_and_nothing_forgotten_is_nothing() -> None:
    assert_same(forgotten(believed(), PRIOR, share=0.0), PRIOR)
    assert_same(forgotten(believed(), PRIOR, share=1.0), believed())


@pytest.mark.parametrize("share", [-0.1, 1.1])
def test_shares_beyond_the_whole_are_refused(share: float) -> None:
    with pytest.raises(ValueError, match="share"):
        forgotten(PRIOR, PRIOR, share=share)


def test_many_observations_give_least_squares() -> None:
    random = np.random.default_rng(5)
    design = np.column_stack([np.ones(5000), random.normal(size=(5000, 2))])
    values = design @ np.array([0.3, 0.8, -0.2]) + random.normal(0.0, 0.1, 5000)
    prior = NormalInverseGamma(
        mean=np.zeros(3), precision=1e-3 * np.eye(3), shape=1.0, rate=0.01
    )
    found = updated(prior, seen(design, values))
    least_squares, residual, *_ = np.linalg.lstsq(design, values)
    np.testing.assert_allclose(found.mean, least_squares, atol=1e-3)
    assert found.scatter == pytest.approx(sqrt(residual[0] / 5000), rel=2e-3)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Truths drawn from the prior: then 90 % is exact, whatever the number of observations."""
    random = np.random.default_rng(11)
    repetitions, held, foretold = 2000, 0, 0
    for _ in range(repetitions):
        scatter = sqrt(PRIOR.rate / random.gamma(PRIOR.shape))
        truth = random.normal(0.0, 4.0 * scatter)
        weights = random.uniform(0.2, 1.0, 4)
        values = random.normal(truth, scatter / np.sqrt(weights))
        belief = updated(PRIOR, seen(np.ones((4, 1)), values, weights=weights))
        held += 0.05 <= expected(belief, ONE).below(truth) <= 0.95
        coming = random.normal(truth, scatter)
        foretold += 0.05 <= predicted(belief, ONE).below(coming) <= 0.95
    three_deviations = 3.0 * sqrt(repetitions * 0.9 * 0.1)
    assert abs(held - 0.9 * repetitions) < three_deviations
    assert abs(foretold - 0.9 * repetitions) < three_deviations


@every_case(("shape", "rate"), [(0.0, 1.0), (1.0, 0.0), (-1.0, 1.0)])
def test_what_is_no_distribution_is_refused(shape: float, rate: float) -> None:
    with pytest.raises(ValueError, match="above 0"):
        NormalInverseGamma(mean=np.zeros(1), precision=np.eye(1), shape=shape, rate=rate)


def test_mean_and_precision_must_fit() -> None:
    with pytest.raises(ValueError, match="precision"):
        NormalInverseGamma(mean=np.zeros(2), precision=np.eye(1), shape=1.0, rate=1.0)


@every_case(
    ("design", "values", "weights", "words"),
    [
        (np.ones((2, 1)), np.ones(1), np.ones(1), "design"),
        (np.ones(1), np.ones(1), np.ones(1), "design"),
        (np.ones((1, 1)), np.ones(1), np.ones(2), "one weight"),
        (np.ones((1, 1)), np.array([np.nan]), np.ones(1), "finite"),
        (np.ones((1, 1)), np.ones(1), np.zeros(1), "above 0"),
    ],
)
def test_observations_that_do_not_fit_are_refused(
    design: Floats, values: Floats, weights: Floats, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        seen(design, values, weights=weights)
