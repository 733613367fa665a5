"""The job ``simulation``: rows to watch, then a result, samples and a report."""

import json

from pyarrow import parquet

from service.depot.jobs import Kind, State
from service.jobs.task import REPORT, RESULT, SAMPLES
from service.live.series import open_series
from tests.service.jobs.conftest import Shop


def test_a_simulation_leaves_rows_samples_a_result_and_a_report(shop: Shop) -> None:
    id = shop.order(Kind.SIMULATION, machine="vmc15", rate_hz=10.0).id
    job = shop.over(id)
    assert (job.state, job.problem) == (State.SUCCEEDED, None)
    folder = shop.depot.job_folder(id)
    result = json.loads((folder / RESULT).read_bytes())
    assert (result["program"], result["machine"]) == ("paper002.stpnc", "vmc15")
    series = open_series(folder / "series.bin")
    assert series is not None
    assert len(series) == result["samples"] == parquet.read_table(folder / SAMPLES).num_rows
    assert (folder / REPORT).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    for file in (RESULT, REPORT, SAMPLES):
        assert str(shop.depot.root).encode() not in (folder / file).read_bytes()


def test_the_same_seed_gives_the_same_run(shop: Shop) -> None:
    ids = [shop.order(Kind.SIMULATION, noise="normal", seed=7).id for _ in range(2)]
    found = []
    for id in ids:
        job = shop.over(id)
        assert job.state is State.SUCCEEDED, job.problem
        series = open_series(shop.depot.job_folder(id) / "series.bin")
        assert series is not None
        found.append(series.values.tobytes())
    assert found[0] == found[1]
