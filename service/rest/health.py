"""Routes for operators of the service: health checks, metrics, version."""

import asyncio
from collections.abc import Awaitable
from typing import TypeVar

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import ServiceError
from service.jobs.runner import is_alive
from service.live.journal import has_room
from service.rest.context import data_folder_of, owner_of, settings_of
from service.rest.metrics import JOBS, TYPE, exposition
from service.rest.programs import samples
from service.rest.replies import json_reply
from service.rest.storage_queries import answered
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import JobState

ROUTES = APIRouter(tags=["service"])

T = TypeVar("T")

READY = 5.0
"""Time within which a thread takes a task that is over at once, in s.

A process whose threads all hang in files or locks still answers ``/healthz``, which needs none.
"""

SILENT = {"database": False, "runner": False, "room": False}


@ROUTES.get("/healthz", summary="Check that the process answers")
async def healthz(request: Request) -> Response:
    """Confirm that the process answers."""
    return json_reply(request, {"status": "ok"})


@ROUTES.get("/readyz", summary="Check that requests can be served")
async def readyz(request: Request) -> Response:
    """Report whether database, threads, runner and disk do their work; 503 if not."""
    data_folder = data_folder_of(request)
    state, has_threads = await asyncio.gather(
        _in_time(answered(_state, data_folder), SILENT),
        _in_time(run_in_threadpool(lambda: True), False),
    )
    found = {**state, "threads": has_threads}
    return json_reply(request, found, status=200 if all(found.values()) else 503)


@ROUTES.get("/metrics", summary="Metrics for Prometheus", response_class=Response,
            responses={200: {"content": {"text/plain": {}}}})  # fmt: skip
async def metrics(request: Request) -> Response:
    """Return metrics: requests by route and status, durations, streams, jobs by state."""
    counts = await answered(jobs.counts, data_folder_of(request))
    for state in JobState:
        JOBS.labels(state.value).set(counts.get(state, 0))
    return Response(exposition(), media_type=TYPE)


@ROUTES.get("/v1/about", summary="Show version and settings of the service")
async def about(request: Request) -> Response:
    """Show what the dashboard needs: version, whether keys are required, samples, owner."""
    from importlib.metadata import version  # noqa: PLC0415 (used once a page)

    return json_reply(
        request,
        {
            "version": version("stepnc-optimiser"),
            "needs_keys": settings_of(request).needs_keys,
            "samples": samples(),
            "owner": owner_of(request),
        },
    )


def _state(data_folder: DataFolder) -> dict[str, bool]:
    is_roomy = has_room(data_folder.root)
    try:
        return {"database": True, "runner": is_alive(data_folder), "room": is_roomy}
    except ServiceError:
        return {**SILENT, "room": is_roomy}


async def _in_time(answer: Awaitable[T], otherwise: T) -> T:
    """Await an answer for the time that a thread may take to do nothing."""
    try:
        async with asyncio.timeout(READY):
            return await answer
    except TimeoutError:
        return otherwise
