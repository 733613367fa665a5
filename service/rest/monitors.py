"""Routes of ``/v1/monitors``: real machines, watched through their MTConnect agents."""

from functools import partial
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Path, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import NotFound
from service.ids import PATTERN
from service.monitor.monitor import MachineMonitor
from service.monitor.observed_run import compared, predicted_steps
from service.rest.context import InDataFolder, hub_of, monitors_of
from service.rest.monitor_stream import MonitorReader
from service.rest.monitor_views import comparison_view, monitor_view, status_view
from service.rest.replies import json_reply
from service.rest.results import (
    EVENTS,
    SERIES_POINTS,
    Begin,
    End,
    Points,
    Signals,
    messages_reply,
    result_of,
    window_reply,
)
from service.rest.views import ComparisonView, MonitorStatusView, MonitorView, SeriesView
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind

ROUTES = APIRouter(prefix="/v1/monitors", tags=["monitors"])

Name = Annotated[str, Path(max_length=200, description="name of the machine")]
Prediction = Annotated[
    str, Query(alias="simulation", pattern=PATTERN, description="id of a finished simulation")
]


def monitor_of(request: Request, name: str) -> MachineMonitor:
    """Return a monitor by the name of its machine.

    Raises
    ------
    NotFound
    """
    found = monitors_of(request).by_name.get(name)
    if found is None:
        raise NotFound("monitor", name)
    return found


@ROUTES.get("", response_model=list[MonitorView], summary="List monitored machines")
async def list_monitors(request: Request) -> Response:
    """List the machines named with ``--agent``, and whether their data arrive."""
    found = monitors_of(request).by_name.values()
    return json_reply(request, [monitor_view(each.status()) for each in found])


@ROUTES.get("/{name}", response_model=MonitorStatusView, summary="Show a monitored machine")
async def monitor(request: Request, name: Name) -> Response:
    """Show the connection, the latest values, and time and energy by workingstep."""
    return json_reply(request, status_view(monitor_of(request, name).status()))


@ROUTES.get("/{name}/rows", response_model=SeriesView, summary="Recent signals over time")
async def rows(
    request: Request,
    name: Name,
    signals: Signals = "",
    begin_s: Begin = None,
    end_s: End = None,
    points: Points = SERIES_POINTS,
) -> Response:
    """Show recent signals, in the machine's time from ``time_zero`` of its status."""
    series = await run_in_threadpool(monitor_of(request, name).series)
    return await window_reply(
        request, series, signals=signals, begin=begin_s, end=end_s, points=points,
        is_growing=True,
    )  # fmt: skip


@ROUTES.get("/{name}/comparison", response_model=ComparisonView,
            summary="Compare a machine with a simulation")  # fmt: skip
async def comparison(
    request: Request, data_folder: InDataFolder, name: Name, simulation: Prediction
) -> Response:
    """Show measured beside predicted time and energy by workingstep, so far."""
    watched = monitor_of(request, name)
    predicted = await run_in_threadpool(_result, data_folder, simulation)
    run = watched.status().run
    return json_reply(
        request,
        {
            "simulation": simulation,
            "machine": predicted["machine"],
            "program": predicted["program"],
            "measured_program": None if run is None else run.program,
            **comparison_view(compared(run, predicted_steps(predicted))),
        },
    )


def _result(data_folder: DataFolder, id: str) -> dict[str, Any]:
    """Return the result of a simulation."""
    job = jobs.get(data_folder, id, JobKind.SIMULATION)
    found: dict[str, Any] = orjson.loads(result_of(data_folder, job))
    return found


@ROUTES.get(
    "/{name}/events",
    summary="Stream events of a monitored machine",
    response_class=Response,
    responses=EVENTS,
)
async def monitor_events(request: Request, name: Name) -> Response:
    """Stream events ``status``, ``rows`` and ``gap`` without end."""
    reader = partial(MonitorReader, monitor_of(request, name))
    return messages_reply(request, hub_of(request).watch_by(f"monitor {name}", reader))
