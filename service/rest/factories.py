"""Routes of ``/v1/factories`` and ``/v1/shops``: runs of shops, live or with replications."""

from math import inf
from pathlib import Path as FilePath
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Conflict, NotFound, Unreadable
from service.factory.asked import asked_source, require_asked, sample_shops
from service.factory.live import require_failure
from service.factory.run import STATES
from service.factory.state_log import state_bars
from service.jobs.produce import FIGURES, STATE_LOG, TABLES, table_of
from service.jobs.task import REPORT
from service.live.series import open_series
from service.requests.factory import FactoryChanges, FactoryOrder
from service.requests.fields import dumped, loaded
from service.rest.asking import answered, result_file
from service.rest.bodies import Id
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    fetched,
    page_reply,
    queued,
)
from service.rest.factory_views import SampleShopView, StatesView
from service.rest.jobs import EVENTS
from service.rest.live import ordered, past_events
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
    status_reply,
    stream_reply,
)
from service.rest.simulations import PARQUET
from service.rest.views import JobView, PageView, SeriesView, job_view
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobRequest
from simulator.factory.shop_file import content_of

ROUTES = APIRouter(prefix="/v1/factories", tags=["factories"])
SHOPS = APIRouter(prefix="/v1/shops", tags=["factories"])

CSV = "text/csv"

BARS = 400

Bars = Annotated[int, Query(ge=1, le=2000, description="most bars of each machine")]
MachineName = Annotated[str, Path(max_length=200, description="name of a machine of the shop")]


@SHOPS.get("", response_model=list[SampleShopView], summary="List the sample shops")
async def shops(request: Request) -> Response:
    """List the sample shops with their text; an installed package has none."""

    def read() -> list[dict[str, Any]]:
        return [_shop(name, file) for name, file in sample_shops().items()]

    return json_reply(request, await run_in_threadpool(read))


def _shop(name: str, file: FilePath) -> dict[str, Any]:
    text = file.read_text(encoding="utf-8")
    return {"name": name, "title": content_of(text, file).get("title", name), "text": text}


