"""Routes for operators of the service: health checks, metrics, version."""

from typing import Any

from fastapi import APIRouter, Request, Response

from service.errors import ServiceError
from service.jobs.runner import is_alive
from service.live.storage import has_room
from service.rest.asking import answered
from service.rest.context import data_folder_of, owner_of, settings_of
from service.rest.metrics import JOBS, TYPE, exposition
from service.rest.programs import samples
from service.rest.replies import json_reply
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import JobState

ROUTES = APIRouter(tags=["service"])


@ROUTES.get("/healthz", summary="Check that the process answers")
async def healthz(request: Request) -> Response:
    """Confirm that the process answers."""
    return json_reply(request, {"status": "ok"})


@ROUTES.get("/readyz", summary="Check that requests can be served")
async def readyz(request: Request) -> Response:
    """Report whether the database answers, a runner lives and the disk has room; else 503."""
    found = await answered(_state, data_folder_of(request))
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


def _state(data_folder: DataFolder) -> dict[str, Any]:
    is_roomy = has_room(data_folder.root)
    try:
        return {"database": True, "runner": is_alive(data_folder), "room": is_roomy}
    except ServiceError:
        return {"database": False, "runner": False, "room": is_roomy}
