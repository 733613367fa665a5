"""Path of the tool of a run on the virtual machine, which only ``/v1/simulations`` has."""

from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Request, Response

from service.errors import Conflict
from service.live.path import shown_path
from service.live.series import open_series
from service.rest.bodies import Id
from service.rest.context import InDataFolder
from service.rest.replies import json_reply
from service.rest.results import live_folder, read_in_turn
from service.rest.storage_queries import answered
from service.rest.views import PathView
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind

ROUTES = APIRouter(prefix="/v1/simulations", tags=["simulations"])

PATH_POINTS = 20_000

PathPoints = Annotated[int, Query(ge=100, le=50_000, description="most points of the path")]


@ROUTES.get("/{id}/path", response_model=PathView, summary="Path of the tool")
async def path(
    request: Request, data_folder: InDataFolder, id: Id, points: PathPoints = PATH_POINTS
) -> Response:
    """Show the tool path, thinned but with all corners and changes of feed and force."""
    job = await answered(jobs.get, data_folder, id, JobKind.SIMULATION)
    found = await read_in_turn(_path, data_folder, job, points)
    return json_reply(request, found)


def _path(data_folder: DataFolder, job: Job, points: int) -> dict[str, Any]:
    folder = live_folder(data_folder, job)
    series, status = open_series(folder.series), folder.read_status()
    if series is None or not len(series) or status is None:
        raise Conflict(f"{job.kind.value} '{job.id}' is {job.state.value}: it has no rows yet")
    found = shown_path(series, points)
    off, shown = found.deviation, found.path
    x, y, z = np.ascontiguousarray(np.round(shown.position, 4).T)
    return {
        "workingsteps": status["workingsteps"],
        "rows": found.rows,
        "deviation_mm": off.length,
        "deviation_mm_min": off.feed,
        "deviation_n": off.force,
        "is_growing": not job.state.is_finished,
        "time_s": np.round(shown.time, 4),
        "x_mm": x,
        "y_mm": y,
        "z_mm": z,
        "feed_actual_mm_min": np.round(shown.feed, 2),
        "cutting_force_n": np.round(shown.force, 2),
        "is_rapid": shown.is_rapid,
        "workingstep": shown.workingstep,
    }