@ROUTES.post("", status_code=202, response_model=JobView, summary="Run a shop")
async def ask_factory(
    request: Request,
    body: FactoryOrder,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a job that runs a shop: live at a pace, or with replications and a sweep."""
    order = JobRequest(kind=JobKind.FACTORY, request=dumped(body), owner=owner)
    return await queued(request, order, key, require=_require)


def _require(data_folder: DataFolder, asked: JobRequest) -> None:
    order = loaded(FactoryOrder, asked.request)
    require_asked(asked_source(data_folder, order), order)


@ROUTES.get("", response_model=PageView[JobView], summary="List runs of shops, newest first")
async def list_factories(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List the jobs page by page."""
    page = await answered(jobs.listed, data_folder, cursor, kind=JobKind.FACTORY)
    return page_reply(request, page, [job_view(job) for job in page.items])


@ROUTES.get("/{id}", summary="Show the figures of a shop")
async def factory(request: Request, id: Id) -> Response:
    """Show the figures by level, the time in each state, and the cases of a sweep."""
    return await result_reply(request, id, JobKind.FACTORY)


@ROUTES.get("/{id}/status", summary="Show the current status of a live shop")
async def status(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show states of machines, buffers, products and processes; null before it begins."""
    return await status_reply(
        request, await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    )


@ROUTES.get("/{id}/log", summary="List past events of a live shop")
async def log(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """List failures, repairs, maintenance, shifts and orders, oldest first."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    events = await run_in_threadpool(past_events, data_folder, job)
    return json_reply(request, {"events": events})


@ROUTES.get("/{id}/events", summary="Stream events of a shop", response_class=Response,
            responses=EVENTS)  # fmt: skip
async def events(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Stream the events ``job``, ``status``, ``rows``, ``event`` and ``gap``."""
    return await stream_reply(
        request, await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    )


@ROUTES.get("/{id}/series", response_model=SeriesView, summary="Power and stock over time")
async def series(  # noqa: PLR0913, PLR0917 (each is a parameter of the request)
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    signals: Signals = "",
    begin_s: Begin = None,
    end_s: End = None,
    points: Points = SERIES_POINTS,
) -> Response:
    """Show power of line and machines, energy and parts of a live shop over a time range."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    return await series_reply(
        request, job, signals=signals, begin=begin_s, end=end_s, points=points
    )


@ROUTES.get("/{id}/states", response_model=StatesView, summary="States over time")
async def states(
    request: Request,
    data_folder: InDataFolder,
    id: Id,
    begin_s: Begin = None,
    end_s: End = None,
    bars: Bars = BARS,
) -> Response:
    """Show the states of each machine of a live shop over a time range, also during the run."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    found = await read_in_turn(_states, data_folder, job, begin_s, end_s, bars)
    return json_reply(request, found)


def _states(
    data_folder: DataFolder, job: Job, begin: float | None, end: float | None, bars: int
) -> dict[str, Any]:
    folder = live_folder(data_folder, job, STATE_LOG)
    status, log = folder.read_status(), open_series(folder.path / STATE_LOG)
    if status is None or log is None:
        raise Conflict(
            f"{job.kind.value} '{job.id}' is {job.state.value}: it has no states yet"
        )
    first = 0.0 if begin is None else begin
    last = min(status["time_s"], inf if end is None else end)
    if first > last:
        raise Unreadable(f"begin_s {first:g} s is after {last:g} s")
    names = [machine["name"] for machine in status["machines"]]
    found = state_bars(log, len(names), begin=first, end=last, bars=bars)
    return {
        "begin_s": first,
        "end_s": last,
        "machines": [
            {"name": name, "state": each.state, "begin_s": each.begin, "end_s": each.end}
            for name, each in zip(names, found, strict=True)
        ],
    }


@ROUTES.post("/{id}/changes", status_code=202, summary="Order about a live shop")
async def change_factory(
    request: Request, data_folder: InDataFolder, id: Id, body: FactoryChanges
) -> Response:
    """Set the pace, let a machine fail, or end the run; what cannot be done is an event."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    if not job.is_live:
        raise Conflict(f"factory '{id}' is not live: cancel it instead")
    orders: list[dict[str, Any]] = []
    if body.pace is not None:
        orders.append({"pace": body.pace})
    if body.failure is not None:
        failure = body.failure
        known = await run_in_threadpool(_machines, data_folder, job)
        require_failure(known, failure.machine, failure.repair_min)
        orders.append({"machine": failure.machine, "repair_min": failure.repair_min})
    if body.is_ended:
        orders.append({"end": True})
    return await ordered(request, data_folder, job, *orders)


def _machines(data_folder: DataFolder, job: Job) -> list[str]:
    """Names of the machines of a shop that runs."""
    status = live_folder(data_folder, job).read_status()
    if status is None:
        raise Conflict(f"factory '{job.id}' is {job.state.value}: it has not begun")
    return [machine["name"] for machine in status["machines"]]


@ROUTES.post("/{id}/cancel", response_model=JobView, summary="Cancel a run of a shop")
async def cancel_factory(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """End a run without a result."""
    await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    return json_reply(request, job_view(await run_in_threadpool(jobs.cancel, data_folder, id)))


@ROUTES.get("/{id}/report", summary="Show the report as a page", response_class=Response,
            responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML report of a run."""
    await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)


@ROUTES.get("/{id}/figures", summary="Download the figures as CSV", response_class=Response,
            responses={200: {"content": {CSV: {}}}})  # fmt: skip
async def figures(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the figures of all levels, one row each."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    file = await run_in_threadpool(file_of, data_folder, job, FIGURES, thing="figures")
    return file_reply(request, file, name=f"factory-{id}.csv", kind=CSV, thing="figures")


@ROUTES.get("/{id}/parts/{machine}", summary="Download the parts of a machine as CSV",
            response_class=Response, responses={200: {"content": {CSV: {}}}})  # fmt: skip
async def parts(
    request: Request, data_folder: InDataFolder, id: Id, machine: MachineName
) -> Response:
    """Download the table of parts of a machine, first replication."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    folder = data_folder.run_folder(job.id, job.attempt)
    await fetched(data_folder, folder / TABLES / f"{FilePath(machine).name}.csv")
    file = table_of(folder, machine)
    if file is None:
        raise NotFound("table of parts", machine)
    return file_reply(request, file, name=file.name, kind=CSV, thing="table of parts")


@ROUTES.get("/{id}/samples", summary="Download the states as Parquet", response_class=Response,
            responses={200: {"content": {PARQUET: {}}}})  # fmt: skip
async def samples(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the states of all machines, one row each, first replication."""
    job = await answered(jobs.get, data_folder, id, JobKind.FACTORY)
    name = f"{TABLES}/{STATES}"
    file = await run_in_threadpool(file_of, data_folder, job, name, thing="states")
    return file_reply(request, file, name=f"factory-{id}.parquet", kind=PARQUET, thing="states")
