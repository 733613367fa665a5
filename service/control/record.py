"""Recording of a controlled run's outcomes in the knowledge base."""

import getpass
from collections.abc import Sequence
from datetime import UTC, datetime
from uuid import uuid4

from controller.orders import EventKind
from kbe.store_location import parsed_place, require_openable
from service.control.outcomes import RecordingContext, outcomes_of
from service.control.run import ControlRun, Watcher, control
from service.files import require_place
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
    """Run a program under force control and record its outcomes if a knowledge base is named.

    With a recorded run among the files, its outcomes are recorded instead.

    Runs that were stopped are not recorded, because their times are not those of whole
    workingsteps. The author entry says that the outcomes are from a virtual machine and lists
    the disturbances: otherwise an unknown depth could not be told from a harder material.

    Raises
    ------
    StepNcError
        As :func:`service.control.run.control`, and when the knowledge base cannot be written.
    """
    place = named_place(knowledge)
    if place is not None:
        require_apart(place, files.output, files.report)
        make_folder(place)
        require_openable(parsed_place(place), is_new_allowed=True)
    for written in (files.output, files.report):
        if files.recorded is not None and written is not None:
            require_place(written, apart_from=files.recorded)
    run = control(request, files, knowledge=knowledge, tell=tell, watchers=watchers)
    if place is not None:
        kept = files.recorded or files.output
        trace = "" if kept is None else str(kept.resolve())
        keep(run, place, by=by or getpass.getuser(), trace=trace, tell=tell)
    return run


def keep(run: ControlRun, place: str, *, by: str, trace: str, tell: Tell = silent) -> None:
    """Record the outcomes of a run, unless it was stopped.

    Parameters
    ----------
    run : ControlRun
    place : str
        Location of the knowledge base.
    by : str
        Author of the record.
    trace : str
        Location of the samples.
    tell : callable

    Raises
    ------
    StepNcError
        When the knowledge base cannot be written.
    """
    if run.is_stopped:
        return
    orders = any(event.kind is EventKind.ORDER for event in run.events)
    recording = RecordingContext(
        run=uuid4().hex,
        at=datetime.now(UTC),
        by=", ".join((
            by,
            "recorded run" if run.recorded else "virtual machine",
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
        # A file name or user name that cannot be stored as text.
        raise StepNcError(f"the outcomes cannot be recorded: {error}") from error
    tell(f"recorded: {len(outcomes)} outcomes, run {recording.run}")
