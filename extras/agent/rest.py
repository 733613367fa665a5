"""The MTConnect agent of the service, mounted under ``/mtconnect``."""

from collections.abc import Awaitable, Callable, Coroutine, Mapping, Sequence
from typing import Any

from fastapi import FastAPI

from extras.agent.model.http import application
from extras.agent.run_routes import with_runs
from extras.agent.shop import ShopAgent
from service.rest.replies import problem_reply
from service.web.problem import plain_problem

BASE = "/mtconnect"

Receive = Callable[[], Awaitable[Mapping[str, Any]]]
Work = Callable[[], Coroutine[Any, Any, None]]
Send = Callable[[Mapping[str, Any]], Awaitable[None]]


def mount(app: FastAPI) -> Sequence[Work]:
    """Mount the agent; without one, say why there is none. Return what it does meanwhile.

    Several web processes would give different sequence numbers, so only a single one has the
    agent.
    """
    shop = ShopAgent(app.state.data_folder) if app.state.settings.has_agent else None
    served = None
    if shop is not None:
        served = application(shop.agent)
        if shop.repository is not None:
            served = with_runs(served, shop.repository)

    async def serve(scope: Mapping[str, Any], receive: Receive, send: Send) -> None:
        if served is None:
            problem = plain_problem(
                503,
                "Unavailable",
                "the agent needs a single web process: start the service with --workers 1",
            )
            await problem_reply(problem)(scope, receive, send)  # type: ignore[arg-type]
            return
        path = scope["path"].removeprefix(BASE) or "/"
        raw = (scope.get("raw_path") or b"").removeprefix(BASE.encode()) or b"/"
        await served({**scope, "path": path, "raw_path": raw, "root_path": ""}, receive, send)

    app.mount(BASE, serve)  # type: ignore[arg-type]
    return () if shop is None else (shop.run,)


ADDED = (mount,)
