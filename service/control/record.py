"""A run under control, and its outcomes in the knowledge base."""

import getpass
from collections.abc import Sequence
from datetime import UTC, datetime
from uuid import uuid4

from controller.orders import EventKind
from kbe.store_location import parsed_place, require_openable
from service.control.outcomes import RecordingContext, outcomes_of
from service.control.run import ControlRun, Watcher, control
from service.knowledge.place import make_folder, named_place, require_apart
from service.knowledge.verbs import record
from service.reading import Tell, silent
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from stepnc_model.errors import StepNcError


def control_recorded(
    request: ControlRequest,
    files: RunFiles,
    *,
    knowledge: str = "",
    by: str = "",
    tell: Tell = silent,
    watchers: Sequence[Watcher] = (),
) -> ControlRun:
    """Run a program under the loop, and keep what came out where a knowledge base is named.

    What a run that was stopped or broken off has cut is not kept: its times are not those of
    whole workingsteps. Who reads the outcomes is told that they are of a virtual machine, and
    what was disturbed: nothing else tells a depth that nobody knew of from a harder material.

    Raises
    ------
    StepNcError
        As :func:`service.control.run.control`, and when the knowledge base cannot take it.
    """
    place = named_place(knowledge)
    if place is not None:
        require_apart(place, files.output, files.report)
        make_folder(place)
        require_openable(parsed_place(place), is_new_allowed=True)
    run = control(request, files, knowledge=knowledge, tell=tell, watchers=watchers)
    if place is not None:
        trace = "" if files.output is None else str(files.output.resolve())
        keep(run, place, by=by or getpass.getuser(), trace=trace, tell=tell)
    return run


def keep(run: ControlRun, place: str, *, by: str, trace: str, tell: Tell = silent) -> None:
    """Keep what came out of a run, unless it was stopped.

    Parameters
    ----------
    run : ControlRun
    place : str
        Of the knowledge base.
    by : str
        Who records.
    trace : str
        Where the samples are.
    tell : callable

    Raises
    ------
    StepNcError
        When the knowledge base cannot take it.
    """
    if run.is_stopped:
        return
    orders = any(event.kind is EventKind.ORDER for event in run.events)
    recording = RecordingContext(
        run=uuid4().hex,
        at=datetime.now(UTC),
        by=", ".join((
            by,
            "virtual machine",
            *run.disturbances,
            *(("changed while it ran",) if orders else ()),
        )),
        trace=trace,
        seed=run.seed,
    )
    outcomes = outcomes_of(run, recording)
    try:
        record(place, outcomes)
    except ValueError as error:
        # A name of a file or of the user that is no text.
        raise StepNcError(f"the outcomes cannot be kept: {error}") from error
    tell(f"recorded: {len(outcomes)} outcomes, run {recording.run}")
