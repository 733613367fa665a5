"""A sample of bounded size: exact while short, fair when long."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from kbe.statistics import Reservoir


def filled(values: list[float], capacity: int = 1000) -> Reservoir:
    sample = Reservoir(capacity)
    for value in values:
        sample.add(value)
    return sample


@given(
    values=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=60),
    share=st.floats(0.0, 1.0),
)
def test_short_stream_has_the_quantiles_of_numpy(values: list[float], share: float) -> None:
    found = filled(values).quantile(share)
    assert found == pytest.approx(float(np.quantile(values, share)), abs=1e-12)


def test_empty_stream_has_no_quantile() -> None:
    assert Reservoir().quantile(0.5) is None


def test_long_stream_has_nearly_its_quantiles() -> None:
    values = np.random.default_rng(4).normal(size=20_000)
    found = filled(list(values)).quantile(0.95)
    assert found is not None
    # Rank of 1000 draws: 0.95 ± 3·√(0.95·0.05/1000).
    assert 0.929 < stats.norm.cdf(found) < 0.971


def test_early_and_late_values_are_kept_alike() -> None:
    """Places of 20 kept of a stream of 1000, for 400 seeds, in ten classes: χ²."""
    counts = np.zeros(10)
    stream = [float(place) for place in range(1000)]
    for seed in range(400):
        sample = Reservoir(20, seed=seed)
        for place in stream:
            sample.add(place)
        kept = [sample.quantile(rank / 19) or 0.0 for rank in range(20)]
        counts += np.histogram(kept, bins=10, range=(0.0, 1000.0))[0]
    assert counts.sum() == 8000
    assert stats.chisquare(counts).pvalue > 0.001


def test_same_stream_gives_the_same_sample() -> None:
    values = [float(value) for value in np.random.default_rng(7).normal(size=5000)]
    assert filled(values, 50).quantile(0.3) == filled(values, 50).quantile(0.3)
