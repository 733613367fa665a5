"""Changes of runs under control and of trial cuts as they go on."""

from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from service.control.live import require_changes
from service.errors import Conflict
from service.live.journal import append
from service.requests.fields import dumped
from service.requests.runs import ControlChanges
from service.rest.bodies import Id, TrialChanges
from service.rest.context import InDataFolder
from service.rest.replies import json_reply
from service.rest.results import live_folder
from service.rest.storage_queries import answered
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobState
from service.trial.inputs import Inputs, changed

ROUTES = APIRouter(prefix="/v1", tags=["control"])


@ROUTES.post("/control-runs/{id}/changes", status_code=202, summary="Change a controlled run")
async def change_control(
    request: Request, data_folder: InDataFolder, id: Id, body: ControlChanges
) -> Response:
    """Request changes, which take effect within a tenth of a second and appear as events."""
    require_changes(body)
    words = {name: value for name, value in dumped(body).items() if value is not None}
    return await ordered(
        request, data_folder, await answered(jobs.get, data_folder, id, JobKind.CONTROL), words
    )


@ROUTES.post("/trials/{id}/changes", status_code=202, summary="Change inputs of a trial cut")
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
