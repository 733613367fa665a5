"""Lower envelope of intervals, against the least over all intervals at each place."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.along_path.envelope import lower_envelope

PLACE = st.integers(0, 40)
INTERVAL = st.tuples(PLACE, st.integers(0, 12), st.integers(1, 9))


@given(st.lists(INTERVAL, max_size=12))
def test_each_place_has_the_least_cap_that_covers_it(
    intervals: list[tuple[int, int, int]],
) -> None:
    rows = [(0, 60, 10), *((begin, begin + size, cap) for begin, size, cap in intervals)]
    begin, end, cap = np.array(rows, dtype=np.float64).T
    found = lower_envelope(begin, end, cap)
    places = np.arange(60) + 0.5
    covers = (begin <= places[:, None]) & (places[:, None] <= end)
    expected = np.where(covers, cap, np.inf).min(axis=1)
    assert (cap[found.which[np.searchsorted(found.ends, places)]] == expected).all()
    assert found.ends[-1] == 60.0
    assert (np.diff(found.ends) > 0.0).all()


def test_a_gap_between_intervals_is_refused() -> None:
    with pytest.raises(ValueError, match="no interval covers the path after 1 mm"):
        lower_envelope(np.array([0.0, 2.0]), np.array([1.0, 3.0]), np.array([5.0, 5.0]))
