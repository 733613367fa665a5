"""At most K feeds of least time, against all that there are on short paths."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.feed_profile.levels import BlockRule, Floats, best_levels
from tests.every_case import every_case

CAPS = (3.0, 5.0, 6.0, 7.0, 10.0, 12.0, 20.0)


def least_time(lengths: Floats, caps: Floats, *, count: int, rule: BlockRule) -> float:
    """Least time of all assignments of caps to stretches."""
    shortest = min(rule.shortest, lengths.sum()) * (1.0 - 1e-9)
    best = np.inf
    for feeds in map(np.array, product(np.unique(caps), repeat=len(caps))):
        if (feeds > caps).any() or len(np.unique(feeds)) > count:
            continue
        starts = np.append(0, np.flatnonzero(np.diff(feeds)) + 1)
        values = feeds[starts]
        ratios = np.maximum(values[1:], values[:-1]) / np.minimum(values[1:], values[:-1])
        is_long = (np.add.reduceat(lengths, starts) >= shortest).all()
        if is_long and (ratios >= (1.0 + rule.change) * (1.0 - 1e-9)).all():
            best = min(best, float((lengths / feeds).sum()))
    return best


@st.composite
def stretches(draw: st.DrawFn) -> tuple[Floats, Floats]:
    size = draw(st.integers(1, 6))
    lengths = draw(st.lists(st.floats(0.2, 3.0), min_size=size, max_size=size))
    caps = draw(st.lists(st.sampled_from(CAPS), min_size=size, max_size=size))
    return np.array(lengths), np.array(caps)


@given(path=stretches(), count=st.integers(1, 4))
@settings(max_examples=60, deadline=None)
def test_no_choice_of_feeds_takes_less(path: tuple[Floats, Floats], count: int) -> None:
    lengths, caps = path
    found = best_levels(lengths, caps, count=count)
    least = least_time(lengths, caps, count=count, rule=BlockRule())
    assert found.time == pytest.approx(least, rel=1e-12)
    assert found.bound == found.time
    assert (found.feeds <= caps).all()
    assert len(found.values) <= count


@given(
    path=stretches(),
    count=st.integers(1, 4),
    shortest=st.floats(0.0, 4.0),
    change=st.sampled_from((0.0, 0.1, 0.3)),
)
@settings(max_examples=60, deadline=None)
def test_blocks_keep_the_rule_and_the_time_lies_near_the_least(
    path: tuple[Floats, Floats], count: int, shortest: float, change: float
) -> None:
    """The choice of levels is a search: on short paths it has found the least so far."""
    lengths, caps = path
    rule = BlockRule(shortest=shortest, change=change)
    found = best_levels(lengths, caps, count=count, rule=rule)
    blocks = np.add.reduceat(lengths, found.block_starts)
    values = found.feeds[found.block_starts]
    ratios = np.maximum(values[1:], values[:-1]) / np.minimum(values[1:], values[:-1])
    assert (found.feeds <= caps).all()
    assert len(found.values) <= count
    assert (blocks >= min(shortest, lengths.sum()) * (1.0 - 1e-9)).all()
    assert (ratios >= (1.0 + change) * (1.0 - 1e-9)).all()
    least = least_time(lengths, caps, count=count, rule=rule)
    assert found.bound * (1.0 - 1e-12) <= least <= found.time * (1.0 + 1e-12)
    assert found.time <= 1.02 * least


@given(path=stretches(), count=st.integers(1, 4))
@settings(max_examples=30, deadline=None)
def test_one_more_feed_never_costs_time(path: tuple[Floats, Floats], count: int) -> None:
    lengths, caps = path
    few = best_levels(lengths, caps, count=count)
    more = best_levels(lengths, caps, count=count + 1)
    assert few.free_time <= more.time * (1.0 + 1e-12) <= few.time * (1.0 + 2e-12)


def test_as_many_feeds_as_caps_are_the_caps() -> None:
    caps = np.array([9.0, 2.0, 9.0, 4.0])
    found = best_levels(np.ones(4), caps, count=3)
    assert found.feeds.tolist() == caps.tolist()
    assert found.gap == 0.0


def test_a_short_peak_is_merged_with_its_neighbours() -> None:
    lengths, caps = np.array([10.0, 0.5, 10.0]), np.array([5.0, 20.0, 8.0])
    found = best_levels(lengths, caps, count=3, rule=BlockRule(shortest=1.0))
    assert found.feeds.tolist() == [5.0, 8.0, 8.0]
    assert found.block_starts.tolist() == [0, 1]


def test_a_path_shorter_than_a_block_is_one_block() -> None:
    found = best_levels(
        np.array([0.2, 0.3]), np.array([5.0, 9.0]), count=2, rule=BlockRule(shortest=1.0)
    )
    assert found.values.tolist() == [5.0]


def test_a_thousand_caps_and_a_count_of_a_thousand_agree() -> None:
    random = np.random.default_rng(3)
    lengths, caps = random.uniform(0.1, 1.0, 1000), random.uniform(1.0, 50.0, 1000)
    gaps = [best_levels(lengths, caps, count=count).gap for count in (1, 2, 4, 8, 999, 1000)]
    assert gaps == sorted(gaps, reverse=True)
    assert gaps[-1] == 0.0
    assert gaps[-2] > 0.0


@every_case(
    ("lengths", "caps", "count", "message"),
    [
        ([], [], 2, "must have the same shape"),
        ([1.0], [1.0, 2.0], 2, "must have the same shape"),
        ([1.0, 0.0], [1.0, 2.0], 2, "stretch 1: length 0 mm must be positive and finite"),
        ([1.0, 1.0], [1.0, np.nan], 2, "stretch 1: cap nan mm/s must be positive and finite"),
        ([1.0], [1.0], 0, "count of 0 feeds must be at least 1"),
    ],
)
def test_what_is_no_row_of_stretches_is_refused(
    lengths: list[float], caps: list[float], count: int, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        best_levels(np.array(lengths), np.array(caps), count=count)


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_a_rule_must_be_finite_and_not_negative(value: float) -> None:
    with pytest.raises(ValueError, match=r"shortest of .* mm must not be negative, but finite"):
        BlockRule(shortest=value)
