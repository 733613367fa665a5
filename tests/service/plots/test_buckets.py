"""Buckets are bounded, keep every peak, and do not see how values come in chunks."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.plots.buckets import MOST, BucketedRun, Buckets
from simulator.motion.segments import Floats


def traced(time: Floats, values: Floats, ends: tuple[int, ...] = ()) -> BucketedRun:
    buckets = Buckets(values.shape[1])
    for begin, end in pairwise((0, *sorted(ends), len(time))):
        buckets.add(time[begin:end], values[begin:end])
    return buckets.trace()


@given(
    seed=st.integers(0, 2**32 - 1),
    longest=st.sampled_from([0.1, 60.0, 3600.0, 360_000.0]),
    ends=st.lists(st.integers(0, 200), max_size=4),
)
def test_chunks_do_not_matter(seed: int, longest: float, ends: list[int]) -> None:
    random = np.random.default_rng(seed)
    time = np.sort(random.uniform(0.0, longest, 200))
    values = random.normal(0.0, 1.0, (200, 2))
    values[random.random((200, 2)) < 0.1] = np.nan
    whole, parts = traced(time, values), traced(time, values, tuple(ends))
    assert parts.width == whole.width
    for number in range(2):
        one, other = whole.curve(number), parts.curve(number)
        for name in ("low", "mean", "high"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("seconds", [1.0, 1e6])
def test_least_and_greatest_survive_in_bounded_room(seconds: float) -> None:
    time = np.linspace(0.0, seconds, 50_000)
    values = np.zeros((50_000, 1))
    values[33_333], values[44_444] = 7.0, -5.0
    trace = traced(time, values)
    assert len(trace.begin) <= MOST
    assert (trace.curve(0).high.max(), trace.curve(0).low.min()) == (7.0, -5.0)
    assert (trace.begin[0], trace.end[-1]) == (0.0, seconds)


def test_a_bucket_of_missing_values_is_not_known() -> None:
    trace = traced(np.array([0.0, 1.0]), np.array([[np.nan], [3.0]]))
    np.testing.assert_array_equal(trace.curve(0).mean, [np.nan, 3.0])
    np.testing.assert_array_equal(trace.curve(0).high, [np.nan, 3.0])
