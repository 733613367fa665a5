"""``/v1/evaluations``, ``/v1/reviews``, ``/v1/corrections``, ``/v1/outcomes``: learning."""

import json
from collections.abc import Callable, Sequence
from datetime import datetime
from enum import StrEnum
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from kbe.ledger import StoredCorrection
from kbe.rows import utc
from kbe.selection import Selection
from service.errors import NotFound, Unreadable
from service.jobs.evaluate import TABLE
from service.jobs.task import REPORT
from service.knowledge import verbs
from service.knowledge.output import corrections_json, listing_json, run_json
from service.requests.fields import dumped
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.rest.bodies import DecisionBody, Id
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    data_folder_of,
    page_reply,
    queued,
)
from service.rest.replies import file_reply, json_reply, report_reply
from service.rest.results import result_reply
from service.rest.views import JobView, PageView, job_view
from service.storage import jobs
from service.storage.jobs import JobKind, JobRequest

EVALUATIONS = APIRouter(prefix="/v1/evaluations", tags=["knowledge"])
REVIEWS = APIRouter(prefix="/v1/reviews", tags=["knowledge"])
CORRECTIONS = APIRouter(prefix="/v1/corrections", tags=["knowledge"])
OUTCOMES = APIRouter(prefix="/v1/outcomes", tags=["knowledge"])

MOST_NUMBER = 2**31 - 1

Number = Annotated[int, Path(ge=1, le=MOST_NUMBER, description="of the correction")]
Word = Annotated[str | None, Query(max_length=200)]
Since = Annotated[datetime | None, Query(description="first moment that counts, with zone")]
Until = Annotated[
    datetime | None, Query(description="first moment that counts no more, with zone")
]


class TableFormat(StrEnum):
    """Forms of a table for other programs."""

    CSV = "csv"
    PARQUET = "parquet"


KINDS = {
    TableFormat.CSV: "text/csv; charset=utf-8",
    TableFormat.PARQUET: "application/vnd.apache.parquet",
}


@EVALUATIONS.post("", status_code=202, response_model=JobView, summary="Make a table")
async def ask_evaluation(
    request: Request, body: EvaluationRequest, owner: ByOwner, key: IdempotencyHeader = None
) -> Response:
    """A job: what was planned against what it was, feature by feature."""
    _require_moments(since=body.since, until=body.until)
    order = JobRequest(kind=JobKind.EVALUATION, request=dumped(body), owner=owner)
    return await queued(request, order, key)


@EVALUATIONS.get("", response_model=PageView[JobView], summary="List tables, newest first")
async def list_evaluations(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """A page of their jobs."""
    page = jobs.listed(data_folder, cursor, kind=JobKind.EVALUATION)
    return page_reply(request, page, [job_view(job) for job in page.items])


@EVALUATIONS.get("/{id}", summary="A table")
async def evaluation(request: Request, id: Id) -> Response:
    """Rows with their roughing and finishing sides, grades and remarks."""
    return await result_reply(request, id, JobKind.EVALUATION)


@EVALUATIONS.get(
    "/{id}/table",
    summary="A table as a file",
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in KINDS.values()}}},
)
async def evaluation_file(
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    form: Annotated[TableFormat, Query(description="of the file")] = TableFormat.CSV,
) -> Response:
    """A line for each side of a row."""
    jobs.get(data_folder, id, JobKind.EVALUATION)
    file, name = (
        data_folder.job_folder(id) / f"{TABLE}.{form.value}",
        f"evaluation-{id}.{form.value}",
    )
    return file_reply(request, file, name=name, kind=KINDS[form], thing="table")


@EVALUATIONS.get("/{id}/report", summary="A table as a page", response_class=Response,
                 responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def evaluation_report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """A page that stands for itself."""
    jobs.get(data_folder, id, JobKind.EVALUATION)
    return report_reply(request, data_folder.job_folder(id) / REPORT, id=id)


@REVIEWS.post("", status_code=202, response_model=JobView, summary="Learn from outcomes")
async def ask_review(
    request: Request, body: ReviewRequest, owner: ByOwner, key: IdempotencyHeader = None
) -> Response:
    """A job: it proposes corrections; a person accepts them."""
    _require_moments(since=body.since, until=body.until)
    order = JobRequest(kind=JobKind.REVIEW, request=dumped(body), owner=owner)
    return await queued(request, order, key)


@REVIEWS.get("/{id}", summary="What a review found")
async def review(request: Request, id: Id) -> Response:
    """Context by context: the factor on k_c, what speaks against it, what was done."""
    return await result_reply(request, id, JobKind.REVIEW)


@CORRECTIONS.get("", summary="All corrections, with what was decided last")
async def corrections(request: Request, data_folder: InDataFolder) -> Response:
    """In the order of their proposal."""
    return await _corrections(request, lambda: verbs.corrections(data_folder.knowledge))


@CORRECTIONS.post("/{number}/accept", summary="Put a correction in force")
async def accept(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """In the name of a person; the next plan takes it."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.accept(place, [number], by=body.by))


@CORRECTIONS.post("/{number}/withdraw", summary="Take a correction out of force")
async def withdraw(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """Or refuse what is proposed."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.withdraw(place, [number], by=body.by))


def _require_moments(**times: datetime | None) -> None:
    """Refuse a moment that no clock shows, before a job meets it.

    Raises
    ------
    Unreadable
        When it has no zone, or lies beyond the years that there are.
    """
    for name, time in times.items():
        try:
            if time is not None:
                utc(name, time)
        except (ValueError, OverflowError) as error:
            raise Unreadable(str(error)) from error


async def _corrections(
    request: Request, work: Callable[[], Sequence[StoredCorrection]]
) -> Response:
    try:
        entries = await run_in_threadpool(work)
    except ValueError as error:
        # A name that is none, or cannot be stored.
        raise Unreadable(str(error)) from error
    return json_reply(request, corrections_json(entries).encode())


@OUTCOMES.get("", summary="Outcomes, newest first")
async def outcomes(  # noqa: PLR0913 (each is a parameter of the request)
    request: Request,
    *,
    machine: Word = None,
    material: Word = None,
    tool: Word = None,
    feature_kind: Word = None,
    program: Word = None,
    since: Since = None,
    until: Until = None,
    limit: Annotated[int, Query(ge=1, le=2000)] = 200,
) -> Response:
    """Outcomes of runs, workingstep by workingstep; canonical units, as in exports."""
    _require_moments(since=since, until=until)
    selection = Selection(
        machine=machine, material=material, tool=tool, feature_kind=feature_kind,
        program=program, since=since, until=until,
    )  # fmt: skip
    place = data_folder_of(request).knowledge
    listing = await run_in_threadpool(verbs.newest, place, selection, limit=limit)
    return json_reply(request, listing_json(listing).encode())


@OUTCOMES.get("/runs/{run}", summary="The outcomes of one run")
async def run_outcomes(
    request: Request, data_folder: InDataFolder, run: Annotated[str, Path(max_length=200)]
) -> Response:
    """With their deviations."""
    found = await run_in_threadpool(verbs.outcomes_of_run, data_folder.knowledge, run)
    if not found:
        raise NotFound("run", run)
    return json_reply(request, run_json(found).encode())


@OUTCOMES.get("/contexts", summary="Machines, materials and tools of which something is known")
async def contexts(request: Request, data_folder: InDataFolder) -> Response:
    """For filters."""
    found = await run_in_threadpool(verbs.contexts, data_folder.knowledge)
    known = [{"machine": each.machine, "material": each.material, "tool": each.tool}
             for each in found]  # fmt: skip
    return json_reply(request, json.dumps({"contexts": known}).encode())
