"""The jobs ``evaluation`` and ``review``: tables in all forms, proposals in the store."""

import csv
import json

from pyarrow import parquet

from service.depot import jobs
from service.depot.jobs import Job, Kind, Order, State
from service.jobs.evaluate import TABLE
from service.jobs.task import REPORT, RESULT
from service.knowledge import verbs
from service.rest.bodies import EvaluationBody, ReviewBody
from tests.service.jobs.conftest import Shop


def ran(shop: Shop, kind: Kind, words: dict[str, object]) -> Job:
    order = Order(kind=kind, request=words, owner="Anna")
    return shop.over(jobs.add(shop.depot, order).id)


def test_an_evaluation_is_a_table_in_all_forms(shop: Shop) -> None:
    job = ran(shop, Kind.EVALUATION, EvaluationBody().words())
    assert job.state is State.SUCCEEDED, job.problem
    folder = shop.depot.job_folder(job.id)
    result = json.loads((folder / RESULT).read_bytes())
    assert result["place"] == "knowledge base of this service"
    with (folder / f"{TABLE}.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(lines) == parquet.read_table(folder / f"{TABLE}.parquet").num_rows
    assert len(lines) >= len(result["rows"]) > 0
    assert (folder / REPORT).stat().st_size > 1000
    for left in folder.iterdir():
        assert str(shop.depot.root.parent).encode() not in left.read_bytes(), left.name


def test_an_evaluation_of_nothing_is_empty(shop: Shop) -> None:
    words = EvaluationBody.model_validate({
        "machine": "nobody's", "since": "2001-01-01T00:00:00Z", "until": "2001-01-02T00:00:00Z",
    }).words()  # fmt: skip
    job = ran(shop, Kind.EVALUATION, words)
    assert job.state is State.SUCCEEDED, job.problem
    result = json.loads((shop.depot.job_folder(job.id) / RESULT).read_bytes())
    assert result["rows"] == []


def test_a_review_proposes_in_the_name_of_who_asked(shop: Shop) -> None:
    job = ran(shop, Kind.REVIEW, ReviewBody().words())
    assert job.state is State.SUCCEEDED, job.problem
    result = json.loads((shop.depot.job_folder(job.id) / RESULT).read_bytes())
    assert result
    assert len(verbs.corrections(shop.depot.knowledge)) > 0
