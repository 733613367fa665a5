"""Routes of the knowledge base: corrections and outcomes."""

import json
from collections.abc import Callable, Sequence
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from kbe.queries import Selection, StoredCorrection
from service.errors import NotFound, Unreadable
from service.knowledge import verbs
from service.rendering.columns import dump
from service.rest.bodies import DecisionBody
from service.rest.context import (
    InDataFolder,
    data_folder_of,
)
from service.rest.orders import require_moments
from service.rest.replies import json_reply
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.list.result import OutcomesResult
from service.verbs.kbe.show.result import RunResult
from service.verbs.result import Result

CORRECTIONS = APIRouter(prefix="/v1/corrections", tags=["knowledge"])
OUTCOMES = APIRouter(prefix="/v1/outcomes", tags=["knowledge"])

MOST_NUMBER = 2**31 - 1

Number = Annotated[int, Path(ge=1, le=MOST_NUMBER, description="number of the correction")]
Word = Annotated[str | None, Query(max_length=200)]
Since = Annotated[datetime | None, Query(description="start time (inclusive), with zone")]
Until = Annotated[datetime | None, Query(description="end time (exclusive), with zone")]


@CORRECTIONS.get("", summary="List all corrections with their latest decision")
async def corrections(request: Request, data_folder: InDataFolder) -> Response:
    """List all corrections in the order of their proposal."""
    return await _corrections(request, lambda: verbs.corrections(data_folder.knowledge))


@CORRECTIONS.post("/{number}/accept", summary="Accept a correction")
async def accept(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """Accept a correction in the name of a person; the next plan applies it."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.accept(place, [number], by=body.by))


@CORRECTIONS.post("/{number}/withdraw", summary="Withdraw or reject a correction")
async def withdraw(
    request: Request, data_folder: InDataFolder, number: Number, body: DecisionBody
) -> Response:
    """Withdraw an accepted correction, or reject a proposed one."""
    place = data_folder.knowledge
    return await _corrections(request, lambda: verbs.withdraw(place, [number], by=body.by))


def _reply(request: Request, result: Result) -> Response:
    return json_reply(request, dump(result.record()).encode())


async def _corrections(
    request: Request, work: Callable[[], Sequence[StoredCorrection]]
) -> Response:
    try:
        entries = await run_in_threadpool(work)
    except ValueError as error:
        # The person's name is empty or cannot be stored.
        raise Unreadable(str(error)) from error
    return _reply(request, CorrectionsResult(entries=entries))


@OUTCOMES.get("", summary="List outcomes, newest first")
async def outcomes(  # noqa: PLR0913 (each is a parameter of the request)
    request: Request,
    *,
    machine: Word = None,
    material: Word = None,
    tool: Word = None,
    feature_kind: Word = None,
    program: Word = None,
    since: Since = None,
    until: Until = None,
    limit: Annotated[int, Query(ge=1, le=2000)] = 200,
) -> Response:
    """List outcomes of runs by workingstep, in canonical units as in exports."""
    require_moments(since=since, until=until)
    selection = Selection(
        machine=machine, material=material, tool=tool, feature_kind=feature_kind,
        program=program, since=since, until=until,
    )  # fmt: skip
    place = data_folder_of(request).knowledge
    listing = await run_in_threadpool(verbs.newest, place, selection, limit=limit)
    return _reply(request, OutcomesResult(outcomes=listing.outcomes, total=listing.total))


@OUTCOMES.get("/runs/{run}", summary="List the outcomes of one run")
async def run_outcomes(
    request: Request, data_folder: InDataFolder, run: Annotated[str, Path(max_length=200)]
) -> Response:
    """List the outcomes of a run with their deviations."""
    found = await run_in_threadpool(verbs.outcomes_of_run, data_folder.knowledge, run)
    if not found:
        raise NotFound("run", run)
    return _reply(request, RunResult(outcomes=found))


@OUTCOMES.get("/contexts", summary="List machines, materials and tools with known outcomes")
async def contexts(request: Request, data_folder: InDataFolder) -> Response:
    """List the known combinations of machine, material and tool, for filters."""
    found = await run_in_threadpool(verbs.contexts, data_folder.knowledge)
    known = [{"machine": each.machine, "material": each.material, "tool": each.tool}
             for each in found]  # fmt: skip
    return json_reply(request, json.dumps({"contexts": known}).encode())
