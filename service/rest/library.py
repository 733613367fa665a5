"""Routes of ``/v1/machines`` and ``/v1/materials``: built-in library and data of the shop."""

import json
from typing import Annotated

import orjson
from fastapi import APIRouter, Path, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.rendering.records import dump
from service.rest.context import InDataFolder
from service.rest.replies import json_reply, matches, tag_of, tagged
from service.rest.views import EntryView
from service.storage import library
from service.storage.folder import DataFolder
from service.storage.library import (
    NAME,
    Condition,
    LibraryEntry,
    LibraryListing,
    LibrarySection,
)
from service.verbs.library import entry_record

MACHINES = APIRouter(prefix="/v1/machines", tags=["library"])
MATERIALS = APIRouter(prefix="/v1/materials", tags=["library"])

Known = Annotated[str, Path(max_length=200)]
Own = Annotated[str, Path(pattern=NAME)]

TOML = {
    "requestBody": {
        "required": True,
        "description": "a TOML file as in the library, units in its keys; a machine may be XML",
        "content": {"application/toml": {"schema": {"type": "string"}}},
    }
}


@MACHINES.get("", response_model=list[EntryView], summary="List machines")
async def machines(request: Request, data_folder: InDataFolder) -> Response:
    """List all machines by name; a machine of the shop with an unreadable file says why."""
    return await _all(request, data_folder, LibrarySection.MACHINES)


@MACHINES.get("/{name}", summary="Show a machine")
async def machine(request: Request, data_folder: InDataFolder, name: Known) -> Response:
    """Show a machine in canonical units: mm, s, N, W, rev/s."""
    return await _one(request, data_folder, LibrarySection.MACHINES, name)


@MACHINES.put("/{name}", summary="Store a machine of the shop", openapi_extra=TOML,
              response_model=EntryView)  # fmt: skip
async def put_machine(request: Request, data_folder: InDataFolder, name: Own) -> Response:
    """Store a valid machine file; with If-Match, only if the stored one is unchanged."""
    return await _put(request, data_folder, LibrarySection.MACHINES, name)


@MACHINES.delete("/{name}", status_code=204, summary="Delete a machine of the shop")
async def delete_machine(request: Request, data_folder: InDataFolder, name: Own) -> Response:
    """Delete a machine of the shop; library machines cannot be deleted. Honours If-Match."""
    return await _delete(request, data_folder, LibrarySection.MACHINES, name)


@MATERIALS.get("", response_model=list[EntryView], summary="List materials")
async def materials(request: Request, data_folder: InDataFolder) -> Response:
    """List all materials by name."""
    return await _all(request, data_folder, LibrarySection.MATERIALS)


@MATERIALS.get("/{name}", summary="Show a material")
async def material(request: Request, data_folder: InDataFolder, name: Known) -> Response:
    """Show a material in canonical units: mm, s, N, W, rev/s."""
    return await _one(request, data_folder, LibrarySection.MATERIALS, name)


@MATERIALS.put("/{name}", summary="Store a material of the shop", openapi_extra=TOML,
               response_model=EntryView)  # fmt: skip
async def put_material(request: Request, data_folder: InDataFolder, name: Own) -> Response:
    """Store a valid material file; with If-Match, only if the stored one is unchanged."""
    return await _put(request, data_folder, LibrarySection.MATERIALS, name)


@MATERIALS.delete("/{name}", status_code=204, summary="Delete a material of the shop")
async def delete_material(request: Request, data_folder: InDataFolder, name: Own) -> Response:
    """Delete a material of the shop; library materials cannot be deleted. Honours If-Match."""
    return await _delete(request, data_folder, LibrarySection.MATERIALS, name)


def _view(found: LibraryEntry | LibraryListing) -> dict[str, object]:
    if isinstance(found, LibraryEntry):
        title, problem = found.entry.title, ""
    else:
        title, problem = found.title, found.problem
    return {
        "name": found.name,
        "title": title,
        "is_own": found.is_own,
        "problem": problem or None,
    }


async def _all(request: Request, data_folder: DataFolder, section: LibrarySection) -> Response:
    found = await run_in_threadpool(library.entries_of, data_folder, section)
    return json_reply(request, [_view(each) for each in found])


async def _one(
    request: Request, data_folder: DataFolder, section: LibrarySection, name: str
) -> Response:
    held = await run_in_threadpool(library.one, data_folder, section, name)
    entry = json.loads(dump(entry_record(held.entry)))
    shown = orjson.dumps({**entry, "name": name, "is_own": held.is_own})
    if not held.is_own:
        return json_reply(request, shown)
    # The tag of the file, so that a client that has read it may change it with If-Match.
    return tagged(request, shown, tag_of(held.text))


async def _put(
    request: Request, data_folder: DataFolder, section: LibrarySection, name: str
) -> Response:
    data = await request.body()
    if not data:
        raise Unreadable("the body is empty: send the bytes of the file")
    kept = await run_in_threadpool(
        library.put, data_folder, section, name, data, condition=_condition(request)
    )
    return json_reply(request, _view(kept), headers={"etag": tag_of(data)})


async def _delete(
    request: Request, data_folder: DataFolder, section: LibrarySection, name: str
) -> Response:
    await run_in_threadpool(
        library.remove, data_folder, section, name, condition=_condition(request)
    )
    return Response(status_code=204)


def _condition(request: Request) -> Condition:
    """Return the check of the If-Match header, RFC 9110 §13.1.1."""
    asked = request.headers.get("if-match")

    def is_met(text: bytes | None) -> bool:
        return asked is None or (text is not None and matches(asked, tag_of(text)))

    return is_met
