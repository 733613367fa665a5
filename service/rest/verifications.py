"""Routes of ``/v1/verifications``: logged positions against the programmed part."""

from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.jobs.task import LOG, PLACES, REPORT, SURFACE
from service.numbers import numbers_in
from service.requests.fields import dumped
from service.requests.stored_verification import QueuedVerification, StoredVerificationRequest
from service.rest.asking import answered, result_file
from service.rest.bodies import Id
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    monitors_of,
    page_reply,
    queued,
    runnable,
)
from service.rest.knowledge import KINDS, TableFormat
from service.rest.logged import LOGS, agent_url, logged_order, require_logs
from service.rest.raw_part import require_stock
from service.rest.replies import file_reply, json_reply, report_reply
from service.rest.results import file_of, read_in_turn, require_done, result_reply
from service.rest.verification_views import SurfaceMapView, VerificationView, map_view
from service.rest.views import JobView, PageView, job_view
from service.storage import jobs, library
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from service.verification.run import FIT
from service.verification.surface_map import read_map

ROUTES = APIRouter(prefix="/v1/verifications", tags=["verifications"])

WITHOUT_PROGRAM = ("machine", "stock", "tools_id", "required_id")
"""Fields that a verification without a program needs."""

IN_PLACE = {"stock": "stock_id"}
"""Fields that take the place of others."""

PLACES_SHOWN = 12_000

Places = Annotated[int, Query(ge=100, le=50_000, description="most places of the map")]


@ROUTES.post("", status_code=202, response_model=JobView, summary="Verify logged positions")
async def ask(
    request: Request,
    data_folder: InDataFolder,
    body: StoredVerificationRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a job that compares the part that a log left with the programmed one.

    The log is an uploaded one, the samples of a run, or the latest run of a monitored machine.
    """
    url = agent_url(monitors_of(request), body.monitor)
    own = {each.name: getattr(body, each.name) for each in fields(body)}
    words = dumped(QueuedVerification(**own, agent_url=url))
    asked = await answered(logged_order, data_folder, JobKind.VERIFICATION, words, owner)
    return await queued(request, asked, key, require=verifiable)


def verifiable(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that all files exist, and that machine, material, stock and zero are valid.

    Raises
    ------
    StepNcError
        When the job would raise the same error.
    """
    words = asked.request
    if not any(words[name] for name in LOGS):
        raise Unreadable(f"name one of {', '.join(LOGS)}")
    if asked.program:
        runnable(data_folder, asked)
    elif all(words[name] or words.get(IN_PLACE.get(name, "")) for name in WITHOUT_PROGRAM):
        library.require(data_folder, machine=words["machine"], material=words["material"])
    else:
        wanted = ", ".join(WITHOUT_PROGRAM)
        raise Unreadable(f"name a program_id or an advice_id; or all of {wanted}")
    require_logs(data_folder, asked)
    require_stock(data_folder, words)
    if words["zero"] and words["zero"] != FIT:
        numbers_in(words["zero"], "zero", counts=(3,))


@ROUTES.get("", response_model=PageView[JobView], summary="List verifications, newest first")
async def list_verifications(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List the verification jobs page by page."""
    page = await answered(jobs.listed, data_folder, cursor, kind=JobKind.VERIFICATION)
    return page_reply(request, page, [job_view(job) for job in page.items])


@ROUTES.get("/{id}", response_model=VerificationView, summary="Show a verification")
async def verification(request: Request, id: Id) -> Response:
    """Show deviations by workingstep, tolerance bands, and what the log can resolve."""
    return await result_reply(request, id, JobKind.VERIFICATION)


@ROUTES.get("/{id}/map", response_model=SurfaceMapView, summary="Show the map of deviations")
async def deviation_map(
    request: Request, data_folder: InDataFolder, id: Id, places: Places = PLACES_SHOWN
) -> Response:
    """Show places on the surface: the worst, and others evenly spread; the rest is counted."""
    file = await run_in_threadpool(_file, data_folder, id, SURFACE, thing="map")
    return json_reply(request, await read_in_turn(_map, file, places))


def _map(file: Path, places: int) -> dict[str, Any]:
    return map_view(read_map(file, most=places))


@ROUTES.get(
    "/{id}/places",
    summary="Download the deviations of places",
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in KINDS.values()}}},
)
async def places_file(
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    form: Annotated[TableFormat, Query(description="format of the file")] = TableFormat.CSV,
) -> Response:
    """Download all places on walls, and others beyond their uncertainty."""
    table = f"{PLACES}.{form.value}"
    file = await run_in_threadpool(_file, data_folder, id, table, thing="places")
    name = f"verification-{id}.{form.value}"
    return file_reply(request, file, name=name, kind=KINDS[form], thing="places")


@ROUTES.get("/{id}/log", summary="Download the log of a monitored machine",
            response_class=Response,
            responses={200: {"content": {KINDS[TableFormat.PARQUET]: {}}}})  # fmt: skip
async def log(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the positions that were read from the agent of a monitored machine."""
    thing = "log of a monitored machine in verification"
    file = await run_in_threadpool(_file, data_folder, id, LOG, thing=thing)
    kind = KINDS[TableFormat.PARQUET]
    return file_reply(request, file, name=f"log-{id}.parquet", kind=kind, thing="log")


@ROUTES.get("/{id}/report", summary="Show the report as a page", response_class=Response,
            responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML report of a verification."""
    await answered(jobs.get, data_folder, id, JobKind.VERIFICATION)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)


def _file(data_folder: DataFolder, id: str, name: str, *, thing: str) -> Path:
    job = jobs.get(data_folder, id, JobKind.VERIFICATION)
    if name != LOG:
        require_done(job)
    return file_of(data_folder, job, name, thing=thing)
