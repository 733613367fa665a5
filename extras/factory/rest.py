"""Runs of shops over REST, and the sample shops of ``/v1/shops``."""

from math import inf
from pathlib import Path as FilePath
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from extras.factory.live import require_failure
from extras.factory.model.shop_file import content_of
from extras.factory.requests import FactoryChanges, FactoryOrder
from extras.factory.run import STATES
from extras.factory.shop_job import FIGURES, STATE_LOG, TABLES, table_of
from extras.factory.shop_sources import checked_shop, sample_shops, source_of_order
from extras.factory.state_log import state_bars
from extras.factory.views import SampleShopView, StatesView
from service.errors import Conflict, NotFound, Unreadable
from service.live.series import open_series
from service.requests.fields import loaded
from service.rest.bodies import Id
from service.rest.context import (
    InDataFolder,
    fetched,
)
from service.rest.live import ordered
from service.rest.replies import file_reply, json_reply
from service.rest.resource import Creation, Download, Resource, Shown, TableFormat
from service.rest.results import (
    Begin,
    End,
    live_folder,
    read_in_turn,
)
from service.rest.storage_queries import answered
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobRequest

RUNS = APIRouter(prefix="/v1/factories", tags=["factories"])
SHOPS = APIRouter(prefix="/v1/shops", tags=["factories"])

CSV = "text/csv"

BARS = 400

Bars = Annotated[int, Query(ge=1, le=2000, description="most bars of each machine")]
MachineName = Annotated[str, Path(max_length=200, description="name of a machine of the shop")]


def producible(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that a shop, its programs and its machines can be read."""
    wanted = loaded(FactoryOrder, asked.request)
    checked_shop(source_of_order(data_folder, wanted), wanted)


RESOURCES = (
    Resource(
        kind=JobKind.FACTORY,
        tag="factories",
        plural="runs of shops",
        creation=Creation(
            name="ask_factory",
            body=FactoryOrder,
            require=producible,
            summary="Run a shop",
            about="Queue a job that runs a shop: live at a pace, or with replications and a "
            "sweep.",
        ),
        shown=Shown(
            summary="Show the figures of a shop",
            about="Show the figures by level, the time in each state, and the cases of a "
            "sweep.",
        ),
        downloads=(
            Download(
                path="figures",
                file=FIGURES,
                forms=(TableFormat.CSV,),
                summary="Download the figures as CSV",
                about="Download the figures of all levels, one row each.",
            ),
            Download(
                path="samples",
                file=f"{TABLES}/{STATES}",
                thing="states",
                summary="Download the states as Parquet",
                about="Download the states of all machines, one row each, first replication.",
            ),
        ),
        status="Show states of machines, buffers, products and processes; null before it "
        "begins.",
        has_series=True,
    ),
)


@SHOPS.get("", response_model=list[SampleShopView], summary="List the sample shops")
async def shops(request: Request) -> Response:
    """List the sample shops with their text; an installed package has none."""

    def read() -> list[dict[str, Any]]:
        return [_shop(name, file) for name, file in sample_shops().items()]

    return json_reply(request, await run_in_threadpool(read))


def _shop(name: str, file: FilePath) -> dict[str, Any]:
    text = file.read_text(encoding="utf-8")
    return {"name": name, "title": content_of(text, file).get("title", name), "text": text}


@RUNS.get("/{id}/states", response_model=StatesView, summary="States over time")
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


@RUNS.post("/{id}/changes", status_code=202, summary="Change a live shop")
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


@RUNS.get("/{id}/parts/{machine}", summary="Download the parts of a machine as CSV",
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


ROUTES = (RUNS, SHOPS)
