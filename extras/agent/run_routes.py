"""Routes of an agent's repository of runs, beside those of the agent.

``/runs`` lists runs, by machine, part, workingstep and time; ``/runs/{id}`` describes one;
``/runs/{id}/probe``, ``/current`` and ``/sample`` answer as the agent would if its buffer
held that run alone, with ``workingstep`` as another parameter of ``sample``.
"""

import asyncio
import json
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qsl, urlencode

from extras.agent.model.http import application
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from extras.agent.runs import KeptRun, RunRepository

Receive = Callable[[], Awaitable[Mapping[str, Any]]]
Send = Callable[[Mapping[str, Any]], Awaitable[None]]
Application = Callable[[Mapping[str, Any], Receive, Send], Awaitable[None]]

LOADED = 4
"""Runs that are held in memory for further requests."""

MOST_LISTED = 1000
"""Most runs in one list; the latest."""

FILTERS = frozenset({"machine", "part", "workingstep", "from", "to"})


def with_runs(app: Application, repository: "RunRepository") -> Application:
    """Return an application that serves an agent and its repository of runs."""
    loaded: OrderedDict[str, Application] = OrderedDict()

    async def serve(scope: Mapping[str, Any], receive: Receive, send: Send) -> None:
        parts = [part for part in str(scope.get("path", "")).split("/") if part]
        if scope["type"] != "http" or parts[:1] != ["runs"]:
            await app(scope, receive, send)
        elif scope["method"] not in {"GET", "HEAD"}:
            await _send(send, 405, {"error": "runs are read-only"})
        elif len(parts) == 1:
            await _list(repository, scope, send)
        else:
            run = await asyncio.to_thread(repository.run, parts[1])
            if run is None:
                await _send(send, 404, {"error": f"no run '{parts[1][:200]}'"})
            elif len(parts) == 2:
                await _send(send, 200, asdict(run))
            else:
                try:
                    own = await _application(repository, loaded, run.id)
                except StepNcError as error:
                    await _send(send, 500, {"error": str(error)})
                    return
                path = f"/{'/'.join(parts[2:])}"
                query = _query(scope, run)
                inner = {
                    **scope,
                    "path": path,
                    "raw_path": path.encode(),
                    "query_string": query,
                }
                await own(inner, receive, send)

    return serve


async def _application(
    repository: "RunRepository", loaded: OrderedDict[str, Application], id: str
) -> Application:
    """Return the application of a run's own agent, read from its file when it is new."""
    if id not in loaded:
        agent = await asyncio.to_thread(repository.load, id)
        loaded[id] = application(agent)
        if len(loaded) > LOADED:
            loaded.popitem(last=False)
    loaded.move_to_end(id)
    return loaded[id]


async def _list(repository: "RunRepository", scope: Mapping[str, Any], send: Send) -> None:
    words = dict(parse_qsl(scope.get("query_string", b"").decode("latin-1")))
    unknown = sorted(set(words) - FILTERS)
    if unknown:
        known = ", ".join(sorted(FILTERS))
        await _send(send, 400, {"error": f"unknown parameter '{unknown[0]}'; known: {known}"})
        return
    try:
        begin, end = (_moment(words.get(each)) for each in ("from", "to"))
    except ValueError:
        message = "'from' and 'to' must be times in ISO 8601, as 2026-03-02T08:00:00Z"
        await _send(send, 400, {"error": message})
        return
    found = [
        run
        for run in await asyncio.to_thread(repository.runs)
        if (begin is None or datetime.fromisoformat(run.end) >= begin)
        and (end is None or datetime.fromisoformat(run.begin) <= end)
        and words.get("machine", run.machine) == run.machine
        and words.get("part", run.part) == run.part
        and ("workingstep" not in words or _has(run, words["workingstep"]))
    ]
    await _send(send, 200, {"runs": [asdict(run) for run in found[:MOST_LISTED]]})


def _moment(text: str | None) -> datetime | None:
    if text is None:
        return None
    moment = datetime.fromisoformat(text)
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def _has(run: "KeptRun", workingstep: str) -> bool:
    return any(step.id == workingstep for step in run.workingsteps)


def _query(scope: Mapping[str, Any], run: "KeptRun") -> bytes:
    """Return the query for the run's own agent: a workingstep becomes ``from`` and ``to``."""
    query: bytes = scope.get("query_string", b"")
    words = parse_qsl(query.decode("latin-1"), keep_blank_values=True)
    wanted = dict(words).get("workingstep")
    step = next((step for step in run.workingsteps if step.id == wanted), None)
    if step is None:
        return query
    kept = [(key, value) for key, value in words if key != "workingstep"]
    given = {key for key, _ in kept}
    kept += [
        (key, str(value))
        for key, value in (("from", step.first), ("to", step.last))
        if key not in given
    ]
    return urlencode(kept).encode()


async def _send(send: Send, status: int, content: Mapping[str, Any]) -> None:
    body = json.dumps(content, ensure_ascii=False).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        (b"access-control-allow-origin", b"*"),
    ]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
