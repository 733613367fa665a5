"""A simulated run while it runs: rows whose names tell the unit, a status, a pace."""

from pathlib import Path

import numpy as np
import pytest

from service.live.journal import LiveFolder
from service.live.series import open_series
from service.simulation import live
from service.simulation.live import COLUMNS, LiveSamples
from simulator.errors import SimulationError
from tests.service.conftest import SampleMaker


def test_rows_are_in_the_units_of_their_names(tmp_path: Path, samples_at: SampleMaker) -> None:
    folder, paced = LiveFolder(path=tmp_path), list[float]()
    watcher = LiveSamples(folder, paced.append)
    with watcher.writer:
        watcher.begin(["MILL <SLOT>"])
        watcher.add(samples_at(np.array([0.0, 0.5]), np.array([100.0, 950.0])))
        watcher.add(samples_at(np.array([]), np.array([])))
        watcher.add(samples_at(np.array([1.0]), np.array([0.0])))
    series = open_series(folder.series)
    assert series is not None
    assert series.columns == tuple(COLUMNS)
    assert paced == [0.5, 1.0]
    shown = dict(zip(COLUMNS, series.values[1], strict=True))
    assert (shown["time_s"], shown["x_mm"], shown["z_mm"]) == (0.5, 1.0, 3.0)
    # 5 mm/s, |(3, 4, 0)| mm/s, 20 rev/s, 95 mm³/s
    assert shown["feed_programmed_mm_min"] == pytest.approx(300.0)
    assert shown["feed_actual_mm_min"] == pytest.approx(300.0)
    assert shown["spindle_speed_rpm"] == pytest.approx(1200.0)
    assert shown["removal_rate_cm3_min"] == pytest.approx(5.7)
    assert (shown["cutting_force_n"], shown["spindle_power_w"]) == (950.0, 2000.0)
    assert (shown["overload"], shown["workingstep"]) == (1.0, 1.0)
    assert np.array_equal(series.values[:, 0], [0.0, 0.5, 1.0])


def test_the_status_names_the_workingstep(tmp_path: Path, samples_at: SampleMaker) -> None:
    folder, names = LiveFolder(path=tmp_path), ["FIRST"]
    watcher = LiveSamples(folder, lambda _: None)
    with watcher.writer:
        watcher.begin(names)
        names.append("SECOND")
        assert folder.read_status() is None
        watcher.add(samples_at(np.array([2.0]), np.array([1.0])))
    assert folder.read_status() == {
        "time_s": 2.0,
        "workingstep": "FIRST",
        "workingsteps": ["FIRST", "SECOND"],
        "is_series_full": False,
    }


def test_samples_that_no_disk_bears_are_refused(
    tmp_path: Path, samples_at: SampleMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "MOST_SAMPLES", 3)
    watcher = LiveSamples(LiveFolder(path=tmp_path), lambda _: None)
    two = samples_at(np.array([5.0, 6.0]), np.array([1.0, 1.0]))
    with watcher.writer:
        watcher.begin(["FIRST"])
        watcher.add(two)
        with pytest.raises(SimulationError, match="more than 3 samples until 5 s"):
            watcher.add(two)
