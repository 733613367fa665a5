"""The jobs ``trial`` and ``control-run``: steered while they go on, kept when they are over."""

import json

from kbe.queries import EVERYTHING
from service.knowledge import verbs
from service.live.journal import LiveFolder, append, read_on
from service.live.series import open_series
from service.storage.jobs import JobKind, JobState
from service.storage.results import REPORT, RESULT, SAMPLES
from tests.service.jobs.conftest import Shop
from tests.service.waiting import until


def test_a_trial_takes_changes_refuses_others_and_ends(shop: Shop) -> None:
    id = shop.order(JobKind.TRIAL, pace=20.0).id
    shop.runs(id)
    folder = LiveFolder(path=shop.data_folder.job_folder(id))
    append(folder.orders, {"axial_depth_mm": 3.0, "pace": 100.0})
    append(folder.orders, {"axial_depth_mm": -3.0})

    def is_obeyed() -> bool:
        # Written after the first rows.
        if (status := folder.read_status()) is None:
            return False
        return bool(status["inputs"]["axial_depth_mm"] == 3.0 and status["pace"] == 100.0)

    until(is_obeyed)
    until(lambda: any(line["kind"] == "refused" for line in read_on(folder.events, 0).lines))
    append(folder.orders, {"end": True})
    job = shop.over(id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    result = json.loads((folder.path / RESULT).read_bytes())
    assert result["status"]["inputs"]["axial_depth_mm"] == 3.0
    series = open_series(folder.series)
    assert series is not None
    assert series.values[-1, 0] <= result["status"]["time_s"] + 1e-9


def test_an_input_beyond_its_bounds_is_a_problem(shop: Shop) -> None:
    job = shop.over(shop.order(JobKind.TRIAL, inputs={"teeth": 1000}).id)
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["status"] == 422


def test_a_control_run_keeps_its_outcomes_its_samples_and_a_report(shop: Shop) -> None:
    before = verbs.newest(shop.data_folder.knowledge, EVERYTHING, limit=2000)
    id = shop.order(JobKind.CONTROL, machine="vmc15", pace=0.0, disturbances=["kc:1.2"]).id
    job = shop.over(id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(id)
    assert {RESULT, REPORT, SAMPLES, "series.bin"} <= {each.name for each in folder.iterdir()}
    found = verbs.newest(shop.data_folder.knowledge, EVERYTHING, limit=2000)
    fresh = [each for each in found.outcomes if each not in before.outcomes]
    assert fresh
    assert {each.trace for each in fresh} == {f"/v1/control-runs/{id}/samples"}
    assert all("virtual machine" in each.recorded_by for each in fresh)
    status = LiveFolder(path=folder).read_status()
    assert status is not None
    assert status["is_done"]


def test_a_run_that_is_not_to_be_recorded_is_not(shop: Shop) -> None:
    before = verbs.newest(shop.data_folder.knowledge, EVERYTHING, limit=2000)
    job = shop.over(shop.order(JobKind.CONTROL, pace=0.0, is_recorded=False).id)
    assert job.state is JobState.SUCCEEDED, job.problem
    assert verbs.newest(shop.data_folder.knowledge, EVERYTHING, limit=2000) == before
