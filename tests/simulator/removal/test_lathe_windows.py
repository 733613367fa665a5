"""Stretches over which removal is counted."""

import numpy as np
import pytest

from simulator.motion.segments import lines
from simulator.removal.lathe_windows import WINDOW, Removed, Windows, grouped, windows_of


def even(count: int, length: float) -> Windows:
    """Stretches of one segment each."""
    return Windows(segment=np.arange(count), start=np.zeros(count), end=np.full(count, length))


def test_stretches_cover_each_segment_without_a_gap() -> None:
    path = lines([(30, 0, 50), (20, 0, 50), (20, 0, 20), (25, 0, 17)], speed=1.0)
    windows = windows_of(path, 0.01)
    for row, length in enumerate(path.length.tolist()):
        own = windows.segment[1:] == row
        assert windows.start[1:][own][0] == 0.0
        assert windows.end[1:][own][-1] == length
        np.testing.assert_array_equal(windows.start[1:][own][1:], windows.end[1:][own][:-1])
    assert (windows.length[1:] >= WINDOW * 0.01 * (1.0 - 1e-6)).all()
    assert windows.length[0] == 0.0


def test_a_line_is_cut_at_whole_cells() -> None:
    path = lines([(20.0, 0.0, 50.0), (25.0, 0.0, 38.0)], speed=1.0)
    windows = windows_of(path, 0.01)
    cells = windows.length[1:-1] * 12.0 / 13.0 / 0.01
    np.testing.assert_allclose(cells, np.round(cells), atol=1e-9)


@pytest.mark.parametrize("length", [20.3, 20.3 / 2, 20.3 / 3])
def test_the_last_stretch_is_as_long_however_a_line_is_divided(length: float) -> None:
    """At the end of a line lies the wall of a shoulder: its depth is found there."""
    ends = [20.3 - row * length for row in range(round(20.3 / length) + 1)]
    windows = windows_of(lines([(10.0, 0.0, end) for end in ends], speed=1.0), 0.01)
    assert windows.length[-1] == pytest.approx(WINDOW * 0.01)


def test_a_rapid_is_one_stretch() -> None:
    assert len(windows_of(lines([(0, 0, 0), (0, 0, 90)]), 0.01).segment) == 2
    assert len(windows_of(lines([(0, 0, 0)]), 0.01).segment) == 0


def test_short_segments_share_what_they_remove() -> None:
    """Ten cells of a wall passed in chords of 0.04 mm: 0, 10 or 20 % of them a chord."""
    jumps = np.tile([1.0, 0.5, 0.0, 0.5, 1.0], 20)
    both = grouped(Removed(windows=even(100, 0.1), area=jumps + 1.0, volume=jumps + 1.0), 0.01)
    assert len(both.volume) == 100
    np.testing.assert_allclose(both.volume, 1.6)
    assert both.volume.sum() == pytest.approx((jumps + 1.0).sum())


def test_stretches_alike_become_one_and_others_do_not() -> None:
    section = np.array([0.0, 0.0, 2.0, 2.0, 2.01, 3.0, 3.0, 0.0])
    whole = Windows(
        segment=np.zeros(8, dtype=np.int64), start=np.arange(8.0), end=np.arange(8.0) + 1.0
    )
    few = grouped(Removed(windows=whole, area=section, volume=section), 0.01)
    assert few.windows.end.tolist() == [2.0, 5.0, 7.0, 8.0]
    np.testing.assert_allclose(few.volume, [0.0, 6.01, 6.0, 0.0])
