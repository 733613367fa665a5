"""Measured over expected force."""

from math import log, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.signals.estimate import STEADY, RatioEstimate, counted, force_ratio, log_ratio
from tests.controller.shown import REVOLUTION


def test_ratio_is_measured_over_expected() -> None:
    found = log_ratio(REVOLUTION._replace(force=460.0), 400.0, expected_before=400.0)
    assert found == pytest.approx(log(1.15))


@pytest.mark.parametrize("coverage", [0.5, 1.0])
def test_half_of_the_samples_is_enough(coverage: float) -> None:
    revolution = REVOLUTION._replace(coverage=coverage)
    assert log_ratio(revolution, 400.0, expected_before=400.0) is not None


@pytest.mark.parametrize(
    ("change", "expected", "before"),
    [
        ({"coverage": 0.49}, 400.0, 400.0),
        ({"force": nan}, 400.0, 400.0),
        ({"force": -2.0}, 400.0, 400.0),
        ({}, 0.0, 400.0),
        ({}, 400.0, 0.0),
        ({}, 400.0, 400.0 * np.exp(1.01 * STEADY)),
        ({}, 400.0, 400.0 * np.exp(-1.01 * STEADY)),
        ({}, nan, 400.0),
    ],
)
def test_what_tells_nothing_of_the_ratio_is_left_out(
    change: dict[str, float], expected: float, before: float
) -> None:
    revolution = REVOLUTION._replace(**change)  # type: ignore[arg-type]
    assert log_ratio(revolution, expected, expected_before=before) is None


@given(st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=50), st.floats(-1e3, 1e3))
def test_running_statistics_are_those_of_all(ratios: list[float], shift: float) -> None:
    estimate = RatioEstimate()
    for ratio in ratios:
        estimate = counted(estimate, ratio + shift)
    found = force_ratio(estimate)
    assert found is not None
    assert found.readings == len(ratios)
    assert found.log_mean == pytest.approx(np.mean(ratios) + shift, abs=1e-9)
    assert found.log_deviation == pytest.approx(np.std(ratios, ddof=1), abs=1e-9)


def test_one_reading_tells_no_deviation() -> None:
    assert force_ratio(RatioEstimate()) is None
    once = counted(RatioEstimate(), 0.1)
    assert once.log_deviation == 0.0
    assert force_ratio(once) is None


def test_factor_on_the_force_is_found_through_entry_noise_and_losses() -> None:
    """A hidden factor 1.15, 3 % noise, an entry over 20 revolutions, one in ten lost."""
    random = np.random.default_rng(2)
    estimate, before = RatioEstimate(), 0.0
    for row in range(400):
        expected = 500.0 * min(1.0, (row + 1) / 20.0)
        # What was measured in a revolution of the entry began with the depth before it.
        force = 1.15 * (0.5 * (expected + before) if row else expected)
        force *= np.exp(random.normal(0.0, 0.03))
        coverage = 0.2 if random.random() < 0.1 else 1.0
        revolution = REVOLUTION._replace(
            force=nan if coverage < 0.5 else float(force), coverage=coverage
        )
        ratio = log_ratio(revolution, expected, expected_before=before)
        estimate = estimate if ratio is None else counted(estimate, ratio)
        before = expected
    found = force_ratio(estimate)
    assert found is not None
    assert found.log_mean == pytest.approx(log(1.15), abs=5.0 * 0.03 / found.readings**0.5)
    assert found.log_deviation == pytest.approx(0.03, rel=0.15)
    assert 320 < found.readings < 395
