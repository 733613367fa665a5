"""Routes of ``/v1/control-runs`` and ``/v1/trials``: runs that can be changed as they go on."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from service.control.live import require_changes
from service.errors import Conflict
from service.jobs.task import REPORT, SAMPLES
from service.live.journal import append, read_on
from service.requests.fields import dumped
from service.requests.runs import ControlChanges, ControlRequest
from service.rest.asking import answered, result_file
from service.rest.bodies import Id, TrialBody, TrialChanges
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    page_reply,
    queued,
    runnable,
)
from service.rest.jobs import EVENTS
from service.rest.replies import file_reply, json_reply, report_reply
from service.rest.results import (
    SERIES_POINTS,
    Begin,
    End,
    Points,
    Signals,
    file_of,
    live_folder,
    result_reply,
    series_reply,
    status_reply,
    stream_reply,
)
from service.rest.simulations import PARQUET, run_order
from service.rest.views import JobView, PageView, SeriesView, job_view
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from service.trial.inputs import Inputs, changed

CONTROL = APIRouter(prefix="/v1/control-runs", tags=["control"])
TRIALS = APIRouter(prefix="/v1/trials", tags=["control"])

SHOWN_EVENTS = 500

USUAL = {
    "requestBody": {"content": {"application/json": {"example": {"inputs": asdict(Inputs())}}}}
}
"""Example request of a trial cut; the service fills in missing inputs with these values."""


@CONTROL.post(
    "", status_code=202, response_model=JobView, summary="Run a program under control"
)
async def ask_control(
    request: Request,
    data_folder: InDataFolder,
    body: ControlRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a job that runs a program on the virtual machine under force control."""
    return await queued(
        request,
        await answered(run_order, data_folder, JobKind.CONTROL, body, owner),
        key,
        require=runnable,
    )


@TRIALS.post("", status_code=202, response_model=JobView, summary="Begin a trial cut",
             openapi_extra=USUAL)  # fmt: skip
async def ask_trial(
    request: Request, body: TrialBody, owner: ByOwner, key: IdempotencyHeader = None
) -> Response:
    """Queue a trial: a constant cut whose inputs can be changed while it goes on."""
    inputs = body.inputs.model_dump(mode="json", exclude_none=True)
    await run_in_threadpool(changed, Inputs(), **inputs)
    words = {"inputs": inputs, "seed": body.seed, "pace": body.pace}
    return await queued(
        request, JobRequest(kind=JobKind.TRIAL, request=words, owner=owner), key
    )


@CONTROL.post("/{id}/changes", status_code=202, summary="Change a controlled run")
async def change_control(
    request: Request, data_folder: InDataFolder, id: Id, body: ControlChanges
) -> Response:
    """Request changes, which take effect within a tenth of a second and appear as events."""
    require_changes(body)
    words = {name: value for name, value in dumped(body).items() if value is not None}
    return await ordered(
        request, data_folder, await answered(jobs.get, data_folder, id, JobKind.CONTROL), words
    )


@TRIALS.post("/{id}/changes", status_code=202, summary="Change inputs of a trial cut")
async def change_trial(
    request: Request, data_folder: InDataFolder, id: Id, body: TrialChanges
) -> Response:
    """Change inputs of a trial; ``restart`` continues a stopped run, ``end`` finishes it."""
    job = await answered(jobs.get, data_folder, id, JobKind.TRIAL)
    inputs = body.inputs.model_dump(mode="json", exclude_none=True)
    if inputs:
        now = await run_in_threadpool(_inputs, data_folder, job)
        await run_in_threadpool(changed, now, **inputs)
    pace = {} if body.pace is None else {"pace": body.pace}
    # Inputs first: a new cutter enters the work with them.
    acts = [{name: True} for name in ("restart", "end") if getattr(body, name)]
    return await ordered(request, data_folder, job, *filter(None, ({**inputs, **pace}, *acts)))


def _inputs(data_folder: DataFolder, job: Job) -> Inputs:
    """Return the current inputs of a trial, with all requested changes."""
    inputs = changed(Inputs(), **job.request["inputs"])
    status = live_folder(data_folder, job).read_status()
    return inputs if status is None else changed(inputs, **status["inputs"])


