"""Orders of jobs: what a request names is looked up, and what cannot be done is refused."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from extras.verification.rest import verifiable
from service.errors import Conflict, NotFound, Unreadable
from service.ids import new_id
from service.monitor.monitor import MonitorSet
from service.rest.orders import (
    agent_url,
    nothing,
    order,
    require_moments,
    runnable,
    selectable,
    startable,
    timeable,
)
from service.storage import jobs, programs
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import JobKind, JobRequest, JobState
from stepnc_model.errors import StepNcError

ANNA = "anna"

TRIAL = JobRequest(kind=JobKind.TRIAL, request={"inputs": {}}, owner=ANNA)


@pytest.fixture
def data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[DataFolder]:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    made = open_data_folder(tmp_path / "data")
    yield made
    made.database.close()


def ran(data_folder: DataFolder, **words: object) -> str:
    """Id of a simulation that has succeeded, of a program."""
    program = programs.add(data_folder, b"x", name="part.stp", owner=ANNA).id
    asked = JobRequest(kind=JobKind.SIMULATION, request=words, program=program, owner=ANNA)
    jobs.add(data_folder, asked)
    job = jobs.claim(data_folder)
    assert job is not None
    jobs.begin(data_folder, job)
    jobs.finish(data_folder, job, JobState.SUCCEEDED)
    return job.id


def test_a_request_names_one_program_and_one_log(data_folder: DataFolder) -> None:
    for words in (
        {"program_id": "a", "advice_id": "b"},
        {"log_id": "a", "run_id": "b"},
        {"run_id": "a", "monitor": "b"},
    ):
        with pytest.raises(Unreadable, match=r"name (either|only one)"):
            order(data_folder, JobKind.VERIFICATION, words, ANNA)


def test_the_program_of_a_run_is_that_of_its_log(data_folder: DataFolder) -> None:
    run = ran(data_folder, machine="vmc15", material="c45")
    words = {"run_id": run, "machine": "", "material": "al7075"}
    found = order(data_folder, JobKind.VERIFICATION, words, ANNA)
    assert found.program == jobs.get(data_folder, run).program
    assert found.request == {**words, "machine": "vmc15"}
    other = programs.add(data_folder, b"x", name="other.stp", owner=ANNA).id
    found = order(data_folder, JobKind.VERIFICATION, {**words, "program_id": other}, ANNA)
    assert (found.program, found.request["machine"]) == (other, "")


def test_a_run_that_is_not_over_is_no_log(data_folder: DataFolder) -> None:
    waiting = jobs.add(data_folder, replace(TRIAL, kind=JobKind.SIMULATION)).id
    with pytest.raises(Conflict, match="is queued"):
        order(data_folder, JobKind.CYCLE_TIME, {"run_id": waiting}, ANNA)
    trial = jobs.add(data_folder, TRIAL).id
    with pytest.raises(NotFound, match="simulation or run under control"):
        order(data_folder, JobKind.CYCLE_TIME, {"run_id": trial}, ANNA)


def test_an_advice_stands_for_its_program(data_folder: DataFolder) -> None:
    program = programs.add(data_folder, b"x", name="part.stp", owner=ANNA).id
    advice = jobs.add(
        data_folder, JobRequest(kind=JobKind.ADVICE, request={}, program=program, owner=ANNA)
    ).id
    found = order(data_folder, JobKind.SIMULATION, {"advice_id": advice}, ANNA)
    assert (found.program, found.source) == (program, advice)
    with pytest.raises(NotFound):
        order(data_folder, JobKind.SIMULATION, {"advice_id": new_id()}, ANNA)


def test_a_run_needs_a_program_and_a_verification_a_log(data_folder: DataFolder) -> None:
    bare = order(data_folder, JobKind.SIMULATION, {}, ANNA)
    for require in (runnable, timeable):
        with pytest.raises(Unreadable, match="program_id or an advice_id"):
            require(data_folder, bare)
    logless = replace(bare, request={"log_id": None, "run_id": None, "monitor": ""})
    with pytest.raises(Unreadable, match="name one of log_id"):
        verifiable(data_folder, logless)
    nothing(data_folder, bare)


def test_inputs_and_times_have_bounds(data_folder: DataFolder) -> None:
    startable(data_folder, TRIAL)
    with pytest.raises(StepNcError):
        startable(data_folder, replace(TRIAL, request={"inputs": {"teeth": 99}}))
    for times in (
        {"since": "2026-03-05T12:00:00", "until": None},
        {"since": "2026-03-05T12:00:00Z", "until": "2026-03-05T11:00:00Z"},
    ):
        with pytest.raises(Unreadable):
            selectable(data_folder, replace(TRIAL, request=times))
    now = datetime(2026, 3, 5, tzinfo=UTC)
    require_moments(since=now, until=None)
    with pytest.raises(Unreadable, match="is not before"):
        require_moments(since=now, until=now)


def test_only_a_monitored_machine_has_an_agent() -> None:
    assert agent_url(MonitorSet(()), "") == ""
    with pytest.raises(NotFound, match="monitor"):
        agent_url(MonitorSet(()), "mill")
