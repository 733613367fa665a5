"""Recording of a controlled run's outcomes in the knowledge base."""

import getpass
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from hashlib import file_digest, sha256
from itertools import count
from pathlib import Path

from controller.orders import EventKind
from kbe.connection import parsed_place, require_openable
from kbe.rows import CIRCUMSTANCES, OUTCOME, Value
from service.control.cuts import cuts_csv, taught_by
from service.control.loads import write_loads
from service.control.outcomes import RecordingContext, outcomes_of
from service.control.run import ControlRun, Watcher, control
from service.files import require_place, require_places, write_atomically
from service.knowledge.place import make_folder, named_place, require_apart
from service.knowledge.verbs import record
from service.progress import Tell, silent
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import ProcessOutcome

ID_LENGTH = 32
"""Characters of the id of a run."""


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
    if files.is_teaching and files.loads is None:
        raise StepNcError("--teach needs a file of reference loads: name it with --loads")
    outputs = (files.loads, files.cut_log, files.output, files.report)
    require_places(outputs, apart_from=[files.file, files.recorded])
    run = control(request, files, knowledge=knowledge, tell=tell, watchers=watchers)
    _keep_cuts(run, files, tell)
    if place is not None:
        kept = files.recorded or files.output
        trace = "" if kept is None else str(kept.resolve())
        recorded = "" if files.recorded is None else _id_of(files.recorded)
        by = by or getpass.getuser()
        keep(run, place, by=by, trace=trace, recorded=recorded, tell=tell)
    return run


def _keep_cuts(run: ControlRun, files: RunFiles, tell: Tell) -> None:
    """Write the log of the cuts, and the reference loads that the run has taught."""
    if files.cut_log is not None:
        write_atomically(files.cut_log, cuts_csv(run))
        tell(f"cuts: {files.cut_log}")
    if files.loads is None:
        return
    taught = taught_by(run, is_teaching=files.is_teaching)
    if taught:
        write_loads(files.loads, {**run.loads, **taught})
    names = ", ".join(f"'{key.workingstep}'" for key in taught)
    tell(f"reference loads: {len(run.loads)} known, {len(taught)} taught {names}".rstrip())
    if run.is_stopped:
        tell("a run that was stopped teaches no reference load")


def keep(
    run: ControlRun,
    place: str,
    *,
    by: str,
    trace: str,
    recorded: str = "",
    tell: Tell = silent,
) -> None:
    """Record the outcomes of a run, unless it was stopped.

    The id of a run of the virtual machine is a digest of its outcomes: the same run with the
    same seed says nothing new, and a job that is done again has the id it had before.

    Parameters
    ----------
    place : str
        Location of the knowledge base.
    by : str
        Author of the record.
    trace : str
        Location of the samples.
    recorded : str
        Id of the recorded run that was evaluated; empty: it ran on the virtual machine.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be written.
    """
    if run.is_stopped:
        return
    orders = any(event.kind is EventKind.ORDER for event in run.events)
    recording = RecordingContext(
        run=recorded,
        at=datetime.now(UTC),
        by=", ".join((
            by,
            "recorded run" if run.recorded else run.ran_on,
            *run.disturbances,
            *(("changed while it ran",) if orders else ()),
        )),
        trace=trace,
        seed=run.seed,
    )
    outcomes = _numbered(outcomes_of(run, recording))
    id = recorded or _digest(outcomes)
    outcomes = [replace(each, run=id) for each in outcomes]
    try:
        found = record(place, outcomes)
    except ValueError as error:
        # A file name or user name that cannot be stored as text.
        raise StepNcError(f"the outcomes cannot be recorded: {error}") from error
    tell(f"recorded: {found}, run {id}")


def _numbered(outcomes: Iterable[ProcessOutcome]) -> list[ProcessOutcome]:
    """Number the outcomes of each workingstep, which a program may run more than once."""
    numbers: dict[str, Iterator[int]] = defaultdict(count)
    return [replace(each, sequence=next(numbers[each.workingstep])) for each in outcomes]


def _digest(outcomes: Sequence[ProcessOutcome]) -> str:
    """Id of a run of the virtual machine, from what its outcomes say."""
    said = [_said(each) for each in outcomes]
    return sha256(repr(said).encode()).hexdigest()[:ID_LENGTH]


def _said(outcome: ProcessOutcome) -> list[Value]:
    """Values of an outcome, without how it was recorded."""
    return [value for name, value in OUTCOME.row(outcome).items() if name not in CIRCUMSTANCES]


def _id_of(recorded: Path) -> str:
    """Id of a recorded run, whatever the name of its file and the options of its evaluation."""
    with recorded.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()[:ID_LENGTH]
