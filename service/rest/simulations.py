"""Routes of ``/v1/simulations``: runs of programs on the virtual machine."""

from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Conflict, Unreadable
from service.jobs.task import REPORT, SAMPLES
from service.live.path import shown_path
from service.live.series import open_series
from service.requests.fields import dumped
from service.requests.runs import RunRequest, SimulationRequest
from service.rest.asking import answered, result_file
from service.rest.bodies import Id
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    page_reply,
    queued,
    runnable,
)
from service.rest.replies import file_reply, json_reply, report_reply
from service.rest.results import (
    SERIES_POINTS,
    Begin,
    End,
    Points,
    Signals,
    file_of,
    live_folder,
    read_in_turn,
    result_reply,
    series_reply,
)
from service.rest.views import (
    JobView,
    PageView,
    PathView,
    SeriesView,
    SimulationView,
    job_view,
)
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobRequest

ROUTES = APIRouter(prefix="/v1/simulations", tags=["simulations"])

PARQUET = "application/vnd.apache.parquet"

PATH_POINTS = 20_000

PathPoints = Annotated[int, Query(ge=100, le=50_000, description="most points of the path")]


@ROUTES.post("", status_code=202, response_model=JobView, summary="Simulate a program")
async def ask(
    request: Request,
    data_folder: InDataFolder,
    body: SimulationRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a simulation job; watch its events, then read its result."""
    return await queued(
        request,
        await answered(run_order, data_folder, JobKind.SIMULATION, body, owner),
        key,
        require=runnable,
    )


def run_order(
    data_folder: DataFolder, kind: JobKind, body: RunRequest, owner: str
) -> JobRequest:
    """Return the job request for a run of an uploaded program or of an optimised one.

    Raises
    ------
    Unreadable, NotFound
        When not exactly one of them is named, or it does not exist.
    """
    if (body.program_id is None) == (body.advice_id is None):
        raise Unreadable("name either a program_id or an advice_id")
    program, source = body.program_id or "", body.advice_id or ""
    if source:
        program = jobs.get(data_folder, source, JobKind.ADVICE).program
    return JobRequest(
        kind=kind, request=dumped(body), program=program, source=source, owner=owner
    )


@ROUTES.get("", response_model=PageView[JobView], summary="List simulations, newest first")
async def list_simulations(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List the simulation jobs page by page."""
    page = await answered(jobs.listed, data_folder, cursor, kind=JobKind.SIMULATION)
    return page_reply(request, page, [job_view(job) for job in page.items])


@ROUTES.get("/{id}", response_model=SimulationView, summary="Show the result of a simulation")
async def simulation(request: Request, id: Id) -> Response:
    """Show time, energy, peaks and removal of the run and of each workingstep."""
    return await result_reply(request, id, JobKind.SIMULATION)


@ROUTES.get("/{id}/series", response_model=SeriesView, summary="Signals over time")
async def series(  # noqa: PLR0913, PLR0917 (each is a parameter of the request)
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    signals: Signals = "",
    begin_s: Begin = None,
    end_s: End = None,
    points: Points = SERIES_POINTS,
) -> Response:
    """Show signals over a time range with the requested resolution, also during a run."""
    job = await answered(jobs.get, data_folder, id, JobKind.SIMULATION)
    return await series_reply(
        request, job, signals=signals, begin=begin_s, end=end_s, points=points
    )


@ROUTES.get("/{id}/path", response_model=PathView, summary="Path of the tool")
async def path(
    request: Request, data_folder: InDataFolder, id: Id, points: PathPoints = PATH_POINTS
) -> Response:
    """Show the tool path, thinned but with all corners and changes of feed and force."""
    job = await answered(jobs.get, data_folder, id, JobKind.SIMULATION)
    found = await read_in_turn(_path, data_folder, job, points)
    return json_reply(request, found)


def _path(data_folder: DataFolder, job: Job, points: int) -> dict[str, Any]:
    folder = live_folder(data_folder, job)
    series, status = open_series(folder.series), folder.read_status()
    if series is None or not len(series) or status is None:
        raise Conflict(f"{job.kind.value} '{job.id}' is {job.state.value}: it has no rows yet")
    found = shown_path(series, points)
    off, shown = found.deviation, found.path
    x, y, z = np.ascontiguousarray(np.round(shown.position, 4).T)
    return {
        "workingsteps": status["workingsteps"],
        "rows": found.rows,
        "deviation_mm": off.length,
        "deviation_mm_min": off.feed,
        "deviation_n": off.force,
        "is_growing": not job.state.is_finished,
        "time_s": np.round(shown.time, 4),
        "x_mm": x,
        "y_mm": y,
        "z_mm": z,
        "feed_actual_mm_min": np.round(shown.feed, 2),
        "cutting_force_n": np.round(shown.force, 2),
        "is_rapid": shown.is_rapid,
        "workingstep": shown.workingstep,
    }


@ROUTES.get("/{id}/samples", summary="Download the samples as Parquet", response_class=Response,
            responses={200: {"content": {PARQUET: {}}}})  # fmt: skip
async def samples(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the samples as ``stepnc simulate -o run.parquet`` writes them."""
    file = await run_in_threadpool(
        file_of,
        data_folder,
        await answered(jobs.get, data_folder, id, JobKind.SIMULATION),
        SAMPLES,
        thing="samples",
    )
    name = f"simulation-{id}.parquet"
    return file_reply(request, file, name=name, kind=PARQUET, thing="samples")


@ROUTES.get("/{id}/report", summary="The report as a page", response_class=Response,
            responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML report of a simulation."""
    await answered(jobs.get, data_folder, id, JobKind.SIMULATION)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)
