"""Routes of ``/v1/advice``: advised feeds, the optimised program, NC code and the report.

Machines and panels ask for single workingsteps again and again. Results never change once they
are written, so their parts are cached as bytes.
"""

import os
import time
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any

import orjson
from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool
from starlette.routing import Match, Route
from starlette.types import Scope

from service.errors import Conflict, NotFound
from service.jobs.task import optimised_name
from service.requests.fields import loaded
from service.requests.program_facts import GIVEN
from service.rest.advice_views import AdviceView, AdvisedView, CodeAdviceView, CurvesView
from service.rest.bodies import Id
from service.rest.checks import in_turn
from service.rest.context import InDataFolder, data_folder_of
from service.rest.replies import (
    JSON,
    PreparedResponse,
    file_reply,
    matches,
    tag_of,
    tagged,
)
from service.rest.storage_queries import answered, result_file
from service.storage import jobs, programs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobState
from service.storage.results import CURVES, FEEDS, NC_CODE, OPTIMISED, RESULT
from stepnc_model.post.dialect import SUFFIXES, Dialect

if TYPE_CHECKING:
    from service.verbs.post.request import PostRequest

ROUTES = APIRouter(prefix="/v1/advice", tags=["advice"])

OtherControl = Annotated[
    Dialect | None,
    Query(alias="control", description="control to write the code for; default: as requested"),
]

CSV = "text/csv; charset=utf-8"

KEPT = 5.0
"""Time for which a result of a store of files is answered from the cache, in s."""

MOST_READY = 64
"""Largest number of results whose parts are cached."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CachedAnswer:
    """Prepared answer with its entity tag, and the 304 answer for clients that have it."""

    tag: bytes
    whole: PreparedResponse
    same: PreparedResponse

    def reply(self, request: Request) -> Response:
        """Return the full answer, or 304 if the client has it already."""
        for name, value in request.scope["headers"]:
            if name == b"if-none-match" and matches(value.decode("latin-1"), self.tag.decode()):
                return self.same
        return self.whole


@dataclass(frozen=True, slots=True, kw_only=True)
class CachedAdvice:
    """Result of an advice job as prepared answers."""

    file: str
    stamp: int
    """Modification time of the result file, in ns."""
    whole: CachedAnswer
    workingsteps: dict[str, CachedAnswer]
    """Answers by workingstep id and by instance."""
    result: dict[str, Any]
    since: float
    """Time when it was read, in s."""


class AdviceCache:
    """Cache of recently requested results. Running state."""

    def __init__(self) -> None:
        self._ready: OrderedDict[str, CachedAdvice] = OrderedDict()

    def get(self, data_folder: DataFolder, id: str) -> CachedAdvice:
        """Return a result from the cache, or read it.

        Raises
        ------
        NotFound, Conflict
            When the advice does not exist, or has no result yet.
        """
        return self.ready(data_folder, id) or self._read(data_folder, id)

    def ready(self, data_folder: DataFolder, id: str) -> CachedAdvice | None:
        """Return a result from the cache; None if it has to be read. Asks no database."""
        known = self._ready.get(id)
        if known is None or (data_folder.store is not None and _is_old(known)):
            # Its file stays here when another host of a store has deleted the advice.
            return None
        try:
            is_same = os.stat(known.file).st_mtime_ns == known.stamp
        except OSError:
            is_same = False
        if not is_same:
            self._ready.pop(id, None)
            return None
        with suppress(KeyError):
            # Another thread may have dropped it.
            self._ready.move_to_end(id)
        return known

    def _read(self, data_folder: DataFolder, id: str) -> CachedAdvice:
        file = _file(data_folder, id)
        try:
            stamp = os.stat(file).st_mtime_ns
            jobs.get(data_folder, id, JobKind.ADVICE)
            known = self._ready[id] = _ready(file, stamp)
        except OSError:
            raise _missing(data_folder, id) from None
        while len(self._ready) > MOST_READY:
            self._ready.popitem(last=False)
        return known


def _is_old(known: CachedAdvice) -> bool:
    return time.monotonic() - known.since > KEPT


def _file(data_folder: DataFolder, id: str) -> str:
    return str(data_folder.fetched(data_folder.job_folder(id) / RESULT))


def _ready(file: str, stamp: int) -> CachedAdvice:
    whole = Path(file).read_bytes()
    result = orjson.loads(whole)
    parts: dict[str, CachedAnswer] = {}
    for step in result.get("workingsteps", ()):
        part = _part(orjson.dumps(step))
        for name in (step["instance"], step["id"]):
            parts.setdefault(name, part)
    return CachedAdvice(
        file=file, stamp=stamp, whole=_part(whole), workingsteps=parts, result=result,
        since=time.monotonic(),
    )  # fmt: skip


def _part(body: bytes) -> CachedAnswer:
    tag = tag_of(body).encode()
    common = [(b"etag", tag), (b"cache-control", b"no-cache")]
    kind, length = (b"content-type", JSON.encode()), str(len(body)).encode()
    return CachedAnswer(
        tag=tag,
        whole=PreparedResponse(200, body, [*common, kind, (b"content-length", length)]),
        same=PreparedResponse(304, b"", common),
    )


def _missing(data_folder: DataFolder, id: str) -> Exception:
    """Return the error that explains why there is no result."""
    job = jobs.get(data_folder, id, JobKind.ADVICE)
    if job.state in {JobState.QUEUED, JobState.RUNNING}:
        return Conflict(f"advice '{id}' is {job.state.value}: try again, or see its job")
    if job.state is JobState.SUCCEEDED:
        return Conflict(f"advice '{id}' had no result yet, or has lost it: try again")
    return Conflict(f"advice '{id}' has {job.state.value}: its job says why")


async def cached_advice(request: Request, id: str) -> CachedAdvice:
    """Return a result; in most cases from the cache, without a thread."""
    cache: AdviceCache = request.app.state.advice
    data_folder = data_folder_of(request)
    ready = cache.ready(data_folder, id)
    if ready is not None:
        return ready
    return await answered(cache.get, data_folder, id)


@ROUTES.get(
    "/{id}/workingsteps/{workingstep}",
    response_model=AdvisedView,
    summary="Advised feed of one workingstep, with its reason",
)
async def advised(request: Request, id: str, workingstep: str) -> Response:
    """Show the advice for a workingstep, by its id or its instance number without ``#``."""
    parts = (await cached_advice(request, id)).workingsteps
    found = parts.get(workingstep) or parts.get(f"#{workingstep}")
    if found is None:
        raise NotFound("workingstep", workingstep)
    return found.reply(request)


