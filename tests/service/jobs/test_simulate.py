"""The job ``simulation``: rows to watch, then a result, samples and a report."""

import json

from pyarrow import parquet

from service.live.series import open_series
from service.storage.jobs import JobKind, JobState
from service.storage.results import REPORT, RESULT, SAMPLES
from tests.service.jobs.conftest import Shop


def test_a_simulation_leaves_rows_samples_a_result_and_a_report(shop: Shop) -> None:
    id = shop.order(JobKind.SIMULATION, machine="vmc15", rate_hz=10.0).id
    job = shop.over(id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(id)
    result = json.loads((folder / RESULT).read_bytes())
    assert (result["program"], result["machine"]) == ("paper002.stpnc", "vmc15")
    series = open_series(folder / "series.bin")
    assert series is not None
    assert len(series) == result["samples"] == parquet.read_table(folder / SAMPLES).num_rows
    assert (folder / REPORT).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    for file in (RESULT, REPORT, SAMPLES):
        assert str(shop.data_folder.root).encode() not in (folder / file).read_bytes()


def test_the_same_seed_gives_the_same_run(shop: Shop) -> None:
    ids = [shop.order(JobKind.SIMULATION, noise="normal", seed=7).id for _ in range(2)]
    found = []
    for id in ids:
        job = shop.over(id)
        assert job.state is JobState.SUCCEEDED, job.problem
        series = open_series(shop.data_folder.job_folder(id) / "series.bin")
        assert series is not None
        found.append(series.values.tobytes())
    assert found[0] == found[1]
