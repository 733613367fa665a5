"""Routes of ``/v1/programs``: upload, list, check and delete programs, and request advice."""

from functools import partial
from pathlib import Path as FilePath
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.files import read_bytes
from service.inputs.program_kind import ProgramKind, kind_of
from service.rendering.columns import dump
from service.requests.fields import dumped
from service.requests.program_facts import ISO, Name, Units
from service.requests.stored_advice import StoredAdviceRequest
from service.rest.advice_views import CodeContentsView
from service.rest.bodies import Id
from service.rest.checks import CheckCache, in_turn
from service.rest.code_check import checked_code
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    idempotency_of,
    page_reply,
    settings_of,
)
from service.rest.orders import advisable, queued
from service.rest.replies import file_reply, json_reply, matches, tagged
from service.rest.results import jobs_reply
from service.rest.storage_queries import answered
from service.rest.uploads import pieces
from service.rest.views import (
    ContentsView,
    JobView,
    PageView,
    ProgramView,
    program_view,
)
from service.storage import programs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from service.storage.pages import Page
from service.storage.programs import StoredProgram
from service.verbs.check.request import CheckFiles, CheckRequest
from service.verbs.check.run import run as check
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File

ROUTES = APIRouter(prefix="/v1/programs", tags=["programs"])

EXAMPLES = FilePath(__file__).parents[2] / "examples" / "parts"
"""Folder of the sample programs; an installed wheel has none."""

MEDIA_TYPES = {
    ProgramKind.STEP_NC: "application/step",
    ProgramKind.NC_CODE: "text/plain; charset=utf-8",
}
"""Media types of programs."""


@ROUTES.post(
    "",
    status_code=201,
    response_model=ProgramView,
    summary="Upload a program",
    openapi_extra={
        "requestBody": {
            "required": False,
            "description": "the bytes of a Part 21 file or of NC code; may be packed with gzip",
            "content": {
                "application/octet-stream": {"schema": {"type": "string", "format": "binary"}}
            },
        }
    },
)
async def upload(
    request: Request,
    data_folder: InDataFolder,
    owner: ByOwner,
    name: Annotated[str, Query(max_length=200, description="name of the program")] = "",
    example: Annotated[
        str, Query(max_length=64, description="name of a sample, instead of a body")
    ] = "",
    key: IdempotencyHeader = None,
) -> Response:
    """Store the bytes unchanged: a Part 21 file or NC code, told apart by the content.

    Findings have their own route.
    """
    if example:
        data = await run_in_threadpool(_sample, example)
        name = name or f"{example}.stpnc"
    else:
        data = await _body(request)
        if not data:
            raise Unreadable("the body is empty: send the bytes of the file")
    kind = await in_turn(partial(_kind, data, programs.shown_name(name)))
    stored = await run_in_threadpool(
        programs.add,
        data_folder,
        data,
        name=name,
        owner=owner,
        kind=kind,
        idempotency=idempotency_of(request, key, data),
    )
    headers = {"location": f"/v1/programs/{stored.id}"}
    return json_reply(request, program_view(stored), status=201, headers=headers)


@ROUTES.get("", response_model=PageView[ProgramView], summary="List programs, newest first")
async def list_programs(
    request: Request, data_folder: InDataFolder, cursor: OnPage
) -> Response:
    """List programs page by page."""
    page: Page[StoredProgram] = await answered(programs.listed, data_folder, cursor)
    return page_reply(request, page, [program_view(each) for each in page.items])


