"""Routes of ``/v1/cycle-times``: time of a program by block, beside that of a log."""

from dataclasses import fields
from pathlib import Path

from fastapi import APIRouter, Request, Response

from service.errors import Unreadable
from service.jobs.task import REPORT
from service.recording.logged_run import DOCUMENTS
from service.recording.table import TABLES
from service.requests.fields import dumped
from service.requests.stored_cycle_time import QueuedCycleTime, StoredCycleTimeRequest
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
from service.rest.logged import agent_url, logged_order, require_logs
from service.rest.replies import report_reply
from service.rest.results import result_reply
from service.rest.verification_views import CycleTimeView
from service.rest.views import JobView, PageView, job_view
from service.storage import files, jobs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from stepnc_model.errors import StepNcError

ROUTES = APIRouter(prefix="/v1/cycle-times", tags=["verifications"])


@ROUTES.post("", status_code=202, response_model=JobView, summary="Estimate a cycle time")
async def ask(
    request: Request,
    data_folder: InDataFolder,
    body: StoredCycleTimeRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a job that estimates the time of a program by block; a log adds the actual time."""
    url = agent_url(monitors_of(request), body.monitor)
    own = {each.name: getattr(body, each.name) for each in fields(body)}
    words = dumped(QueuedCycleTime(**own, agent_url=url))
    asked = await answered(logged_order, data_folder, JobKind.CYCLE_TIME, words, owner)
    return await queued(request, asked, key, require=timeable)


def timeable(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that program, machine and log exist, and that the log has a form that is read.

    Raises
    ------
    StepNcError
        When the job would raise the same error.
    """
    if not asked.program:
        raise Unreadable("name a program_id or an advice_id")
    words = {**asked.request, "material": ""}
    runnable(data_folder, JobRequest(kind=asked.kind, request=words, program=asked.program,
                                     source=asked.source, owner=asked.owner))  # fmt: skip
    require_logs(data_folder, asked)
    if words["log_id"] is not None:
        name = files.get(data_folder, words["log_id"]).name
        if Path(name).suffix.lower() not in TABLES | DOCUMENTS:
            known = ", ".join(sorted(TABLES | DOCUMENTS))
            raise StepNcError(f"{name}: the cycle time is read from a log in {known}")


@ROUTES.get("", response_model=PageView[JobView], summary="List cycle times, newest first")
async def list_cycle_times(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List the jobs of cycle times page by page."""
    page = await answered(jobs.listed, data_folder, cursor, kind=JobKind.CYCLE_TIME)
    return page_reply(request, page, [job_view(job) for job in page.items])


@ROUTES.get("/{id}", response_model=CycleTimeView, summary="Show a cycle time")
async def cycle_time(request: Request, id: Id) -> Response:
    """Show times by workingstep and tool, the blocks that lose most, and hints."""
    return await result_reply(request, id, JobKind.CYCLE_TIME)


@ROUTES.get("/{id}/report", summary="Show the report as a page", response_class=Response,
            responses={200: {"content": {"text/html": {}}}})  # fmt: skip
async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show the self-contained HTML report with the feed of each block."""
    await answered(jobs.get, data_folder, id, JobKind.CYCLE_TIME)
    file = await result_file(data_folder, id, REPORT)
    return report_reply(request, file, id=id)
