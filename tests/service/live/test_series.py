"""Rows that are read while they grow; windows of them in which no peak is lost."""

import json
import sys
from pathlib import Path
from subprocess import run

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.errors import NotFound
from service.live import series
from service.live.series import Series, SeriesWriter, first_at, open_series, window
from simulator.motion.segments import Floats
from tests.every_case import every_case
from tests.service.live.room import within_room

COLUMNS = ("time_s", "a", "b")

Values = arrays(
    np.float64,
    st.tuples(st.integers(1, 60), st.just(2)),
    elements=st.one_of(st.floats(-1e6, 1e6), st.just(np.nan)),
)


def series_of(values: Floats) -> Series:
    time = np.arange(len(values), dtype=np.float64)
    return Series(columns=COLUMNS, values=np.column_stack([time, values]))


def opened(file: Path) -> Series:
    found = open_series(file)
    assert found is not None
    return found


def test_rows_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = tmp_path / "series.bin"
    rows = np.arange(12.0).reshape(4, 3)
    with SeriesWriter(file, COLUMNS) as writer:
        assert len(opened(file)) == 0
        writer.add(rows[:1])
        writer.add(rows[1:])
        assert writer.rows == 4
        found = opened(file)
    assert found.columns == COLUMNS
    assert np.array_equal(found.values, rows)


@every_case("cut", range(1, 24))
def test_a_row_that_is_not_whole_is_not_there_yet(tmp_path: Path, cut: int) -> None:
    file = tmp_path / "series.bin"
    with SeriesWriter(file, COLUMNS) as writer:
        writer.add(np.ones((2, 3)))
    whole = file.read_bytes()
    file.write_bytes(whole[:-cut])
    assert len(opened(file)) == 1
    assert np.array_equal(opened(file).values, np.ones((1, 3)))


def test_a_file_without_its_head_is_nothing_yet(tmp_path: Path) -> None:
    file = tmp_path / "series.bin"
    assert open_series(file) is None
    head = json.dumps(COLUMNS)
    for text in ("", head[:5], head):
        file.write_text(text)
        assert open_series(file) is None
    file.write_text(f"{head}\n")
    assert len(opened(file)) == 0


def test_a_series_stays_as_long_as_it_was_opened_while_the_file_grows(tmp_path: Path) -> None:
    file = tmp_path / "series.bin"
    with SeriesWriter(file, COLUMNS) as writer:
        writer.add(np.ones((2, 3)))
        early = opened(file)
        writer.add(2.0 * np.ones((50, 3)))
        assert len(early) == 2
        assert np.array_equal(early.values, np.ones((2, 3)))
        assert len(opened(file)) == 52


AGAIN = """
import sys
from pathlib import Path
import numpy as np
from service.live.series import SeriesWriter, open_series
file = Path(sys.argv[1])
with SeriesWriter(file, ["time_s", "a"]) as writer:
    writer.add(np.ones((100_000, 2)))
early = open_series(file)
with SeriesWriter(file, ["time_s", "a"]) as writer:
    print(int(early.values.sum()), len(open_series(file)))
"""


def test_another_attempt_takes_no_rows_from_under_a_reader(tmp_path: Path) -> None:
    """A file that is cut short while it is mapped ends the process that reads it: SIGBUS."""
    words = [sys.executable, "-c", AGAIN, str(tmp_path / "series.bin")]
    found = run(words, capture_output=True, text=True, timeout=120.0, check=False)
    assert (found.returncode, found.stdout) == (0, "200000 0\n")


@given(Values, st.integers(1, 70))
def test_a_window_keeps_least_and_greatest(values: Floats, points: int) -> None:
    found = window(series_of(values), ["a", "b"], points=points)
    assert found.rows == len(values)
    assert len(found.time) == min(points, len(values))
    assert found.is_reduced == (points < len(values))
    for place in (0, 1):
        known = values[~np.isnan(values[:, place]), place]
        low, high = found.low[:, place], found.high[:, place]
        assert np.isnan(low).all() == (len(known) == 0)
        if len(known):
            assert np.nanmin(low) == known.min()
            assert np.nanmax(high) == known.max()


