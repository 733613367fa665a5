"""Routes of ``/v1/files``: logs of machines, tool tables, required parts and stocks."""

from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.files import naming
from service.rest.bodies import Id
from service.rest.checks import in_turn
from service.rest.context import (
    ByOwner,
    IdempotencyHeader,
    InDataFolder,
    OnPage,
    fetched,
    idempotency_of,
    page_reply,
    settings_of,
)
from service.rest.replies import file_reply, json_reply, moment
from service.rest.storage_queries import answered
from service.rest.upload_content import require_content
from service.rest.uploads import pieces
from service.rest.views import PageView, View
from service.storage import files
from service.storage.files import FileKind, FileUpload, StoredFile

ROUTES = APIRouter(prefix="/v1/files", tags=["verifications"])

LARGEST_TOOLS = 1 << 20
"""Largest tool table, in bytes."""

BYTES = "application/octet-stream"

OF_BODY = {
    "requestBody": {
        "required": True,
        "description": "the bytes of the file; may be packed with gzip",
        "content": {BYTES: {"schema": {"type": "string", "format": "binary"}}},
    }
}


class FileView(View):
    """Uploaded file: a log, a tool table or a required part."""

    id: str
    kind: FileKind
    name: str
    size_bytes: int
    sha256: str
    owner: str
    created_at: str


def file_view(stored: StoredFile) -> dict[str, Any]:
    """Return a stored file as a :class:`FileView`."""
    return {
        "id": stored.id,
        "kind": stored.kind.value,
        "name": stored.name,
        "size_bytes": stored.size,
        "sha256": stored.sha256,
        "owner": stored.owner,
        "created_at": moment(stored.created),
    }


@ROUTES.post("", status_code=201, response_model=FileView, summary="Upload a file",
             openapi_extra=OF_BODY)  # fmt: skip
async def upload(
    request: Request,
    data_folder: InDataFolder,
    owner: ByOwner,
    name: Annotated[
        str,
        Query(
            min_length=1,
            max_length=200,
            description="name of the file; its suffix says how it is read",
            examples=["run.parquet"],
        ),
    ],
    kind: Annotated[FileKind, Query(description="what the file is")] = FileKind.LOG,
    key: IdempotencyHeader = None,
) -> Response:
    """Store a log, a tool table, a required part or a stock.

    Logs: .parquet, .csv, .xml, .shdr. Tool tables: .toml, .csv, LinuxCNC's .tbl, libraries of
    Fusion (.json, .tools) and HSMWorks (.hsmlib). Required parts and stocks: .stl, .step,
    .stp; the job that uses a stock reads its part.
    """
    bound = LARGEST_TOOLS if kind is FileKind.TOOLS else settings_of(request).upload_bytes
    with FileUpload(data_folder, kind, name) as taken:
        async for part in pieces(request, what=f"the {kind.words}", bound=bound):
            await run_in_threadpool(taken.write, part)
        if not taken.size:
            raise Unreadable("the body is empty: send the bytes of the file")
        await run_in_threadpool(taken.close)
        with naming({taken.path: taken.name}):
            await in_turn(partial(require_content, kind, taken.path))
        idempotency = idempotency_of(request, key, taken.sha256.encode())
        stored = await run_in_threadpool(taken.keep, owner=owner, idempotency=idempotency)
    headers = {"location": f"/v1/files/{stored.id}"}
    return json_reply(request, file_view(stored), status=201, headers=headers)


@ROUTES.get("", response_model=PageView[FileView], summary="List files, newest first")
async def list_files(
    request: Request,
    data_folder: InDataFolder,
    cursor: OnPage,
    kind: Annotated[FileKind | None, Query(description="only files of this kind")] = None,
) -> Response:
    """List uploaded files page by page."""
    page = await answered(files.listed, data_folder, cursor, kind=kind)
    return page_reply(request, page, [file_view(each) for each in page.items])


@ROUTES.get("/{id}", response_model=FileView, summary="Show a file")
async def file(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show name, kind and size of an uploaded file."""
    return json_reply(request, file_view(await answered(files.get, data_folder, id)))


@ROUTES.get("/{id}/content", summary="Download a file as it was uploaded",
            response_class=Response, responses={200: {"content": {BYTES: {}}}})  # fmt: skip
async def content(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download an uploaded file, byte for byte."""
    stored = await answered(files.get, data_folder, id)
    return file_reply(
        request,
        await fetched(data_folder, files.file_of(data_folder, stored)),
        name=stored.name,
        kind=BYTES,
        thing=f"content of {stored.kind.words}",
        tag=f'"{stored.sha256}"',
    )


@ROUTES.delete("/{id}", status_code=204, summary="Delete a file")
async def delete(data_folder: InDataFolder, id: Id) -> Response:
    """Delete a file; verifications made with it are kept."""
    await run_in_threadpool(files.remove, data_folder, id)
    return Response(status_code=204)