async def ordered(
    request: Request, data_folder: DataFolder, job: Job, *orders: Mapping[str, Any]
) -> Response:
    """Pass change requests on to the process that runs the job."""
    if job.state.is_finished:
        raise Conflict(f"{job.kind.value} '{job.id}' is {job.state.value}: no changes possible")
    if data_folder.store is not None and job.state is JobState.QUEUED:
        # Which host will run it is not known yet.
        raise Conflict(f"{job.kind.value} '{job.id}' has not begun: order again when it runs")

    def hand_on() -> None:
        folder = live_folder(data_folder, job)
        folder.path.mkdir(mode=0o700, exist_ok=True)
        for order in orders:
            append(folder.orders, order)

    await run_in_threadpool(hand_on)
    return json_reply(request, {"asked": orders}, status=202)


def _add_common(routes: APIRouter, kind: JobKind) -> None:
    """Add the routes that trials and runs under control share."""

    @routes.get("", response_model=PageView[JobView], summary=f"{kind.value}s, newest first",
                operation_id=f"list_{kind.name.lower()}")  # fmt: skip
    async def listed(request: Request, data_folder: InDataFolder, cursor: OnPage) -> Response:
        """List the jobs of this kind page by page."""
        page = await answered(jobs.listed, data_folder, cursor, kind=kind)
        return page_reply(request, page, [job_view(job) for job in page.items])

    @routes.get("/{id}", summary="Show the result", operation_id=f"result_{kind.name.lower()}")
    async def result(request: Request, id: Id) -> Response:
        """Show the result of a finished run."""
        return await result_reply(request, id, kind)

    @routes.get("/{id}/status", summary="Show the current status",
                operation_id=f"status_{kind.name.lower()}")  # fmt: skip
    async def status(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """Show inputs, feeds, force, power and the active limit; null before the run begins."""
        return await status_reply(request, await answered(jobs.get, data_folder, id, kind))

    @routes.get("/{id}/log", summary="List past events",
                operation_id=f"log_{kind.name.lower()}")  # fmt: skip
    async def log(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """List the last events, oldest first."""
        job = await answered(jobs.get, data_folder, id, kind)
        events = await run_in_threadpool(past_events, data_folder, job)
        return json_reply(request, {"events": events})

    @routes.get("/{id}/events", summary="Stream events", response_class=Response,
                responses=EVENTS, operation_id=f"events_{kind.name.lower()}")  # fmt: skip
    async def events(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """Stream the events ``job``, ``status``, ``rows``, ``event`` and ``gap``."""
        return await stream_reply(request, await answered(jobs.get, data_folder, id, kind))

    @routes.get("/{id}/series", response_model=SeriesView, summary="Signals over time",
                operation_id=f"series_{kind.name.lower()}")  # fmt: skip
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
        job = await answered(jobs.get, data_folder, id, kind)
        return await series_reply(
            request, job, signals=signals, begin=begin_s, end=end_s, points=points
        )

    @routes.post("/{id}/cancel", response_model=JobView, summary="Cancel the run",
                 operation_id=f"cancel_{kind.name.lower()}")  # fmt: skip
    async def cancel(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """End a run; its rows are kept."""
        await answered(jobs.get, data_folder, id, kind)
        return json_reply(
            request, job_view(await run_in_threadpool(jobs.cancel, data_folder, id))
        )


_add_common(CONTROL, JobKind.CONTROL)
_add_common(TRIALS, JobKind.TRIAL)


@CONTROL.get("/{id}/samples", summary="Download the run as Parquet", response_class=Response,
             responses={200: {"content": {PARQUET: {}}}})  # fmt: skip
async def samples(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the samples of a run, one row per revolution."""
    file = await run_in_threadpool(
        file_of,
        data_folder,
        await answered(jobs.get, data_folder, id, JobKind.CONTROL),
        SAMPLES,
        thing="samples",
    )
    return file_reply(
        request, file, name=f"control-run-{id}.parquet", kind=PARQUET, thing="samples"
    )


@CONTROL.get("/{id}/report", summary="Show the report as a page", response_class=Response,
             responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML report of a run."""
    await answered(jobs.get, data_folder, id, JobKind.CONTROL)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)


def past_events(data_folder: DataFolder, job: Job) -> list[dict[str, Any]]:
    """Return the last events of a run, oldest first."""
    folder = live_folder(data_folder, job)
    found: list[dict[str, Any]] = []
    offset = 0
    while (read := read_on(folder.events, offset)).lines:
        found, offset = [*found, *read.lines][-SHOWN_EVENTS:], read.offset
    return found