@given(Values, st.integers(1, 70))
def test_a_point_stands_for_its_rows_and_every_row_has_one(values: Floats, points: int) -> None:
    found = window(series_of(values), ["a"], points=points)
    assert found.time[0] == 0.0
    assert found.end[-1] == len(values) - 1
    assert np.array_equal(found.time[1:], found.end[:-1] + 1.0)
    for begin, end, low, mean, high in zip(
        found.time, found.end, found.low, found.mean, found.high, strict=True
    ):
        part = values[int(begin) : int(end) + 1, 0]
        known = part[~np.isnan(part)]
        if len(known) == 0:
            assert np.isnan([low[0], mean[0], high[0]]).all()
        else:
            assert (low[0], high[0]) == (known.min(), known.max())
            assert mean[0] == pytest.approx(known.mean(), rel=1e-9, abs=1e-6)


@given(Values, st.floats(-5.0, 65.0), st.floats(-5.0, 65.0))
def test_a_range_holds_both_its_ends(values: Floats, one: float, other: float) -> None:
    begin, end = sorted((one, other))
    found = window(series_of(values), ["a"], begin=begin, end=end, points=1000)
    wanted = [time for time in range(len(values)) if begin <= time <= end]
    assert found.time.tolist() == wanted


@given(Values, st.integers(1, 70), st.integers(1, 9))
def test_a_window_is_the_same_however_few_rows_are_read_at_once(
    values: Floats, points: int, rows: int
) -> None:
    whole = window(series_of(values), ["b", "a"], points=points)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(series, "BLOCK", rows * 2 * series.BYTES)
        pieces = window(series_of(values), ["b", "a"], points=points)
    for name in ("time", "end", "low", "high"):
        assert np.array_equal(getattr(pieces, name), getattr(whole, name), equal_nan=True)
    assert pieces.mean == pytest.approx(whole.mean, rel=1e-9, abs=1e-6, nan_ok=True)
    assert pieces.rows == whole.rows


def test_a_file_has_so_many_rows_at_most_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(series, "MOST_BYTES", 5 * 3 * series.BYTES)
    file = tmp_path / "series.bin"
    with SeriesWriter(file, COLUMNS) as writer:
        writer.add(np.ones((3, 3)))
        writer.add(np.ones((2, 3)))
        assert not writer.is_full
        for _ in range(2):
            writer.add(np.ones((2, 3)))
            assert writer.is_full
        assert writer.rows == len(opened(file)) == 5


ON_FULL_DISK = """
from pathlib import Path
import numpy as np
from service.errors import StorageFull
from service.live.series import SeriesWriter, open_series
file = Path(sys.argv[1])
with SeriesWriter(file, ["time_s", "a"]) as writer:
    writer.add(np.ones((60, 2)))
    try:
        writer.add(np.ones((60, 2)))
    except StorageFull as error:
        print(error, len(open_series(file)))
"""


def test_rows_for_which_there_is_no_room_are_refused(tmp_path: Path) -> None:
    told = within_room(ON_FULL_DISK, tmp_path / "series.bin", room=1500)
    assert told == "series.bin: File too large 92\n"


def test_a_range_of_nothing_is_empty() -> None:
    found = window(series_of(np.ones((3, 2))), ["a"], begin=10.0)
    assert (found.rows, found.time.tolist(), found.low.shape) == (0, [], (0, 1))
    empty = Series(columns=COLUMNS, values=np.empty((0, 3)))
    assert window(empty, ["b"]).rows == 0


def test_a_signal_that_is_not_there_is_named() -> None:
    with pytest.raises(NotFound, match="there is no signal 'c'"):
        window(series_of(np.ones((3, 2))), ["a", "c"])


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.floats(0.0, 100.0), max_size=30).map(sorted), st.floats(-1.0, 101.0))
def test_the_first_row_at_or_after_a_time(times: list[float], at: float) -> None:
    rows = np.column_stack([times, times, times]) if times else np.empty((0, 3))
    found = first_at(Series(columns=COLUMNS, values=rows), at)
    assert all(time < at for time in times[:found])
    assert all(time >= at for time in times[found:])