class LookUpRoute(Route):
    """Route of a single workingstep's advice without the framework's slower parameter parsing.

    It precedes all other routes; the OpenAPI document describes the route above.
    """

    def __init__(self) -> None:
        super().__init__(f"{ROUTES.prefix}/{{id}}/workingsteps/{{workingstep}}", _look_up)

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Match as any route does, and name the route for the metrics."""
        match, child = super().matches(scope)
        return match, {**child, "route": self}


async def _look_up(request: Request) -> Response:
    return await advised(request, **request.path_params)


@ROUTES.get("/{id}", response_model=AdviceView | CodeAdviceView, summary="Show advice")
async def advice(request: Request, id: Id) -> Response:
    """Show all workingsteps with programmed and advised feed, limits and reason.

    Advice on NC code has the parts of the program by tool, with feeds along their paths.
    """
    return (await cached_advice(request, id)).whole.reply(request)


@ROUTES.get(
    "/{id}/file",
    summary="Download the optimised program",
    response_class=Response,
    responses={200: {"content": {"application/step": {}}}},
)
async def optimised(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the uploaded program with the advised feeds; nothing else is changed.

    NC code that was rewritten is at ``nc``.
    """
    result = (await cached_advice(request, id)).result
    if _is_code(result):
        raise NotFound("optimised STEP-NC program (the advice is on NC code)", id)
    name = _name(result, ".stpnc")
    file = await result_file(data_folder, id, OPTIMISED)
    return file_reply(
        request, file, name=name, kind="application/step", thing="optimised program"
    )


