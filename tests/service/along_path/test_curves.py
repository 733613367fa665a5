"""Curves for plots: few points that keep every peak."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.along_path.curves import MOST_BUCKETS, _curve, _limits
from service.along_path.plan_run import LimitStretch
from service.along_path.trace import PathSignal
from service.plots.buckets import Buckets


@given(st.integers(1, 30_000), st.integers(0, 2**31))
def test_few_stretches_keep_the_extremes(count: int, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=(count, len(PathSignal)))
    buckets = Buckets(len(PathSignal))
    buckets.add(np.sort(np.random.default_rng(seed).uniform(0.0, 900.0, count)), values)
    found = _curve(buckets.trace())
    assert 0 < len(found["begin"]) <= MOST_BUCKETS
    assert np.all(found["begin"] <= found["end"])
    assert np.all(np.diff(found["begin"]) > 0.0)
    feed = found["signals"]["feed_mm_min"]
    assert feed["low"].min() == pytest.approx(values[:, PathSignal.FEED].min(), abs=1e-3)
    assert feed["high"].max() == pytest.approx(values[:, PathSignal.FEED].max(), abs=1e-3)


@given(st.lists(st.tuples(st.floats(1e-4, 50.0), st.sampled_from("abc")), max_size=200))
def test_the_strip_of_limits_is_bounded_and_in_order(
    stretches: list[tuple[float, str]],
) -> None:
    end, rows = 0.0, []
    for length, words in stretches:
        rows.append(LimitStretch(begin=end, end=end + length, words=words))
        end += length
    found = _limits(rows)
    assert len(found["limit"]) <= MOST_BUCKETS + 1
    assert all(b <= e for b, e in zip(found["begin_mm"], found["end_mm"], strict=True))
    assert found["begin_mm"] == sorted(found["begin_mm"])
    assert all(0 <= at < len(found["names"]) for at in found["limit"])


def test_the_longest_limit_of_a_stretch_is_shown() -> None:
    rows = [
        LimitStretch(begin=0.0, end=500.3, words="power"),
        LimitStretch(begin=500.3, end=1000.0, words="air"),
    ]
    found = _limits(rows)
    assert [found["names"][at] for at in found["limit"]] == ["power", "air"]
    assert found["begin_mm"] == pytest.approx([0.0, 500.0], abs=1.0)
