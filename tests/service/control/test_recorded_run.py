"""Outcomes of recorded runs: from a file, and from a file that went over MTConnect."""

from dataclasses import fields
from datetime import UTC, datetime
from math import log
from pathlib import Path
from typing import Any

import pytest

from extras.agent.model.machine_model import machine_model
from extras.agent.replay import read_log
from extras.agent.requests import AgentRequest
from kbe.store import open_store
from service.control.outcomes import RecordingContext, outcomes_of
from service.control.record import control_recorded
from service.control.run import ControlRun, control
from service.recording.request import RecordingRequest
from service.recording.run import record
from service.requests.runs import ControlRequest, SensorChoice, SimulationRequest
from service.simulation.run import RunFiles, simulate
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import ProcessOutcome
from tests.extras.agent.test_run import PARTS, served

PART = PARTS / "paper003_case1.stpnc"
WORDS: dict[str, Any] = {"machine": "vmc15", "material": "c45"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recorded")


@pytest.fixture(scope="module")
def direct(folder: Path) -> ControlRun:
    """The real machine: harder material, under control, and written to a file."""
    request = ControlRequest(**WORDS, disturbances=("kc:1.3",))
    return control(request, RunFiles(file=PART, output=folder / "run.parquet"))


def outcome(run: ControlRun, when: RecordingContext) -> ProcessOutcome:
    (found,) = outcomes_of(run, when)
    return found


@pytest.fixture
def when() -> RecordingContext:

    return RecordingContext(run="r", at=datetime(2026, 1, 1, tzinfo=UTC), by="me")


def test_an_outcome_over_http_is_that_of_the_run(
    folder: Path, direct: ControlRun, when: RecordingContext
) -> None:
    model = machine_model(load_machine("vmc15")).model
    run = read_log(folder / "run.parquet", model, tell=lambda _: None)
    with served(AgentRequest(machine="vmc15", speed=0.0), run) as url:
        record(
            f"{url}/vmc15",
            folder / "http.parquet",
            RecordingRequest(is_buffered=True, duration_s=3.0),
        )
    files = [folder / "run.parquet", folder / "http.parquet"]
    near, far = (
        outcome(control(ControlRequest(**WORDS), RunFiles(file=PART, recorded=each)), when)
        for each in files
    )
    true = outcome(direct, when)
    for field in fields(ProcessOutcome):
        one, other = getattr(near, field.name), getattr(far, field.name)
        if field.name in {"time", "force", "feed", "feed_per_tooth"}:
            assert other.measured == pytest.approx(one.measured, rel=1e-3), field.name
            assert one.measured == pytest.approx(
                getattr(true, field.name).measured, rel=5e-3
            ), field.name
            assert other.predicted == one.predicted
        elif field.name == "force_ratio":
            for each in (near.force_ratio, far.force_ratio):
                assert each is not None
                assert true.force_ratio is not None
                assert each.log_mean == pytest.approx(true.force_ratio.log_mean, abs=0.003)
        elif field.name != "roughness":
            assert other == one, field.name
    assert near.roughness.measured is far.roughness.measured is None


TOLERANCES = {
    SensorChoice.DYNAMOMETER: 0.002,
    SensorChoice.COMPONENTS: 0.002,
    SensorChoice.POWER: 0.02,
}
"""Of ln k_c: the idle power of the drive is an estimate."""


@pytest.mark.parametrize("sensor", list(SensorChoice))
def test_a_slow_recording_tells_the_same_material(
    folder: Path, when: RecordingContext, sensor: SensorChoice
) -> None:
    file = folder / "slow.csv"
    simulate(
        SimulationRequest(**WORDS, rate_hz=5.0, kc_factor=1.3), RunFiles(file=PART, output=file)
    )
    run = control(ControlRequest(**WORDS, sensor=sensor), RunFiles(file=PART, recorded=file))
    found = outcome(run, when)
    assert found.force_ratio is not None
    assert found.force_ratio.log_mean == pytest.approx(log(1.3), abs=TOLERANCES[sensor])
    assert found.time.measured == pytest.approx(found.time.predicted, abs=0.5)
    assert run.law.value == "none"
    assert run.recorded == "slow.csv"


def test_outcomes_of_a_recording_are_kept_as_such(
    folder: Path, direct: ControlRun, tmp_path: Path
) -> None:
    place = tmp_path / "shop.db"
    file = folder / "run.parquet"
    control_recorded(
        ControlRequest(**WORDS),
        RunFiles(file=PART, recorded=file),
        knowledge=str(place),
        by="A. Smith",
    )
    with open_store(str(place)) as store:
        (found,) = store.outcomes()
    assert found.recorded_by == "A. Smith, recorded run"
    assert found.trace == str(file.resolve())
    assert direct.samples > 1000


def test_a_recording_is_neither_disturbed_nor_replaced(
    folder: Path, direct: ControlRun
) -> None:
    file = folder / "run.parquet"
    with pytest.raises(StepNcError, match="a recorded run is over; it cannot be disturbed"):
        control(
            ControlRequest(**WORDS, disturbances=("kc:1.3",)),
            RunFiles(file=PART, recorded=file),
        )
    before = file.read_bytes()
    with pytest.raises(StepNcError):
        control_recorded(
            ControlRequest(**WORDS), RunFiles(file=PART, recorded=file, output=file)
        )
    assert file.read_bytes() == before
    assert direct.recorded == ""
