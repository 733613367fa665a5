"""The application: routes, gate, problems, the OpenAPI document."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.openapi.utils import get_openapi
from starlette.exceptions import HTTPException

from kbe.store import open_store
from service.errors import TooMany
from service.lifeline import end_with_parent
from service.problem import plain_problem, problem_of
from service.rest import (
    advice,
    health,
    jobs,
    knowledge,
    library,
    live,
    logs,
    pages,
    programs,
    simulations,
)
from service.rest.access import AccessMiddleware
from service.rest.context import PROBLEMS
from service.rest.replies import problem_reply
from service.rest.rights import is_protected, role_for
from service.rest.settings import Settings, handed_on
from service.rest.streams import StreamHub
from service.storage.folder import DataFolder, known_data_folder, open_data_folder
from stepnc_model.errors import StepNcError

TITLE = "stepnc-optimiser"
BY_KIND = "planner; for trials and runs under control operator"

ABOUT = """Feeds of STEP-NC programs, optimal within the limits of machine, tool and part; runs
on a virtual machine; runs under a force loop; and what was learned from them.

Names of fields carry their units. Long work is a job: the answer is 202 with its place; look
at it, watch its events, cancel it. Problems are told as in RFC 9457. Lists come in pages with a
cursor. Answers to GET have an ETag. A POST with an `Idempotency-Key` makes nothing twice."""


def application(settings: Settings) -> FastAPI:
    """A service on a data folder.

    Raises
    ------
    ServiceError, KnowledgeError
        When folder or knowledge base cannot be used.
    """
    return _on(open_data_folder(settings.root, knowledge=settings.knowledge), settings)


def _on(data_folder: DataFolder, settings: Settings) -> FastAPI:
    with open_store(data_folder.knowledge):
        """made when it is new"""
    app = _routed()
    app.state.data_folder, app.state.settings, app.state.hub = (
        data_folder,
        settings,
        StreamHub(data_folder),
    )
    app.state.advice = advice.AdviceCache()
    app.add_middleware(AccessMiddleware, settings=settings, data_folder=data_folder)
    return app


def openapi() -> dict[str, Any]:
    """The OpenAPI document, without a service."""
    return described(_routed())


def _routed() -> FastAPI:
    """Routes and what becomes of errors."""
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
    # The most frequent first: routes are tried in their order.
    for routes in (
        advice.ROUTES, jobs.ROUTES, live.CONTROL, live.TRIALS, programs.ROUTES,
        simulations.ROUTES, knowledge.EVALUATIONS, knowledge.REVIEWS, knowledge.CORRECTIONS,
        knowledge.OUTCOMES, library.MACHINES, library.MATERIALS, health.ROUTES, pages.ROUTES,
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
    """From start to end: streams do not outlive the service."""
    yield
    await app.state.hub.close()


def from_environment() -> FastAPI:
    """The application of a process that was started by another, which has made the folder."""
    settings = handed_on()
    logs.configure(settings.level)
    end_with_parent()
    return _on(known_data_folder(settings.root, knowledge=settings.knowledge), settings)


def described(app: FastAPI) -> dict[str, Any]:
    """The OpenAPI document, with the role that each route needs."""
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
    """An error of the project's tree."""
    if not isinstance(error, StepNcError):
        raise error
    root = str(request.app.state.data_folder.root)
    reply = problem_reply({**problem_of(error, hidden=root), "instance": request.state.id})
    if isinstance(error, TooMany):
        reply.headers["retry-after"] = str(int(error.wait) + 1)
    return reply


async def _invalid(request: Request, error: Exception) -> Response:
    """A body or a parameter that is not what it should be."""
    if not isinstance(error, RequestValidationError):
        raise error
    if media_type := _foreign_media_type(request, error):
        detail = f"the body must be application/json and is '{media_type}'"
        problem = plain_problem(
            415, "Unsupported media type", detail, instance=request.state.id
        )
        return problem_reply(problem)
    broken = [one for one in error.errors() if one["type"] == "json_invalid"]
    if broken:
        position, why = broken[0]["loc"][-1], broken[0]["ctx"]["error"]
        detail = f"the body is no JSON: {why} at character {position}"
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
    """Media type of a body that was not read as JSON for it; empty where that is no fault."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    is_json = media_type == "application/json" or media_type.endswith("+json")
    is_whole = any(
        one["loc"] == ("body",) and one["type"] != "missing" for one in error.errors()
    )
    return "" if is_json or not is_whole else media_type or "unknown"


async def _http(request: Request, error: Exception) -> Response:
    """Problem for errors of the framework: unknown path, method not allowed."""
    if not isinstance(error, HTTPException):
        raise error
    if isinstance(error.__cause__, StepNcError):
        # Met while the body was read: the framework tells it as a body that cannot be parsed.
        return await _project(request, error.__cause__)
    title = {404: "Not found", 405: "Method not allowed"}.get(error.status_code, "Refused")
    problem = plain_problem(
        error.status_code, title, str(error.detail), instance=request.state.id
    )
    reply = problem_reply(problem)
    reply.headers.update(error.headers or {})
    return reply
