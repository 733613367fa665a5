"""ASGI application of the service: routes, access check, problem replies, OpenAPI document."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Any

import structlog
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.openapi.utils import get_openapi
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException

from service.extra_parts import declared
from service.knowledge.verbs import require_usable
from service.monitor.monitor import MonitorSet
from service.processes import log_lines
from service.processes.lifeline import end_with_parent
from service.rest import (
    advice,
    comparisons,
    files,
    health,
    jobs,
    knowledge,
    library,
    live,
    monitors,
    pages,
    programs,
    simulations,
)
from service.rest.access import AccessMiddleware
from service.rest.context import PROBLEMS
from service.rest.replies import problem_reply
from service.rest.resource import routes_of
from service.rest.resources import RESOURCES
from service.rest.rights import is_protected, role_for
from service.rest.settings import Settings, handed_on
from service.rest.streams import StreamHub
from service.storage.folder import DataFolder, known_data_folder, open_data_folder
from service.storage.library import LibrarySection
from service.web.problem import plain_problem, problem_of, retry_after
from stepnc_model.errors import StepNcError

LOG = structlog.get_logger("app")

TITLE = "stepnc-optimiser"
BY_KIND = "planner; for trials and controlled runs operator"

ABOUT = """Optimise the feeds of STEP-NC programs within the limits of machine, tool and part;
run programs on a virtual machine and under force control; learn from the outcomes.

Field names carry their units. Long work is a job: the answer is 202 with its location; poll it,
watch its events, or cancel it. Problems follow RFC 9457. Lists come in pages with a
cursor. Answers to GET have an ETag. A POST that repeats an `Idempotency-Key` has no second
effect."""


def application(settings: Settings) -> FastAPI:
    """Create the application of the service on a data folder.

    Raises
    ------
    ServiceError, KnowledgeError
        When the data folder or the knowledge base cannot be used.
    """
    data_folder = open_data_folder(
        settings.root,
        knowledge=settings.knowledge,
        database=settings.database,
        files=settings.files,
    )
    return _on(data_folder, settings)


def _on(data_folder: DataFolder, settings: Settings) -> FastAPI:
    if reason := require_usable(data_folder.knowledge):
        LOG.warning("only reading is possible", reason=reason)
    app = _routed()
    app.state.data_folder, app.state.settings, app.state.hub = (
        data_folder,
        settings,
        StreamHub(data_folder),
    )
    app.state.advice = advice.AdviceCache()
    app.state.monitors = MonitorSet(settings.agents)
    app.state.background = [task for add in declared("rest", "ADDED") for task in add(app)]
    app.add_middleware(AccessMiddleware, settings=settings, data_folder=data_folder)
    return app


def openapi() -> dict[str, Any]:
    """Return the OpenAPI document without starting the service."""
    return described(_routed())


def _routed() -> FastAPI:
    """Create the application with its routes and error handlers."""
    app = FastAPI(
        title=TITLE,
        description=ABOUT,
        version="1",
        lifespan=_living,
        docs_url=None,
        redoc_url=None,
        openapi_url="/v1/openapi.json",
        responses=PROBLEMS,
    )
    # The most frequently used first: routes are tried in this order.
    for routes in (
        advice.ROUTES, jobs.ROUTES, *map(routes_of, RESOURCES), live.ROUTES, programs.ROUTES,
        comparisons.ROUTES, simulations.ROUTES, *declared("rest", "ROUTES"),
        files.ROUTES, knowledge.CORRECTIONS, knowledge.OUTCOMES,
        *map(library.routes_of, LibrarySection), monitors.ROUTES,
        health.ROUTES, pages.ROUTES,
    ):  # fmt: skip
        app.include_router(routes)
    app.router.routes.insert(0, advice.LookUpRoute())
    app.add_exception_handler(StepNcError, _project)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http)
    app.openapi = lambda: described(app)  # type: ignore[method-assign]
    return app


@asynccontextmanager
async def _living(app: FastAPI) -> AsyncIterator[None]:
    """Monitor machines while the service runs; close all streams when it stops."""
    app.state.monitors.start()
    tasks = [asyncio.create_task(work()) for work in app.state.background]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task
        await app.state.hub.close()
        await run_in_threadpool(app.state.monitors.stop)


def from_environment() -> FastAPI:
    """Create the application of a worker process; its parent has made the data folder."""
    settings = handed_on()
    log_lines.configure(settings.level)
    end_with_parent()
    return _on(known_data_folder(settings.address), settings)


def described(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI document, including the role that each route needs."""
    if app.openapi_schema:
        return app.openapi_schema
    found = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes
    )
    found["components"]["securitySchemes"] = {"key": {"type": "http", "scheme": "bearer"}}
    for path, methods in found["paths"].items():
        for method, operation in methods.items():
            if is_protected(path):
                role = role_for(method.upper(), path)
                operation["security"] = [{"key": []}]
                operation["x-role"] = BY_KIND if role is None else role.value
    app.openapi_schema = found
    return found


async def _project(request: Request, error: Exception) -> Response:
    """Reply with the problem for an error of the project."""
    if not isinstance(error, StepNcError):
        raise error
    hidden = str(request.app.state.data_folder.files)
    reply = problem_reply({**problem_of(error, hidden=hidden), "instance": request.state.id})
    wait = retry_after(error)
    if wait is not None:
        reply.headers["retry-after"] = str(wait)
    return reply


async def _invalid(request: Request, error: Exception) -> Response:
    """Reply with the problem for an invalid request body or parameter."""
    if not isinstance(error, RequestValidationError):
        raise error
    if media_type := _foreign_media_type(request, error):
        detail = f"the body must be application/json, but is '{media_type}'"
        problem = plain_problem(
            415, "Unsupported media type", detail, instance=request.state.id
        )
        return problem_reply(problem)
    broken = [one for one in error.errors() if one["type"] == "json_invalid"]
    if broken:
        position, why = broken[0]["loc"][-1], broken[0]["ctx"]["error"]
        detail = f"the body is not valid JSON: {why} at character {position}"
        problem = plain_problem(400, "Malformed JSON", detail, instance=request.state.id)
        return problem_reply(problem)
    wrong = [
        {"place": ".".join(str(each) for each in one["loc"]), "message": one["msg"]}
        for one in error.errors()
    ]
    detail = "; ".join(f"{each['place']}: {each['message']}" for each in wrong)
    problem = plain_problem(
        422, "Invalid request", detail, errors=wrong, instance=request.state.id
    )
    return problem_reply(problem)


def _foreign_media_type(request: Request, error: RequestValidationError) -> str:
    """Return the media type of a body that was not parsed as JSON; empty if that is fine."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    is_json = media_type == "application/json" or media_type.endswith("+json")
    is_whole = any(
        one["loc"] == ("body",) and one["type"] != "missing" for one in error.errors()
    )
    return "" if is_json or not is_whole else media_type or "unknown"


async def _http(request: Request, error: Exception) -> Response:
    """Reply with the problem for errors of the framework: unknown path, method not allowed."""
    if not isinstance(error, HTTPException):
        raise error
    if isinstance(error.__cause__, StepNcError):
        # Raised while the body was read: the framework wraps it as an unparsable body.
        return await _project(request, error.__cause__)
    title = {404: "Not found", 405: "Method not allowed"}.get(error.status_code, "Refused")
    problem = plain_problem(
        error.status_code, title, str(error.detail), instance=request.state.id
    )
    reply = problem_reply(problem)
    reply.headers.update(error.headers or {})
    return reply
