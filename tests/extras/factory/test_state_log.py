"""States over time from the file of their changes."""

from pathlib import Path

import numpy as np
import pytest

from extras.factory.model.states import MachineState
from extras.factory.state_log import COLUMNS, STATES, state_bars
from service.live.series import Series, SeriesWriter, open_series

IDLE, CUT = STATES.index(MachineState.IDLING), STATES.index(MachineState.MACHINING)


def series_of(folder: Path, rows: list[tuple[float, int, int]]) -> Series:
    with SeriesWriter(folder / "states.bin", COLUMNS) as writer:
        writer.add(np.array(rows, dtype=np.float64))
    found = open_series(folder / "states.bin")
    assert found is not None
    return found


def test_few_changes_are_shown_as_they_are(tmp_path: Path) -> None:
    series = series_of(tmp_path, [(0, 0, IDLE), (0, 1, IDLE), (10, 0, CUT), (25, 0, IDLE)])
    first, second = state_bars(series, 2, begin=0.0, end=40.0, bars=10)
    assert first.state == ("idling", "machining", "idling")
    assert (first.begin, first.end) == ((0.0, 10.0, 25.0), (10.0, 25.0, 40.0))
    assert (second.state, second.begin, second.end) == (("idling",), (0.0,), (40.0,))


def test_a_range_begins_with_the_state_that_holds_then(tmp_path: Path) -> None:
    series = series_of(tmp_path, [(0, 0, IDLE), (10, 0, CUT), (25, 0, IDLE)])
    (bars,) = state_bars(series, 1, begin=12.0, end=20.0, bars=10)
    assert (bars.state, bars.begin, bars.end) == (("machining",), (12.0,), (20.0,))


def test_states_without_time_are_left_out(tmp_path: Path) -> None:
    series = series_of(tmp_path, [(0, 0, IDLE), (10, 0, IDLE), (10, 0, CUT)])
    (bars,) = state_bars(series, 1, begin=0.0, end=20.0, bars=10)
    assert bars.state == ("idling", "machining")


def test_of_many_changes_the_longest_states_are_shown(tmp_path: Path) -> None:
    rows = [(float(at), 0, CUT if at % 10 else IDLE) for at in range(10_000)]
    series = series_of(tmp_path, rows)
    (bars,) = state_bars(series, 1, begin=0.0, end=10_000.0, bars=100)
    assert bars.state == ("machining",)
    assert (bars.begin[0], bars.end[-1]) == (0.0, 10_000.0)


@pytest.mark.parametrize("bars", [1, 7, 500])
def test_bars_tile_the_range(tmp_path: Path, bars: int) -> None:
    rng = np.random.default_rng(1)
    times = np.sort(rng.uniform(0.0, 1000.0, 300))
    rows = [(0.0, 0, 0), *((t, 0, int(rng.integers(len(STATES)))) for t in times.tolist())]
    (found,) = state_bars(series_of(tmp_path, rows), 1, begin=0.0, end=1000.0, bars=bars)
    assert len(found.state) <= bars
    assert found.begin[0] == 0.0
    assert found.begin[1:] == found.end[:-1]
    assert found.end[-1] == 1000.0