@ROUTES.get("/{id}", response_model=ProgramView, summary="Show a program")
async def program(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show a program."""
    return json_reply(request, program_view(await answered(programs.get, data_folder, id)))


@ROUTES.get(
    "/{id}/file",
    summary="Download a program as it was uploaded",
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}},
)
async def program_bytes(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download a program, byte for byte as it was uploaded."""
    stored = await answered(programs.get, data_folder, id)
    await run_in_threadpool(programs.require_file, data_folder, id)
    return file_reply(
        request,
        data_folder.program_file(id),
        name=stored.name,
        kind=MEDIA_TYPES[stored.kind],
        thing=programs.FILE,
        tag=f'"{stored.sha256}"',
    )


@ROUTES.get(
    "/{id}/findings", response_model=ContentsView | CodeContentsView, summary="Check a program"
)
async def findings(
    request: Request, data_folder: InDataFolder, id: Id, units: Units = ISO
) -> Response:
    """List workingsteps, or moves of NC code, and findings, as ``stepnc check`` does."""
    stored = await answered(programs.get, data_folder, id)
    await run_in_threadpool(programs.require_file, data_folder, id)
    tag = f'"{stored.sha256[:24]}-{units.value}"'
    if matches(request.headers.get("if-none-match"), tag):
        return tagged(request, b"", tag)
    name = f"{id} {units.value}"
    body = await _answers(request).get(name, partial(_contents, data_folder, stored, units))
    return tagged(request, body, tag)


@ROUTES.delete("/{id}", status_code=204, summary="Delete a program")
async def delete(data_folder: InDataFolder, id: Id) -> Response:
    """Delete a program; results made from it are kept."""
    await run_in_threadpool(programs.remove, data_folder, id)
    return Response(status_code=204)


@ROUTES.post("/{id}/advice", status_code=202, response_model=JobView, summary="Request advice")
async def ask_advice(
    request: Request,
    id: Id,
    body: StoredAdviceRequest,
    owner: ByOwner,
    key: IdempotencyHeader = None,
) -> Response:
    """Queue a job that optimises the feeds; its result will be at ``/v1/advice/{job}``.

    For NC code the request names ``material``, and, where the code tells no tools or no stock,
    ``tools_id``, ``stock`` or ``stock_id``; the feeds are chosen along its paths.
    """
    asked = JobRequest(kind=JobKind.ADVICE, request=dumped(body), program=id, owner=owner)
    return await queued(request, asked, key, require=advisable)


@ROUTES.get(
    "/{id}/advice", response_model=PageView[JobView], summary="List advice for a program"
)
async def advice_of(
    request: Request, data_folder: InDataFolder, cursor: OnPage, id: Id
) -> Response:
    """List the advice jobs of a program, newest first."""
    await answered(programs.get, data_folder, id)
    return await jobs_reply(request, data_folder, cursor, kind=JobKind.ADVICE, program=id)


def samples() -> list[str]:
    """Return the names of the sample programs."""
    return sorted(path.stem for path in EXAMPLES.glob("*.stpnc"))


def _sample(name: Name) -> bytes:
    if name not in samples():
        raise Unreadable(f"no sample '{name}'; known: {', '.join(samples()) or 'none'}")
    return read_bytes(EXAMPLES / f"{name}.stpnc")


def _kind(data: bytes, name: str) -> ProgramKind:
    """Tell the kind of a program; refuse bytes that are neither NC code nor a Part 21 file."""
    kind = kind_of(data)
    if kind is ProgramKind.STEP_NC:
        Part21File.from_bytes(data, name=name)
    return kind


def _answers(request: Request) -> CheckCache:
    """Return the cache of recent findings, created by the first request."""
    state = request.app.state
    if not hasattr(state, "findings"):
        state.findings = CheckCache()
    found: CheckCache = state.findings
    return found


def _contents(data_folder: DataFolder, stored: StoredProgram, units: Units) -> bytes:
    """Check a stored program and return the findings as JSON bytes.

    Raises
    ------
    NotFound
        When the program was deleted meanwhile.
    """
    file = data_folder.program_file(stored.id)
    try:
        if stored.kind is ProgramKind.NC_CODE:
            return checked_code(file, name=stored.name)
        found = check(CheckRequest(units=units), CheckFiles(file=file, name=stored.name))
        return dump(found.record()).encode()
    except StepNcError:
        programs.require_file(data_folder, stored.id)
        raise


async def _body(request: Request) -> bytes:
    """Read the request body, unpacked, up to the size limit."""
    bound = settings_of(request).upload_bytes
    return b"".join([part async for part in pieces(request, what="the program", bound=bound)])
