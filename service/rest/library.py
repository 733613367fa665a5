"""``/v1/machines`` and ``/v1/materials``: those of the library, and the shop's own."""

import json
from typing import Annotated

import orjson
from fastapi import APIRouter, Path, Request, Response
from starlette.concurrency import run_in_threadpool

from service.depot import library
from service.depot.folder import Depot
from service.depot.library import NAME, Held, Shelf
from service.errors import Conflict, Unreadable
from service.rest.context import InDepot
from service.rest.replies import json_reply, matches, tag_of, tagged
from service.rest.views import EntryView
from service.wire import entry_json

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


@MACHINES.get("", response_model=list[EntryView], summary="All machines")
async def machines(request: Request, depot: InDepot) -> Response:
    """By name."""
    return await _all(request, depot, Shelf.MACHINES)


@MACHINES.get("/{name}", summary="One machine")
async def machine(request: Request, depot: InDepot, name: Known) -> Response:
    """In canonical units: mm, s, N, W, rev/s."""
    return await _one(request, depot, Shelf.MACHINES, name)


@MACHINES.put("/{name}", summary="Keep a machine of the shop", openapi_extra=TOML,
              response_model=EntryView)  # fmt: skip
async def put_machine(request: Request, depot: InDepot, name: Own) -> Response:
    """Refused unless it can be read; with If-Match, only if nobody has changed it since."""
    return await _put(request, depot, Shelf.MACHINES, name)


@MACHINES.delete("/{name}", status_code=204, summary="Delete a machine of the shop")
async def delete_machine(depot: InDepot, name: Own) -> Response:
    """Those of the library stay."""
    return await _delete(depot, Shelf.MACHINES, name)


@MATERIALS.get("", response_model=list[EntryView], summary="All materials")
async def materials(request: Request, depot: InDepot) -> Response:
    """By name."""
    return await _all(request, depot, Shelf.MATERIALS)


@MATERIALS.get("/{name}", summary="One material")
async def material(request: Request, depot: InDepot, name: Known) -> Response:
    """In canonical units."""
    return await _one(request, depot, Shelf.MATERIALS, name)


@MATERIALS.put("/{name}", summary="Keep a material of the shop", openapi_extra=TOML,
               response_model=EntryView)  # fmt: skip
async def put_material(request: Request, depot: InDepot, name: Own) -> Response:
    """As for machines."""
    return await _put(request, depot, Shelf.MATERIALS, name)


@MATERIALS.delete("/{name}", status_code=204, summary="Delete a material of the shop")
async def delete_material(depot: InDepot, name: Own) -> Response:
    """Those of the library stay."""
    return await _delete(depot, Shelf.MATERIALS, name)


def _view(held: Held) -> dict[str, object]:
    return {"name": held.name, "title": held.entry.title, "is_own": held.is_own}


async def _all(request: Request, depot: Depot, shelf: Shelf) -> Response:
    found = await run_in_threadpool(library.held, depot, shelf)
    return json_reply(request, [_view(each) for each in found])


async def _one(request: Request, depot: Depot, shelf: Shelf, name: str) -> Response:
    held = await run_in_threadpool(library.one, depot, shelf, name)
    entry = json.loads(entry_json(held.entry))
    shown = orjson.dumps({**entry, "name": name, "is_own": held.is_own})
    if not held.is_own:
        return json_reply(request, shown)
    # The tag of the file, so that who has looked may change it with If-Match.
    text = await run_in_threadpool(library.text_of, depot, shelf, name)
    return tagged(request, shown, tag_of(text))


async def _put(request: Request, depot: Depot, shelf: Shelf, name: str) -> Response:
    data = await request.body()
    if not data:
        raise Unreadable("the body is empty: send the file")
    condition = request.headers.get("if-match")
    if condition is not None:
        held = await run_in_threadpool(library.text_of, depot, shelf, name)
        if not matches(condition, tag_of(held)):
            raise Conflict(f"{shelf.one} '{name}' was changed meanwhile: read it again")
    kept = await run_in_threadpool(library.put, depot, shelf, name, data)
    return json_reply(request, _view(kept), headers={"etag": tag_of(data)})


async def _delete(depot: Depot, shelf: Shelf, name: str) -> Response:
    await run_in_threadpool(library.remove, depot, shelf, name)
    return Response(status_code=204)
