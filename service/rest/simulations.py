"""``/v1/simulations``: programs on the virtual machine."""

from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Request, Response

from service.errors import Conflict, Unreadable
from service.jobs.task import REPORT, SAMPLES
from service.live.folder import LiveFolder
from service.live.path import shown_path
from service.live.series import open_series
from service.requests.fields import dumped
from service.requests.runs import RunRequest, SimulationRequest
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

PathPoints = Annotated[int, Query(ge=100, le=50_000, description="of the path, at most")]


@ROUTES.post("", status_code=202, response_model=JobView, summary="Simulate a program")
async def ask(
    request: Request,
    data_folder: InDataFolder,
    body: SimulationRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """A job; watch it by its events, then read its result."""
    return await queued(
        request, run_order(data_folder, JobKind.SIMULATION, body, owner), key, require=runnable
    )


def run_order(
    data_folder: DataFolder, kind: JobKind, body: RunRequest, owner: str
) -> JobRequest:
    """A job for a run of a program, or of what an advice made of it.

    Raises
    ------
    Unreadable, NotFound
        When neither or both are named, or there is none.
    """
    if (body.program_id is None) == (body.advice_id is None):
        raise Unreadable("name a program_id or an advice_id")
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
    """A page of their jobs."""
    page = jobs.listed(data_folder, cursor, kind=JobKind.SIMULATION)
    return page_reply(request, page, [job_view(job) for job in page.items])


@ROUTES.get("/{id}", response_model=SimulationView, summary="The result of a simulation")
async def simulation(request: Request, id: Id) -> Response:
    """Time, energy, peaks and removal, of the run and of each workingstep."""
    return await result_reply(request, id, JobKind.SIMULATION)


@ROUTES.get("/{id}/series", response_model=SeriesView, summary="Signals against time")
async def series(  # noqa: PLR0913, PLR0917 (each is a parameter of the request)
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    signals: Signals = "",
    begin_s: Begin = None,
    end_s: End = None,
    points: Points = SERIES_POINTS,
) -> Response:
    """A range of time, brought down to as many points as are wanted; also while it runs."""
    job = jobs.get(data_folder, id, JobKind.SIMULATION)
    return await series_reply(
        request, job, signals=signals, begin=begin_s, end=end_s, points=points
    )


@ROUTES.get("/{id}/path", response_model=PathView, summary="Where the tool went")
async def path(
    request: Request, data_folder: InDataFolder, id: Id, points: PathPoints = PATH_POINTS
) -> Response:
    """Thinned so that corners and changes of feed and force stay; also while it runs."""
    job = jobs.get(data_folder, id, JobKind.SIMULATION)
    found = await read_in_turn(_path, data_folder, job, points)
    return json_reply(request, found)


def _path(data_folder: DataFolder, job: Job, points: int) -> dict[str, Any]:
    folder = LiveFolder(path=data_folder.job_folder(job.id))
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


@ROUTES.get("/{id}/samples", summary="All samples as a Parquet file", response_class=Response,
            responses={200: {"content": {PARQUET: {}}}})  # fmt: skip
async def samples(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """As ``stepnc simulate -o run.parquet`` writes them."""
    file = file_of(
        data_folder, jobs.get(data_folder, id, JobKind.SIMULATION), SAMPLES, thing="samples"
    )
    name = f"simulation-{id}.parquet"
    return file_reply(request, file, name=name, kind=PARQUET, thing="samples")


@ROUTES.get("/{id}/report", summary="The report as a page", response_class=Response,
            responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """A page that stands for itself."""
    jobs.get(data_folder, id, JobKind.SIMULATION)
    return report_reply(request, data_folder.job_folder(id) / REPORT, id=id)
