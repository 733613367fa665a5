"""Routes of ``/v1/machines`` and ``/v1/materials``: built-in library and data of the shop."""

import json
from typing import Annotated

import orjson
from fastapi import APIRouter, Path, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.rendering.columns import dump
from service.rest.context import InDataFolder
from service.rest.replies import json_reply, matches, tag_of, tagged
from service.rest.views import EntryView
from service.storage import library
from service.storage.library import (
    NAME,
    Condition,
    LibraryEntry,
    LibraryListing,
    LibrarySection,
)
from service.verbs.library import entry_record

Known = Annotated[str, Path(max_length=200)]
Own = Annotated[str, Path(pattern=NAME)]

TOML = {
    "requestBody": {
        "required": True,
        "description": "a TOML file as in the library, units in its keys; a machine may be XML",
        "content": {"application/toml": {"schema": {"type": "string"}}},
    }
}


def routes_of(section: LibrarySection) -> APIRouter:
    """Return the routes of a section of the library."""
    thing, place = section.one, section.value
    routes = APIRouter(prefix=f"/v1/{place}", tags=["library"])

    @routes.get(
        "", response_model=list[EntryView], summary=f"List {place}", name=place,
        description=f"List all {place} by name; one with an unreadable file says why.",
    )  # fmt: skip
    async def entries(request: Request, data_folder: InDataFolder) -> Response:
        found = await run_in_threadpool(library.entries_of, data_folder, section)
        return json_reply(request, [_view(each) for each in found])

    @routes.get("/{name}", summary=f"Show a {thing}", name=thing)
    async def entry(request: Request, data_folder: InDataFolder, name: Known) -> Response:
        """Show all values in canonical units: mm, s, N, W, rev/s."""
        held = await run_in_threadpool(library.one, data_folder, section, name)
        record = json.loads(dump(entry_record(held.entry)))
        shown = orjson.dumps({**record, "name": name, "is_own": held.is_own})
        if not held.is_own:
            return json_reply(request, shown)
        # The tag of the file, so that a client that has read it may change it with If-Match.
        return tagged(request, shown, tag_of(held.text))

    @routes.put("/{name}", summary=f"Store a {thing} of the shop", name=f"put_{thing}",
                openapi_extra=TOML, response_model=EntryView)  # fmt: skip
    async def put(request: Request, data_folder: InDataFolder, name: Own) -> Response:
        """Store a valid file; with If-Match, only if the stored one is unchanged."""
        data = await request.body()
        if not data:
            raise Unreadable("the body is empty: send the bytes of the file")
        kept = await run_in_threadpool(
            library.put, data_folder, section, name, data, condition=_condition(request)
        )
        return json_reply(request, _view(kept), headers={"etag": tag_of(data)})

    @routes.delete("/{name}", status_code=204, summary=f"Delete a {thing} of the shop",
                   name=f"delete_{thing}")  # fmt: skip
    async def delete(request: Request, data_folder: InDataFolder, name: Own) -> Response:
        """Delete what the shop has stored; the library itself stays. Honours If-Match."""
        await run_in_threadpool(
            library.remove, data_folder, section, name, condition=_condition(request)
        )
        return Response(status_code=204)

    return routes


def _view(item: LibraryEntry | LibraryListing) -> dict[str, object]:
    if isinstance(item, LibraryEntry):
        title, problem = item.entry.title, ""
    else:
        title, problem = item.title, item.problem
    return {
        "name": item.name,
        "title": title,
        "is_own": item.is_own,
        "problem": problem or None,
    }


def _condition(request: Request) -> Condition:
    """Return the check of the If-Match header, RFC 9110 §13.1.1."""
    asked = request.headers.get("if-match")

    def is_met(text: bytes | None) -> bool:
        return asked is None or (text is not None and matches(asked, tag_of(text)))

    return is_met
