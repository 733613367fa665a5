"""Moments of a stream against numpy and scipy, which keep it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.statistics import Moments


def of(values: list[float]) -> Moments:
    moments = Moments()
    for place, value in enumerate(values):
        moments.add(place, value)
    return moments


@given(values=st.lists(st.floats(-10.0, 10.0), min_size=2, max_size=50))
def test_mean_and_deviation_are_those_of_numpy(values: list[float]) -> None:
    found = of(values)
    assert found.mean == pytest.approx(np.mean(values), abs=1e-9)
    assert found.deviation == pytest.approx(np.std(values, ddof=1), abs=1e-6)


@given(seed=st.integers(0, 10_000), count=st.integers(3, 40), slope=st.floats(-1.0, 1.0))
def test_trend_is_that_of_scipy(seed: int, count: int, slope: float) -> None:
    random = np.random.default_rng(seed)
    values = slope * np.arange(count) + random.normal(size=count)
    found, wanted = of(list(values)).trend, stats.linregress(np.arange(count), values)
    assert found is not None
    assert found.per_run == pytest.approx(wanted.slope)
    assert found.standard_error == pytest.approx(wanted.stderr)
    assert found.chance == pytest.approx(wanted.pvalue, rel=1e-6, abs=1e-12)
    assert found.runs == count


def test_far_off_values_keep_their_scatter() -> None:
    """Sums of squares would lose all digits."""
    assert of([1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0]).deviation == pytest.approx(1.0)


def test_perfect_line_is_no_chance_and_a_level_one_is() -> None:
    rising, level = of([0.0, 1.0, 2.0, 3.0]).trend, of([2.0, 2.0, 2.0]).trend
    assert rising is not None
    assert rising.is_significant
    assert level is not None
    assert not level.is_significant


def test_chance_alone_is_seldom_significant() -> None:
    """At 1 %: of 2000 series without trend 20 ± 13."""
    random = np.random.default_rng(9)
    trends = [of(list(random.normal(size=10))).trend for _ in range(2000)]
    found = sum(trend is not None and trend.is_significant for trend in trends)
    assert 7 <= found <= 33


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0]])
def test_too_few_points_have_no_trend(values: list[float]) -> None:
    assert of(values).trend is None
    assert (of(values).deviation is None) == (len(values) < 2)


def test_points_at_one_place_have_no_trend() -> None:
    moments = Moments()
    for value in (1.0, 2.0, 3.0):
        moments.add(5.0, value)
    assert moments.trend is None
