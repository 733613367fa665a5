"""Routes of ``/v1/jobs``: state, progress, events, cancellation and deletion of jobs."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.rest.bodies import Id
from service.rest.context import InDataFolder, OnPage, key_of
from service.rest.replies import json_reply
from service.rest.results import EVENTS, jobs_reply, stream_reply
from service.rest.rights import require, role_to_end
from service.rest.storage_queries import answered
from service.rest.views import JobView, PageView, job_view
from service.storage import jobs
from service.storage.jobs import JobKind, JobState

ROUTES = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@ROUTES.get("", response_model=PageView[JobView], summary="List jobs, newest first")
async def list_jobs(
    request: Request,
    data_folder: InDataFolder,
    cursor: OnPage,
    kind: Annotated[JobKind | None, Query(description="only jobs of this kind")] = None,
    state: Annotated[JobState | None, Query(description="only jobs in this state")] = None,
) -> Response:
    """List jobs page by page."""
    return await jobs_reply(request, data_folder, cursor, kind=kind, state=state)


@ROUTES.get("/{id}", response_model=JobView, summary="Show a job")
async def job(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show a job and its progress."""
    return json_reply(request, job_view(await answered(jobs.get, data_folder, id)))


@ROUTES.get(
    "/{id}/events", summary="Stream events of a job", response_class=Response, responses=EVENTS
)
async def job_events(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Stream events ``job``, ``status``, ``rows``, ``event``, ``gap`` until the job ends."""
    return await stream_reply(request, await answered(jobs.get, data_folder, id))


@ROUTES.post("/{id}/cancel", response_model=JobView, summary="Cancel a job")
async def cancel(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Cancel a job: a queued one at once, a running one within seconds."""
    require(key_of(request), role_to_end((await answered(jobs.get, data_folder, id)).kind))
    return json_reply(request, job_view(await run_in_threadpool(jobs.cancel, data_folder, id)))


@ROUTES.delete("/{id}", status_code=204, summary="Delete a finished job and its results")
async def delete(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Delete a job; outcomes that it recorded in the knowledge base stay there."""
    require(key_of(request), role_to_end((await answered(jobs.get, data_folder, id)).kind))
    await run_in_threadpool(jobs.remove, data_folder, id)
    return Response(status_code=204)
