"""Resource of jobs of one kind: what the table declares of it, and the routes that follow.

Every resource is queued, listed and shown in the same way; its report and its files are fetched
in the same way; and a run that people watch has the same status, events and signals.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import PurePath
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.requests import fields
from service.rest.bodies import Id, RequestBody
from service.rest.context import ByOwner, IdempotencyHeader, InDataFolder, OnPage, monitors_of
from service.rest.orders import Require, agent_url, nothing, order, queued
from service.rest.replies import file_reply, json_reply, report_reply
from service.rest.results import (
    EVENTS,
    SERIES_POINTS,
    Begin,
    End,
    Points,
    Signals,
    file_of,
    jobs_reply,
    past_events,
    require_done,
    result_reply,
    series_reply,
    status_reply,
    stream_reply,
)
from service.rest.storage_queries import answered
from service.rest.views import PLACES, JobView, PageView, SeriesView, View, job_view
from service.storage import jobs
from service.storage.jobs import JobKind
from service.storage.results import REPORT


class TableFormat(StrEnum):
    """File format of a table for other programs."""

    CSV = "csv"
    PARQUET = "parquet"


MEDIA_TYPES = {
    TableFormat.CSV: "text/csv; charset=utf-8",
    TableFormat.PARQUET: "application/vnd.apache.parquet",
}

CSV_OR_PARQUET = (TableFormat.CSV, TableFormat.PARQUET)

Form = Annotated[TableFormat, Query(description="format of the file")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Creation:
    """Request that queues a job."""

    name: str
    """Name of the route, of which its operation id is made."""
    body: type[fields.Request | RequestBody]
    summary: str
    about: str
    require: Require = nothing
    """Check before the job is queued, beside that of files, program and log that it names."""
    extra: Mapping[str, Any] | None = None
    """What the OpenAPI document says besides."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """Result of a job, as its record names the fields."""

    summary: str
    about: str
    view: type[View] | None = None
    """Model of the fields in the OpenAPI document; None: it does not list them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Download:
    """Table that a job has written."""

    path: str
    """Last part of the route."""
    file: str
    """Name of the file in the folder of the job; its format replaces the suffix."""
    summary: str
    about: str
    forms: tuple[TableFormat, ...] = (TableFormat.PARQUET,)
    """Formats in which there is one; of several the client chooses."""
    name: str = ""
    """Name of the route; empty: its path."""
    thing: str = ""
    """What there is none of in messages; empty: its path."""
    saved_as: str = ""
    """First word of the name of the download; empty: the kind of job."""
    is_result: bool = False
    """Whether to refuse a job that has not succeeded as :func:`require_done` does."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Resource:
    """Jobs of one kind over REST."""

    kind: JobKind
    tag: str
    """Group of the routes in the OpenAPI document."""
    plural: str
    creation: Creation | None = None
    """None: the route has more to it."""
    shown: Shown | None = None
    """None: the route has more to it."""
    report: str = "report"
    """Name of the route of the report; empty: there is none."""
    downloads: tuple[Download, ...] = ()
    status: str = ""
    """What the status of a run says that people watch; empty: nobody watches one."""
    has_series: bool = False

    @property
    def prefix(self) -> str:
        """Path of the resource."""
        return f"/v1/{PLACES[self.kind]}"

    def operation_id(self, what: str) -> str | None:
        """Return the operation id of a common route; None: made of name and path."""
        return f"{what}_{self.kind.name.lower()}" if self.kind.is_live else None


def routes_of(resource: Resource) -> APIRouter:
    """Return the routes of a resource."""
    routes = APIRouter(prefix=resource.prefix, tags=[resource.tag])
    if resource.creation is not None:
        _add_creation(routes, resource.kind, resource.creation)
    _add_list(routes, resource)
    if resource.shown is not None:
        _add_result(routes, resource, resource.shown)
    if resource.report:
        _add_report(routes, resource)
    for download in resource.downloads:
        _add_download(routes, resource.kind, download)
    if resource.status:
        _add_watching(routes, resource)
    if resource.has_series:
        _add_series(routes, resource)
    return routes


def _add_creation(routes: APIRouter, kind: JobKind, creation: Creation) -> None:
    async def create(
        request: Request,
        data_folder: InDataFolder,
        body: Any,
        owner: ByOwner,
        key: IdempotencyHeader = None,
    ) -> Response:
        words = _words(body)
        if "monitor" in words:
            # Clients name a machine; only the settings of the service say where its agent is.
            words["agent_url"] = agent_url(monitors_of(request), words["monitor"])
        asked = await answered(order, data_folder, kind, words, owner)
        return await queued(request, asked, key, require=creation.require)

    # The framework reads the type of the body from the signature, which no checker can know.
    create.__annotations__["body"] = creation.body
    routes.add_api_route(
        "", create, methods=["POST"], name=creation.name, status_code=202,
        response_model=JobView, summary=creation.summary, description=creation.about,
        openapi_extra=None if creation.extra is None else dict(creation.extra),
    )  # fmt: skip


def _words(body: fields.Request | RequestBody) -> dict[str, Any]:
    """Return the fields of a request as its job keeps them."""
    if isinstance(body, RequestBody):
        return body.model_dump(mode="json", exclude_none=True)
    return fields.dumped(body)


def _add_list(routes: APIRouter, resource: Resource) -> None:
    @routes.get(
        "", response_model=PageView[JobView], summary=f"List {resource.plural}, newest first",
        name=f"list_{PLACES[resource.kind].replace('-', '_')}",
        operation_id=resource.operation_id("list"),
    )  # fmt: skip
    async def listed(request: Request, data_folder: InDataFolder, cursor: OnPage) -> Response:
        """List the jobs page by page."""
        return await jobs_reply(request, data_folder, cursor, kind=resource.kind)


def _add_result(routes: APIRouter, resource: Resource, shown: Shown) -> None:
    @routes.get(
        "/{id}", response_model=shown.view, summary=shown.summary, description=shown.about,
        name=resource.kind.name.lower(), operation_id=resource.operation_id("result"),
    )  # fmt: skip
    async def result(request: Request, id: Id) -> Response:
        return await result_reply(request, id, resource.kind)


def _add_report(routes: APIRouter, resource: Resource) -> None:
    @routes.get(
        "/{id}/report", summary="Show the report as a page", response_class=Response,
        responses={200: {"content": {"text/html": {}}}}, name=resource.report,
    )  # fmt: skip
    async def report(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """Show the self-contained HTML report, which can be saved, printed and sent."""
        job = await answered(jobs.get, data_folder, id, resource.kind)
        file = await run_in_threadpool(file_of, data_folder, job, REPORT, thing="report")
        return report_reply(request, file, id=id)


def _add_download(routes: APIRouter, kind: JobKind, download: Download) -> None:
    thing = download.thing or download.path

    async def chosen(
        request: Request, data_folder: InDataFolder, id: Id, form: Form = download.forms[0]
    ) -> Response:
        job = await answered(jobs.get, data_folder, id, kind)
        if download.is_result:
            require_done(job)
        name = str(PurePath(download.file).with_suffix(f".{form.value}"))
        file = await run_in_threadpool(file_of, data_folder, job, name, thing=thing)
        saved = f"{download.saved_as or kind.value}-{id}.{form.value}"
        return file_reply(request, file, name=saved, kind=MEDIA_TYPES[form], thing=thing)

    async def only(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        return await chosen(request, data_folder, id)

    content: dict[str, Any] = {MEDIA_TYPES[form]: {} for form in download.forms}
    routes.add_api_route(
        f"/{{id}}/{download.path}", chosen if len(download.forms) > 1 else only,
        name=download.name or download.path, response_class=Response,
        responses={200: {"content": content}}, summary=download.summary,
        description=download.about,
    )  # fmt: skip


def _add_watching(routes: APIRouter, resource: Resource) -> None:
    """Add the routes of a run that people watch, and may end."""
    kind, operation_id = resource.kind, resource.operation_id

    @routes.get("/{id}/status", summary="Show the current status",
                description=resource.status, operation_id=operation_id("status"))  # fmt: skip
    async def status(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        return await status_reply(request, await answered(jobs.get, data_folder, id, kind))

    @routes.get("/{id}/log", summary="List past events", operation_id=operation_id("log"))
    async def log(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """List the last events, oldest first."""
        job = await answered(jobs.get, data_folder, id, kind)
        events = await run_in_threadpool(past_events, data_folder, job)
        return json_reply(request, {"events": events})

    @routes.get("/{id}/events", summary="Stream events", response_class=Response,
                responses=EVENTS, operation_id=operation_id("events"))  # fmt: skip
    async def events(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """Stream the events ``job``, ``status``, ``rows``, ``event`` and ``gap``."""
        return await stream_reply(request, await answered(jobs.get, data_folder, id, kind))

    @routes.post(
        "/{id}/cancel", response_model=JobView, summary="Cancel the run",
        name=f"cancel_{kind.name.lower()}", operation_id=operation_id("cancel"),
    )  # fmt: skip
    async def cancel(request: Request, data_folder: InDataFolder, id: Id) -> Response:
        """End a run without a result; its rows are kept."""
        await answered(jobs.get, data_folder, id, kind)
        job = await run_in_threadpool(jobs.cancel, data_folder, id)
        return json_reply(request, job_view(job))


def _add_series(routes: APIRouter, resource: Resource) -> None:
    @routes.get("/{id}/series", response_model=SeriesView, summary="Signals over time",
                operation_id=resource.operation_id("series"))  # fmt: skip
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
        job = await answered(jobs.get, data_folder, id, resource.kind)
        return await series_reply(
            request, job, signals=signals, begin=begin_s, end=end_s, points=points
        )
