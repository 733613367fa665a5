"""The jobs ``evaluation`` and ``review``: tables in all forms, proposals in the store."""

import csv
import json
from datetime import UTC, datetime, timedelta

from pyarrow import parquet

from service.knowledge import verbs
from service.requests.fields import dumped
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.storage import jobs
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from service.storage.results import REPORT, RESULT, TABLE
from tests.service.jobs.conftest import Shop


def ran(shop: Shop, kind: JobKind, words: dict[str, object]) -> Job:
    order = JobRequest(kind=kind, request=words, owner="Anna")
    return shop.over(jobs.add(shop.data_folder, order).id)


def test_an_evaluation_is_a_table_in_all_forms(shop: Shop) -> None:
    job = ran(shop, JobKind.EVALUATION, dumped(EvaluationRequest()))
    assert job.state is JobState.SUCCEEDED, job.problem
    folder = shop.data_folder.job_folder(job.id)
    result = json.loads((folder / RESULT).read_bytes())
    assert result["place"] == "knowledge base of this service"
    with (folder / f"{TABLE}.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(lines) == parquet.read_table(folder / f"{TABLE}.parquet").num_rows
    assert len(lines) >= len(result["rows"]) > 0
    assert (folder / REPORT).stat().st_size > 1000
    for left in folder.iterdir():
        assert str(shop.data_folder.root.parent).encode() not in left.read_bytes(), left.name


def test_an_evaluation_of_nothing_is_empty(shop: Shop) -> None:
    since = datetime(2001, 1, 1, tzinfo=UTC)
    request = EvaluationRequest(
        machine="nobody's", since=since, until=since + timedelta(days=1)
    )
    job = ran(shop, JobKind.EVALUATION, dumped(request))
    assert job.state is JobState.SUCCEEDED, job.problem
    result = json.loads((shop.data_folder.job_folder(job.id) / RESULT).read_bytes())
    assert result["rows"] == []


def test_a_review_proposes_in_the_name_of_who_asked(shop: Shop) -> None:
    job = ran(shop, JobKind.REVIEW, dumped(ReviewRequest()))
    assert job.state is JobState.SUCCEEDED, job.problem
    result = json.loads((shop.data_folder.job_folder(job.id) / RESULT).read_bytes())
    assert result
    assert len(verbs.corrections(shop.data_folder.knowledge)) > 0
