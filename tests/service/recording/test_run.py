"""Recording of a machine: of our own agent, over HTTP."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pyarrow import csv, parquet

import stepnc
from extras.calibration.model.features import Parameter
from extras.calibration.verbs.calibrate.result import CalibrationResult
from service.recording.request import RecordingRequest
from service.recording.run import record
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from stepnc_model.errors import StepNcError
from tests.extras.agent.model.conftest import BEGIN, ServedAgent
from tests.extras.agent.test_run import PARTS, run_of, served

WHOLE = RecordingRequest(is_buffered=True, is_until_completed=True)


def test_a_recorded_run_is_the_simulated_one(tmp_path: Path) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    with served(request, run) as url:
        found = record(f"{url}/paper003", tmp_path / "run.parquet", WHOLE)
    assert (found.lost, found.restarts, found.faults) == (0, 0, 0)
    table = parquet.read_table(tmp_path / "run.parquet").to_pydict()
    simulated = tmp_path / "simulated.parquet"
    part = PARTS / "paper003_case1.stpnc"
    simulate(
        SimulationRequest(machine="paper003", rate_hz=10.0),
        RunFiles(file=part, output=simulated),
    )
    truth = parquet.read_table(simulated).to_pydict()
    assert found.rows == len(table["time_s"]) == len(truth["time_s"])
    for name in ("time_s", "x_axis_position_actual", "c_axis_wattage", "electric_wattage",
                 "load_wattage", "cutting_force", "rotary_velocity_actual"):  # fmt: skip
        assert np.allclose(table[name], truth[name], rtol=1e-4, atol=6e-3), name
    for name in ("execution", "workingstep", "program"):
        assert table[name] == truth[name], name


def test_a_recorded_run_calibrates_a_machine(tmp_path: Path) -> None:
    request, run = run_of("paper003_case1", "paper003", speed=0.0, rate_hz=10.0)
    with served(request, run) as url:
        record(f"{url}/paper003", tmp_path / "run.csv", WHOLE)
    result = stepnc.calibrate(
        tmp_path / "run.csv", file=PARTS / "paper003_case1.stpnc", machine="paper003"
    )
    assert isinstance(result, CalibrationResult)
    estimates = result.calibration.estimates
    base = next(each for each in estimates if each.parameter is Parameter.BASE)
    assert base.value == pytest.approx(370.0, abs=1.0)


def test_a_recording_ends_when_its_time_is_over(tmp_path: Path) -> None:
    request, run = run_of("paper000", "paper000", speed=5.0)
    with served(request, run) as url:
        found = record(url, tmp_path / "run.csv", RecordingRequest(duration_s=0.5))
    assert 0 < found.rows < 200
    assert csv.read_csv(tmp_path / "run.csv").num_rows == found.rows


def test_what_cannot_be_recorded_is_told(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"127\.0\.0\.1:9"):
        record("http://127.0.0.1:9", tmp_path / "run.csv", RecordingRequest())
    with pytest.raises(StepNcError, match=r"\.parquet or \.csv"):
        record("http://127.0.0.1:9", tmp_path / "run.txt", RecordingRequest())
    with pytest.raises(StepNcError, match="duration -1 s"):
        record("http://x", tmp_path / "run.csv", RecordingRequest(duration_s=-1.0))
    assert not list(tmp_path.iterdir())


def test_the_next_run_is_recorded_whole(
    serve: Callable[..., ServedAgent], tmp_path: Path
) -> None:
    served = serve()
    words = (
        # In the middle of a run, with a lost adapter; a whole run with a hold; another one.
        "ACTIVE", None, "ACTIVE", "PROGRAM_COMPLETED", "READY",
        "WAIT", "ACTIVE", "FEED_HOLD", "ACTIVE", "PROGRAM_COMPLETED", "READY", "ACTIVE",
    )  # fmt: skip
    for number, word in enumerate(words):
        begin = BEGIN + 1_000_000 * number
        served.add("vmc15_exec", [word], begin=begin)
        served.add("vmc15_xpos", [float(number)], begin=begin)
    found = record(
        served.url,
        tmp_path / "run.parquet",
        RecordingRequest(is_next_run=True, is_buffered=True, duration_s=20.0),
    )
    table = parquet.read_table(tmp_path / "run.parquet").to_pydict()
    assert table["x_axis_position_actual"] == [5.0, 6.0, 7.0, 8.0, 9.0]
    assert table["execution"] == list(words[5:10])
    assert found.rows == 5
