"""Orders of jobs that work on a log: of which program, which log, which agent."""

from collections.abc import Mapping
from typing import Any

from service.errors import NotFound, Unreadable
from service.jobs.task import SAMPLES
from service.monitor.monitor import MonitorSet
from service.requests.given import GIVEN
from service.rest.results import file_of, require_done
from service.storage import files, jobs
from service.storage.files import FIELDS
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobRequest

LOGS = ("log_id", "run_id", "monitor")
"""Fields of a request that name a log."""

RUNS = frozenset({JobKind.SIMULATION, JobKind.CONTROL})
"""Jobs whose samples are a log."""


def agent_url(monitors: MonitorSet, name: str) -> str:
    """Return the address of a monitored machine's agent; empty without a name.

    Raises
    ------
    NotFound
        When the service was not started with this machine.
    """
    if not name:
        return ""
    watched = monitors.by_name.get(name)
    if watched is None:
        raise NotFound("monitor", name)
    return watched.source.url


def logged_order(
    data_folder: DataFolder, kind: JobKind, words: Mapping[str, Any], owner: str
) -> JobRequest:
    """Return the job request, with the program and machine of the run that it names.

    Raises
    ------
    Unreadable, NotFound, Conflict
        When more than one log or program is named, or one of them does not exist.
    """
    if sum(bool(words[name]) for name in LOGS) > 1:
        raise Unreadable(f"name only one of {', '.join(LOGS)}")
    program, source = words["program_id"] or "", words["advice_id"] or ""
    if program and source:
        raise Unreadable("name either a program_id or an advice_id")
    if words["run_id"] is not None:
        run = _run(data_folder, words["run_id"])
        if not program and not source:
            program, source = run.program, run.source
            words = {**words, **_of_run(run, words)}
    if source and not program:
        program = jobs.get(data_folder, source, JobKind.ADVICE).program
    return JobRequest(kind=kind, request=words, program=program, source=source, owner=owner)


def _of_run(run: Job, words: Mapping[str, Any]) -> dict[str, Any]:
    """What was given about the program of a run, and its machine and material if not named."""
    names = [name for name in ("machine", "material") if words.get(name) == ""]
    return {name: run.request[name] for name in (*GIVEN, *names) if name in run.request}


def _run(data_folder: DataFolder, id: str) -> Job:
    """Return the finished run whose samples are the log."""
    run = jobs.get(data_folder, id)
    if run.kind not in RUNS:
        raise NotFound("simulation or run under control", id)
    require_done(run)
    return run


def require_logs(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that the files and samples that a request names exist.

    Raises
    ------
    NotFound
    """
    words = asked.request
    for kind, field in FIELDS.items():
        if words.get(field) is not None:
            files.require_file(data_folder, words[field], kind)
    if words["run_id"] is not None:
        run = jobs.get(data_folder, words["run_id"])
        file_of(data_folder, run, SAMPLES, thing="samples")