@ROUTES.get(
    "/{id}/nc",
    summary="Download NC code with the advised feeds",
    response_class=Response,
    responses={200: {"content": {"text/plain": {}}}},
)
async def nc_code(
    request: Request, data_folder: InDataFolder, id: Id, wanted: OtherControl = None
) -> Response:
    """Download NC code for the control of the request or for another, or the rewritten code."""
    result = (await cached_advice(request, id)).result
    control = result["nc_control"]
    if wanted is not None and wanted.value != control:
        return await _posted(data_folder, id, wanted, result)
    if control is None:
        raise NotFound("NC code (name a control)", id)
    own = Path(programs.shown_name(result["program"])).suffix
    name = _name(result, own if _is_code(result) else SUFFIXES[Dialect(control)])
    file = await result_file(data_folder, id, NC_CODE)
    return file_reply(
        request, file, name=name, kind="text/plain; charset=utf-8", thing="NC code"
    )


async def _posted(
    data_folder: DataFolder, id: str, control: Dialect, result: dict[str, Any]
) -> Response:
    """Return NC code of the optimised program for a control, as the verb ``post`` writes it."""
    if _is_code(result):
        raise Conflict("the advice is on NC code, which is rewritten for its own control alone")
    if result.get("along_path") is not None:
        raise Conflict("feeds along the paths are written for the control of the request alone")
    job = await answered(jobs.get, data_folder, id, JobKind.ADVICE)
    program = (
        await result_file(data_folder, id, OPTIMISED)
        if result["is_written"]
        else data_folder.program_file(job.program)
    )

    def code() -> bytes:
        from service.verbs.post.request import PostFiles  # noqa: PLC0415 (numpy)
        from service.verbs.post.run import run  # noqa: PLC0415 (numpy)

        with TemporaryDirectory() as folder:
            output = Path(folder) / f"program{control.suffix}"
            run(
                _post_request(job.request, control),
                PostFiles(file=data_folder.fetched(program), output=output),
            )
            return output.read_bytes()

    name = _name(result, SUFFIXES[control])
    return Response(
        await in_turn(code),
        media_type="text/plain; charset=utf-8",
        headers={"content-disposition": f'attachment; filename="{name}"'},
    )


def _post_request(words: Mapping[str, Any], control: Dialect) -> "PostRequest":
    """Return the request of ``post`` with what the advice was told of the program."""
    from service.verbs.post.request import PostRequest  # noqa: PLC0415 (numpy)

    known = {name: words[name] for name in GIVEN if name in words}
    is_exact = bool(words.get("is_exact_path"))
    return loaded(PostRequest, {**known, "control": control.value, "exact_path": is_exact})


@ROUTES.get(
    "/{id}/feeds",
    summary="Download the feeds along the paths",
    response_class=Response,
    responses={200: {"content": {CSV: {}}}},
)
async def feeds(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Download the feeds of the changed blocks and their parts, with the active limits."""
    result = (await cached_advice(request, id)).result
    _require_along(result, id)
    name = f"{Path(programs.shown_name(result['program'])).stem}.feeds.csv"
    file = await result_file(data_folder, id, FEEDS)
    return file_reply(request, file, name=name, kind=CSV, thing="feeds along the paths")


@ROUTES.get("/{id}/curves", response_model=CurvesView, summary="Show curves before and after")
async def curves(request: Request, data_folder: InDataFolder, id: Id) -> Response:
    """Show feed, force and power of both runs along the path and over time.

    Each stretch of a curve has the minimum and the maximum within it.
    """
    result = (await cached_advice(request, id)).result
    _require_along(result, id)
    file = await result_file(data_folder, id, CURVES)
    try:
        body = await run_in_threadpool(file.read_bytes)
    except FileNotFoundError:
        raise NotFound("curves of advice", id) from None
    return tagged(request, body, tag_of(body))


def _is_code(result: dict[str, Any]) -> bool:
    """True if the advice is on NC code."""
    return "control" in result


def _require_along(result: dict[str, Any], id: str) -> None:
    """Refuse advice without feeds along the paths."""
    if result.get("along_path") is None:
        raise NotFound("feeds along the paths (ask for advice with is_along_path)", id)


def _name(result: dict[str, Any], suffix: str) -> str:
    """Return the file name of an optimised program, also after the program was deleted."""
    return optimised_name(programs.shown_name(str(result["program"])), suffix)
