"""Jobs ``factory``, in the process of a runner."""

import json

from extras.factory.requests import FactoryOrder
from extras.factory.shop_job import FIGURES, TABLES
from service.live.journal import append
from service.requests.fields import dumped
from service.storage import jobs
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from tests.extras.factory.shops import TIMED
from tests.service.jobs.conftest import Shop
from tests.service.waiting import ended, until


def ordered(shop: Shop, **words: object) -> Job:
    order = FactoryOrder(shop=TIMED.format(hours=2), **words)  # type: ignore[arg-type]
    request = JobRequest(kind=JobKind.FACTORY, request=dumped(order), owner="anna")
    return jobs.add(shop.data_folder, request)


def test_a_shop_leaves_tables_report_and_result(shop: Shop) -> None:
    job = shop.over(ordered(shop, replications=2).id)
    assert job.state is JobState.SUCCEEDED, job.problem
    folder = shop.data_folder.job_folder(job.id)
    assert {file.name for file in (folder / TABLES).iterdir()} == {
        "saw 1.csv", "mill-1.csv", "mill-2.csv", "states.parquet",
    }  # fmt: skip
    assert (folder / "report.html").is_file()
    assert (folder / FIGURES).is_file()
    assert json.loads((folder / "result.json").read_text())["replications"] == 2


def test_a_live_shop_that_is_ended_at_once_has_a_result(shop: Shop) -> None:
    job = ordered(shop, pace=1000.0)
    folder = shop.data_folder.job_folder(job.id)
    folder.mkdir(exist_ok=True)
    append(folder / "orders.jsonl", {"machine": "saw 1", "repair_min": 1.0})
    found = shop.over(job.id)
    assert found.state is JobState.SUCCEEDED, found.problem
    states = json.loads((folder / "result.json").read_text())["states"]
    (repair,) = [row for row in states if row["state"] == "repair"]
    assert repair["hours"] == 1.0 / 60.0


def test_a_live_shop_ended_within_its_warm_up_says_so(shop: Shop) -> None:
    job = ordered(shop, pace=1.0, warm_up_hours=1.0)
    folder = shop.data_folder.job_folder(job.id)
    until((folder / "status.json").exists)
    append(folder / "orders.jsonl", {"end": True})
    found = shop.over(job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert "before its warm-up" in found.problem["detail"]


def test_a_live_shop_is_not_run_twice(own_shop: Shop) -> None:
    shop = own_shop
    runner = shop.start()
    job = ordered(shop, pace=1.0)
    until(lambda: shop.job(job.id).state is JobState.RUNNING)
    runner.kill()
    ended(runner)
    shop.start()
    found = shop.over(job.id)
    assert found.state is JobState.FAILED
    assert found.problem is not None
    assert "cannot be resumed" in found.problem["detail"]
