"""Job of a verb: its request and files are found, it is run, and what it returns is kept.

All that differs between verbs is declared by them: the fields of their files, and what a result
keeps beside its report (:meth:`service.verbs.result.Result.kept`). A verb whose runs people
change while they go on has a function of its own (:data:`service.jobs.child.WORK`).
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Protocol, runtime_checkable

from service.errors import NotFound
from service.extra_parts import declared
from service.files import naming
from service.jobs.stored_verb import StoredVerb
from service.jobs.task import RunningJob
from service.optional_packages import has_package
from service.recording.logged_run import AgentRun, keep_run
from service.requests.fields import Request
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.requests.runs import SimulationRequest
from service.requests.stored_advice import StoredAdviceRequest
from service.requests.stored_cycle_time import QueuedCycleTime
from service.storage import jobs
from service.storage.files import FileKind
from service.storage.jobs import JobKind
from service.storage.results import LOG, OPTIMISED, REPORT, SAMPLES
from service.verbs.call import Verb, verbs
from service.verbs.result import Result
from stepnc_model.errors import Finding, Severity

STORED: Mapping[JobKind, StoredVerb] = {
    JobKind.ADVICE: StoredVerb(name="optimise", request=StoredAdviceRequest, output=OPTIMISED),
    JobKind.SIMULATION: StoredVerb(name="simulate", request=SimulationRequest, output=SAMPLES),
    JobKind.EVALUATION: StoredVerb(name="kbe.table", request=EvaluationRequest),
    JobKind.REVIEW: StoredVerb(name="kbe.review", request=ReviewRequest),
    JobKind.CYCLE_TIME: StoredVerb(name="cycletime", request=QueuedCycleTime),
    **dict(declared("jobs", "STORED")),
}
"""Verb of each kind of job that is no live session."""


@runtime_checkable
class LogRequest(Protocol):
    """A request that may name a log: an upload, the samples of a run, or a machine."""

    log_id: str | None
    run_id: str | None
    monitor: str
    agent_url: str


KNOWLEDGE = "knowledge base of this service"
"""Name of the knowledge base, whose location clients must not learn."""


def run(task: RunningJob) -> None:
    """Run a verb, and keep its result, its report and its files.

    Raises
    ------
    StepNcError
        As the verb; when a file that the request names was deleted; and when an agent does not
        answer.
    """
    stored = STORED[task.job.kind]
    verb, request = verbs()[stored.name], task.request(stored.request)
    with naming(task.names):
        files = _built(verb.files, _files(task, request, stored.output))
        found = verb.run(_request_of(verb, request), files, tell=task.tell)
    task.keep(task.named(found.kept(task.folder)))
    if type(found).page is not Result.page:
        task.keep_report(found.page())


def _request_of(verb: Verb, request: Request) -> Request:
    """Return the part of a job's request that is that of the verb."""
    if isinstance(request, verb.request):
        return request
    return _built(
        verb.request, {each.name: getattr(request, each.name) for each in fields(request)}
    )


def _built(kind: type[Request], values: Mapping[str, object]) -> Request:
    """Build a request from the values for which it has fields."""
    known = {each.name for each in fields(kind)}
    return kind(**{name: value for name, value in values.items() if name in known})


def _files(task: RunningJob, request: Request, output: str) -> dict[str, object]:
    """Return all that a job has, by the names that the files of verbs have for it."""
    found: dict[str, object] = {
        "name": KNOWLEDGE,
        "kb": task.data_folder.knowledge,
        "report": task.folder / REPORT,
        "live": task.live,
    }
    if task.job.program:
        file, name = task.program_file()
        found |= {"file": file, "program": file, "name": name}
    tools = task.upload(getattr(request, "tools_id", None), FileKind.TOOLS)
    if tools is not None:
        found |= {"tools": tools, "tools_unit": getattr(request, "tools_unit", None)}
    required = task.upload(getattr(request, "required_id", None), FileKind.REQUIRED_PART)
    if required is not None:
        found["required"] = f"{required}#{getattr(request, 'required_solid', '')}"
    if isinstance(request, LogRequest):
        found |= _log(task, request)
    if output and (output != SAMPLES or has_package("pyarrow")):
        found["output"] = task.folder / output
    return found


def _log(task: RunningJob, request: LogRequest) -> dict[str, object]:
    """Return the log of a request, and what was found about it; nothing if it names none."""
    path = task.upload(request.log_id, FileKind.LOG)
    doubts: tuple[Finding, ...] = ()
    if request.run_id is not None:
        kind = jobs.get(task.data_folder, request.run_id).kind.value
        folder = task.data_folder.job_folder(request.run_id)
        path = task.data_folder.fetched(folder / SAMPLES)
        if not path.is_file():
            raise NotFound(f"samples of {kind}", request.run_id)
        task.names[path] = f"samples of {kind} {request.run_id}"
    elif request.monitor:
        path = task.folder / LOG
        doubts = _logged(keep_run(request.agent_url, path, tell=task.say))
        task.names[path] = f"latest run of {request.monitor}"
    return {} if path is None else {"log": str(path), "log_findings": doubts}


def _logged(run: AgentRun) -> tuple[Finding, ...]:
    """Return what is to be said of a run that an agent has kept."""
    found = [
        Finding(severity=Severity.WARNING, message=f"the run is not whole: {text}")
        for text in run.missing
    ]
    if run.program:
        message = f"the machine names the program '{run.program}'"
        found.insert(0, Finding(severity=Severity.NOTE, message=message))
    return tuple(found)
