"""Map of deviations, which only ``/v1/verifications`` has."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from service.rest.bodies import Id
from service.rest.context import InDataFolder
from service.rest.replies import json_reply
from service.rest.results import file_of, read_in_turn, require_done
from service.rest.verification_views import SurfaceMapView, map_view
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind
from service.storage.results import SURFACE
from service.verification.facts import read_map

ROUTES = APIRouter(prefix="/v1/verifications", tags=["verifications"])

PLACES_SHOWN = 12_000

Places = Annotated[int, Query(ge=100, le=50_000, description="most places of the map")]


@ROUTES.get("/{id}/map", response_model=SurfaceMapView, summary="Show the map of deviations")
async def deviation_map(
    request: Request, data_folder: InDataFolder, id: Id, places: Places = PLACES_SHOWN
) -> Response:
    """Show places on the surface: the worst, and others evenly spread; the rest is counted."""
    return json_reply(request, await read_in_turn(_map, data_folder, id, places))


def _map(data_folder: DataFolder, id: str, places: int) -> dict[str, Any]:
    job = jobs.get(data_folder, id, JobKind.VERIFICATION)
    require_done(job)
    return map_view(read_map(file_of(data_folder, job, SURFACE, thing="map"), most=places))
