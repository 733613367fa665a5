"""Verifications over REST, with their map of deviations."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from extras.verification.facts import read_map
from extras.verification.run import FIT
from extras.verification.stored_request import StoredVerificationRequest
from extras.verification.views import SurfaceMapView, VerificationView, map_view
from service.errors import Unreadable
from service.inputs.numbers import numbers_in
from service.rest.bodies import Id
from service.rest.context import InDataFolder
from service.rest.orders import LOGS, missing_fields, runnable
from service.rest.replies import json_reply
from service.rest.resource import CSV_OR_PARQUET, Creation, Download, Resource, Shown
from service.rest.results import file_of, read_in_turn, require_done
from service.storage import jobs, library
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest
from service.storage.results import LOG, PLACES, SURFACE

VERIFICATIONS = APIRouter(prefix="/v1/verifications", tags=["verifications"])

WITHOUT_PROGRAM = ("machine", "stock", "tools_id", "required_id")
"""Fields that a verification without a program needs."""

PLACES_SHOWN = 12_000

Places = Annotated[int, Query(ge=100, le=50_000, description="most places of the map")]


def verifiable(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that there is a log, a program or what stands for it, and that zero is valid."""
    words = asked.request
    if not any(words[name] for name in LOGS):
        raise Unreadable(f"name one of {', '.join(LOGS)}")
    if asked.program:
        runnable(data_folder, asked)
    elif missing_fields(words, WITHOUT_PROGRAM):
        wanted = ", ".join(WITHOUT_PROGRAM)
        raise Unreadable(f"name a program_id or an advice_id; or all of {wanted}")
    else:
        library.require(data_folder, machine=words["machine"], material=words["material"])
    if words["zero"] and words["zero"] != FIT:
        numbers_in(words["zero"], "zero", counts=(3,))


RESOURCES = (
    Resource(
        kind=JobKind.VERIFICATION,
        tag="verifications",
        plural="verifications",
        creation=Creation(
            name="ask",
            body=StoredVerificationRequest,
            require=verifiable,
            summary="Verify logged positions",
            about="Queue a job that compares the part that a log left with the programmed one."
            "\n\nThe log is an uploaded one, the samples of a run, or the latest run of a "
            "monitored machine.",
        ),
        shown=Shown(
            summary="Show a verification",
            about="Show deviations by workingstep, tolerance bands, and what the log can "
            "resolve.",
            view=VerificationView,
        ),
        downloads=(
            Download(
                path="places",
                file=PLACES,
                forms=CSV_OR_PARQUET,
                name="places_file",
                is_result=True,
                summary="Download the deviations of places",
                about="Download all places on walls, and others beyond their uncertainty.",
            ),
            Download(
                path="log",
                file=LOG,
                thing="log of a monitored machine in verification",
                saved_as="log",
                summary="Download the log of a monitored machine",
                about="Download the positions that were read from the agent of a monitored "
                "machine.",
            ),
        ),
    ),
)


@VERIFICATIONS.get(
    "/{id}/map", response_model=SurfaceMapView, summary="Show the map of deviations"
)
async def deviation_map(
    request: Request, data_folder: InDataFolder, id: Id, places: Places = PLACES_SHOWN
) -> Response:
    """Show places on the surface: the worst, and others evenly spread; the rest is counted."""
    return json_reply(request, await read_in_turn(_map, data_folder, id, places))


def _map(data_folder: DataFolder, id: str, places: int) -> dict[str, Any]:
    job = jobs.get(data_folder, id, JobKind.VERIFICATION)
    require_done(job)
    return map_view(read_map(file_of(data_folder, job, SURFACE, thing="map"), most=places))


ROUTES = (VERIFICATIONS,)
