"""Scores against their definitions, and intervals against what they promise."""

import numpy as np
import pytest

from extras.learning.scores import scores_of


def test_scores_are_those_of_their_definitions() -> None:
    scores = scores_of(np.array([1.0, 2.0, 4.0]), np.array([1.5, 2.0, 3.0]), seed=1)
    assert scores.mae.value == pytest.approx(0.5)
    assert scores.rmse.value == pytest.approx((1.25 / 3) ** 0.5)
    assert scores.mape.value == pytest.approx(100 * (0.5 + 0.0 + 0.25) / 3)
    assert scores.r2 is not None
    assert scores.r2.value == pytest.approx(1 - 1.25 / (14 / 3))


def test_the_mean_has_no_r2() -> None:
    actual = np.array([1.0, 2.0, 3.0, 6.0])
    found = scores_of(actual, np.full(4, 3.0), seed=1).r2
    assert found is not None
    assert found.value == pytest.approx(0.0)
    assert scores_of(np.full(4, 3.0), actual, seed=1).r2 is None


def test_the_interval_of_a_mean_error_is_that_of_its_standard_error() -> None:
    rng = np.random.default_rng(4)
    actual, error = rng.uniform(100.0, 200.0, 400), rng.uniform(0.0, 10.0, 400)
    score = scores_of(actual, actual + error, seed=2).mae
    half = 1.96 * error.std() / 20.0
    assert score.low == pytest.approx(error.mean() - half, abs=0.2 * half)
    assert score.high == pytest.approx(error.mean() + half, abs=0.2 * half)
