"""The ring keeps the latest rows in bounded memory."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from service.monitor.ring import RowRing


@given(st.integers(0, 60), st.integers(1, 9), st.integers(0, 70))
def test_the_latest_rows_are_kept_in_order(count: int, most: int, since: int) -> None:
    ring = RowRing(2, most=most)
    for number in range(count):
        ring.add([float(number), -float(number)])
    kept = [float(number) for number in range(count)][-most:]
    assert ring.count == count
    assert len(ring) == len(kept)
    assert ring.rows()[:, 0].tolist() == kept
    fresh = [time for time in kept if time >= since]
    assert ring.rows(since)[:, 0].tolist() == fresh
    assert ring.last_time == (kept[-1] if kept else None)


def test_a_row_of_the_same_time_replaces_the_latest_one() -> None:
    ring = RowRing(2, most=3)
    for value in (1.0, 2.0):
        ring.add([5.0, value])
    assert (len(ring), ring.count) == (1, 1)
    assert np.array_equal(ring.rows(), [[5.0, 2.0]])


def test_a_cleared_ring_counts_on() -> None:
    ring = RowRing(2, most=3)
    ring.add([5.0, 1.0])
    ring.clear()
    assert (len(ring), ring.count, ring.last_time) == (0, 1, None)
    ring.add([1.0, 2.0])
    assert np.array_equal(ring.rows(1), [[1.0, 2.0]])
