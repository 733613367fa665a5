"""Routes of the knowledge base: evaluations, reviews, corrections and outcomes."""

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
from service.rest.asking import answered, result_file
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

Number = Annotated[int, Path(ge=1, le=MOST_NUMBER, description="number of the correction")]
Word = Annotated[str | None, Query(max_length=200)]
Since = Annotated[datetime | None, Query(description="start time (inclusive), with zone")]
Until = Annotated[datetime | None, Query(description="end time (exclusive), with zone")]


class TableFormat(StrEnum):
    """File format of a table for other programs."""

    CSV = "csv"
    PARQUET = "parquet"


KINDS = {
    TableFormat.CSV: "text/csv; charset=utf-8",
    TableFormat.PARQUET: "application/vnd.apache.parquet",
}


@EVALUATIONS.post("", status_code=202, response_model=JobView, summary="Compute a table")
async def ask_evaluation(
    request: Request, body: EvaluationRequest, owner: ByOwner, key: IdempotencyHeader = None
) -> Response:
    """Queue a job that compares planned with actual values, feature by feature."""
    _require_moments(since=body.since, until=body.until)
    order = JobRequest(kind=JobKind.EVALUATION, request=dumped(body), owner=owner)
    return await queued(request, order, key)


@EVALUATIONS.get("", response_model=PageView[JobView], summary="List tables, newest first")
async def list_evaluations(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List the evaluation jobs page by page."""
    page = await answered(jobs.listed, data_folder, cursor, kind=JobKind.EVALUATION)
    return page_reply(request, page, [job_view(job) for job in page.items])


@EVALUATIONS.get("/{id}", summary="Show a table")
async def evaluation(request: Request, id: Id) -> Response:
    """Show the rows of a table with roughing and finishing values, grades and remarks."""
    return await result_reply(request, id, JobKind.EVALUATION)


@EVALUATIONS.get(
    "/{id}/table",
    summary="Download a table as a file",
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in KINDS.values()}}},
)
async def evaluation_file(
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    form: Annotated[TableFormat, Query(description="format of the file")] = TableFormat.CSV,
) -> Response:
    """Download a table with one line for each side (roughing, finishing) of a row."""
    await answered(jobs.get, data_folder, id, JobKind.EVALUATION)
    file = await result_file(data_folder, id, f"{TABLE}.{form.value}")
    name = f"evaluation-{id}.{form.value}"
    return file_reply(request, file, name=name, kind=KINDS[form], thing="table")


@EVALUATIONS.get("/{id}/report", summary="Show a table as a page", response_class=Response,
                 responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def evaluation_report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML page of an evaluation table."""
    await answered(jobs.get, data_folder, id, JobKind.EVALUATION)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)


@REVIEWS.post("", status_code=202, response_model=JobView, summary="Learn from outcomes")
async def ask_review(
    request: Request, body: ReviewRequest, owner: ByOwner, key: IdempotencyHeader = None
) -> Response:
    """Queue a job that proposes corrections, which a person may then accept."""
    _require_moments(since=body.since, until=body.until)
    order = JobRequest(kind=JobKind.REVIEW, request=dumped(body), owner=owner)
    return await queued(request, order, key)


@REVIEWS.get("/{id}", summary="Show the result of a review")
async def review(request: Request, id: Id) -> Response:
    """Show each context with its factor on k_c, the objections to it, and the action taken."""
    return await result_reply(request, id, JobKind.REVIEW)


@CORRECTIONS.get("", summary="List all corrections with their latest decision")
async def corrections(request: Request, data_folder: InDataFolder) -> Response:
    """List all corrections in the order of their proposal."""
    return await _corrections(request, lambda: verbs.corrections(data_folder.knowledge))


@CORRECTIONS.post("/{number}/accept", summary="Accept a correction")
async def accept(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """Accept a correction in the name of a person; the next plan applies it."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.accept(place, [number], by=body.by))


@CORRECTIONS.post("/{number}/withdraw", summary="Withdraw or reject a correction")
async def withdraw(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """Withdraw an accepted correction, or reject a proposed one."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.withdraw(place, [number], by=body.by))


def _require_moments(**times: datetime | None) -> None:
    """Refuse invalid times before a job is queued with them.

    Raises
    ------
    Unreadable
        When a time has no zone or lies outside the supported years.
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
        # The person's name is empty or cannot be stored.
        raise Unreadable(str(error)) from error
    return json_reply(request, corrections_json(entries).encode())


@OUTCOMES.get("", summary="List outcomes, newest first")
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
    """List outcomes of runs by workingstep, in canonical units as in exports."""
    _require_moments(since=since, until=until)
    selection = Selection(
        machine=machine, material=material, tool=tool, feature_kind=feature_kind,
        program=program, since=since, until=until,
    )  # fmt: skip
    place = data_folder_of(request).knowledge
    listing = await run_in_threadpool(verbs.newest, place, selection, limit=limit)
    return json_reply(request, listing_json(listing).encode())


@OUTCOMES.get("/runs/{run}", summary="List the outcomes of one run")
async def run_outcomes(
    request: Request, data_folder: InDataFolder, run: Annotated[str, Path(max_length=200)]
) -> Response:
    """List the outcomes of a run with their deviations."""
    found = await run_in_threadpool(verbs.outcomes_of_run, data_folder.knowledge, run)
    if not found:
        raise NotFound("run", run)
    return json_reply(request, run_json(found).encode())


@OUTCOMES.get("/contexts", summary="List machines, materials and tools with known outcomes")
async def contexts(request: Request, data_folder: InDataFolder) -> Response:
    """List the known combinations of machine, material and tool, for filters."""
    found = await run_in_threadpool(verbs.contexts, data_folder.knowledge)
    known = [{"machine": each.machine, "material": each.material, "tool": each.tool}
             for each in found]  # fmt: skip
    return json_reply(request, json.dumps({"contexts": known}).encode())
