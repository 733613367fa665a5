"""Orders of jobs: from the fields of a request to a queued job, or to a refusal before that.

What a request names is looked up here, in the same way for every kind of job: its program or
the one that an advice has optimised, its log, its uploaded files. What only one kind needs is a
check of its own below, which the table of resources names.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from fastapi import Request, Response
from starlette.concurrency import run_in_threadpool

from kbe.rows import utc
from optimiser.cuts.source import why_elsewhere
from service.errors import NotFound, Unreadable
from service.files import read_bytes
from service.inputs.numbers import tool_numbers_in
from service.inputs.program_kind import ProgramKind
from service.monitor.monitor import MonitorSet
from service.programs.reading import read_completed, selected
from service.recording.logged_run import DOCUMENTS
from service.recording.table import TABLES
from service.requests.fields import loaded
from service.requests.kind_options import OF_PATHS, changed_values, require_options_served
from service.requests.knowledge import SelectionRequest
from service.requests.program_facts import GIVEN, ProgramRequest, StockFile
from service.requests.stored_advice import StoredAdviceRequest
from service.rest.checks import reading_in_turn
from service.rest.context import data_folder_of, idempotency_of, key_of
from service.rest.replies import json_reply
from service.rest.results import file_of, require_done
from service.rest.views import job_view
from service.storage import files, jobs, library, programs
from service.storage.files import FIELDS, FileKind
from service.storage.folder import DataFolder
from service.storage.idempotency import made_before
from service.storage.jobs import Job, JobKind, JobRequest
from service.storage.results import SAMPLES
from service.trial.inputs import Inputs, changed
from simulator.library import load_machine
from simulator.tool_files.file_unit import FileUnit
from stepnc_model.errors import StepNcError
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

LOGS = ("log_id", "run_id", "monitor")
"""Fields of a request that name a log."""

LOGGED = frozenset({JobKind.SIMULATION, JobKind.CONTROL})
"""Jobs whose samples are a log."""

OF_CODE = ("tools_id", "stock", "material")
"""Fields that advice on NC code needs; tools and stock only where the code tells none."""

IN_PLACE = {"stock": "stock_id"}
"""Fields that take the place of others."""

MOMENTS = ("since", "until")
"""Fields between whose times outcomes are selected."""

Require = Callable[[DataFolder, JobRequest], None]
"""Check that refuses a request with the error that its job would raise."""


def nothing(_data_folder: DataFolder, _order: JobRequest) -> None:
    """Accept every request without a check."""


async def queued(
    request: Request, order: JobRequest, key: str | None, *, require: Require
) -> Response:
    """Queue a job and reply 202 with its location.

    Raises
    ------
    StepNcError
        When the job could not start; a repeated idempotency key returns the existing job.
    """
    order = replace(order, key=key_of(request).id)
    data_folder = data_folder_of(request)
    words = repr(sorted(order.request.items())).encode()
    idempotency = idempotency_of(request, key, words)

    def add() -> Job:
        with data_folder.database.reading() as connection:
            is_new = made_before(connection, idempotency) is None
        if is_new:
            _require_files(data_folder, order.request)
            require(data_folder, order)
        return jobs.add(data_folder, order, idempotency=idempotency)

    job = await run_in_threadpool(add)
    headers = {"location": f"/v1/jobs/{job.id}", "retry-after": "1"}
    return json_reply(request, job_view(job), status=202, headers=headers)


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


def order(
    data_folder: DataFolder, kind: JobKind, words: Mapping[str, Any], owner: str
) -> JobRequest:
    """Return the job request, with the program that it names, or that of the run it names.

    Raises
    ------
    Unreadable, NotFound, Conflict
        When more than one log or program is named, or one of them does not exist.
    """
    if sum(bool(words.get(name)) for name in LOGS) > 1:
        raise Unreadable(f"name only one of {', '.join(LOGS)}")
    program, source = words.get("program_id") or "", words.get("advice_id") or ""
    if program and source:
        raise Unreadable("name either a program_id or an advice_id")
    if words.get("run_id"):
        run = _run(data_folder, words["run_id"])
        if not program and not source:
            program, source = run.program, run.source
            words = {**words, **_of_run(run, words)}
    if source and not program:
        program = jobs.get(data_folder, source, JobKind.ADVICE).program
    return JobRequest(kind=kind, request=words, program=program, source=source, owner=owner)


def _of_run(run: Job, words: Mapping[str, Any]) -> dict[str, Any]:
    """Facts given about the program of a run; its machine and material if not named."""
    names = [name for name in ("machine", "material") if words.get(name) == ""]
    return {name: run.request[name] for name in (*GIVEN, *names) if name in run.request}


def _run(data_folder: DataFolder, id: str) -> Job:
    """Return the finished run whose samples are the log."""
    run = jobs.get(data_folder, id)
    if run.kind not in LOGGED:
        raise NotFound("simulation or run under control", id)
    require_done(run)
    return run


def _require_files(data_folder: DataFolder, words: Mapping[str, Any]) -> None:
    """Check that the uploaded files and the samples exist which a request names.

    Raises
    ------
    NotFound, Unreadable
        When one does not, or other words about the raw part are given beside its file.
    """
    for kind, field in FIELDS.items():
        if words.get(field):
            files.require_file(data_folder, words[field], kind)
    if words.get("run_id"):
        file_of(data_folder, jobs.get(data_folder, words["run_id"]), SAMPLES, thing="samples")
    if words.get("stock") and words.get("stock_id"):
        raise Unreadable("name stock or stock_id, not both")
    if words.get("stock_solid") and not words["stock_id"]:
        raise Unreadable("stock_solid has no effect without stock_id")


def runnable(data_folder: DataFolder, order: JobRequest) -> None:
    """Check that program, machine and material exist, and that the program is STEP-NC.

    Raises
    ------
    Unreadable, NotFound
        When no program is named, or it or its file was deleted.
    StepNcError
        When the program is NC code.
    UnknownMachine, UnknownMaterial, LibraryError
        When the job would raise the same error.
    """
    if not order.program:
        raise Unreadable("name either a program_id or an advice_id")
    programs.require_kind(data_folder, order.program, ProgramKind.STEP_NC)
    if not order.source:
        programs.require_file(data_folder, order.program)
    words = order.request
    library.require(data_folder, machine=words["machine"], material=words.get("material", ""))
    from service.control.disturbances import disturbances  # noqa: PLC0415 (numpy)

    # The materials among them are known to the job alone.
    disturbances(words.get("disturbances", ()), hardness=lambda _: 1.0)
    if not order.source and (words["machine"] or words.get("workingsteps")):
        _require_possible(data_folder, order)


def _require_possible(data_folder: DataFolder, order: JobRequest) -> None:
    """Refuse an unknown workingstep, and a machine that can run none of the workingsteps."""
    words = order.request
    with reading_in_turn():
        file = data_folder.fetched(data_folder.program_file(order.program))
        given = loaded(ProgramRequest, {name: words[name] for name in GIVEN if name in words})
        program = read_completed(file, given).program
        steps = selected(program, tuple(words.get("workingsteps", ())))
        if not words["machine"]:
            return
        machine = load_machine(library.machine_word(data_folder, words["machine"]))
        reasons = [why_elsewhere(step, machine) for step in steps]
    if reasons and all(reasons):
        raise StepNcError(f"no workingstep can be run on this machine: {reasons[0]}")


def advisable(data_folder: DataFolder, order: JobRequest) -> None:
    """Check that all that advice needs is given and valid."""
    words = order.request
    kind = programs.get(data_folder, order.program).kind
    named = changed_values(loaded(StoredAdviceRequest, words))
    require_options_served(named, kind, flags={})
    if kind is ProgramKind.STEP_NC:
        for name in OF_PATHS:
            if name in named and not words["is_along_path"]:
                raise StepNcError(f"{name} has no effect without is_along_path")
        runnable(data_folder, order)
        return
    programs.require_file(data_folder, order.program)
    if words["dialect"] == Dialect.CANONICAL:
        raise StepNcError("dialect canonical: canonical commands are no NC code")
    if missing := missing_fields(words, OF_CODE):
        _require_setup(data_folder, order, missing)
    library.require(data_folder, machine=words["machine"], material=words["material"])
    tool_numbers_in(tuple(words["finish"]))
    tool_numbers_in(tuple(words["keep"]))


def _require_setup(data_folder: DataFolder, order: JobRequest, missing: list[str]) -> None:
    """Refuse NC code that does not tell itself what a request leaves out.

    Raises
    ------
    StepNcError
        With everything that is missing, and the fields that give it.
    """
    from service.simulation.code_setup import GivenSetup, code_setup  # noqa: PLC0415 (numpy)

    words = order.request
    stored = programs.get(data_folder, order.program)
    tools, stock = words["tools_id"], words["stock"]
    if words["stock_id"]:
        place = files.require_file(data_folder, words["stock_id"], FileKind.STOCK)
        stock = StockFile(path=place)
    with reading_in_turn():
        data = read_bytes(data_folder.fetched(data_folder.program_file(order.program)))
        dialect = Dialect(words["dialect"]) if words["dialect"] else None
        given = GivenSetup(
            file=Path(stored.name),
            tools=files.require_file(data_folder, tools, FileKind.TOOLS) if tools else None,
            unit=FileUnit(words["tools_unit"]) if words["tools_unit"] else None,
            stock=stock,
            material=words["material"],
        )
        found = code_setup(read_program(data, dialect=dialect), given).missing
    if found:
        raise StepNcError(
            f"advice on NC code needs {', '.join(OF_CODE)}, of which the code may tell the "
            f"first two; missing: {', '.join(missing)}: {'; '.join(found)}"
        )


def timeable(data_folder: DataFolder, order: JobRequest) -> None:
    """Check that the program can be run, and that the log has a form that is read."""
    runnable(data_folder, order)
    if order.request["log_id"] is not None:
        name = files.get(data_folder, order.request["log_id"]).name
        if Path(name).suffix.lower() not in TABLES | DOCUMENTS:
            known = ", ".join(sorted(TABLES | DOCUMENTS))
            raise StepNcError(f"{name}: the cycle time is read from a log in {known}")


def missing_fields(words: Mapping[str, Any], names: tuple[str, ...]) -> list[str]:
    """Return which of some fields are not given, nor what takes their place."""
    return [name for name in names if not words[name] and not words.get(IN_PLACE.get(name, ""))]


def startable(_data_folder: DataFolder, order: JobRequest) -> None:
    """Check that the inputs of a trial cut are within their bounds."""
    changed(Inputs(), **order.request["inputs"])


def selectable(_data_folder: DataFolder, order: JobRequest) -> None:
    """Check the times between which outcomes are selected."""
    wanted = loaded(SelectionRequest, {name: order.request[name] for name in MOMENTS})
    require_moments(since=wanted.since, until=wanted.until)


def require_moments(*, since: datetime | None, until: datetime | None) -> None:
    """Refuse invalid times.

    Raises
    ------
    Unreadable
        When a time has no zone or lies outside the supported years, or the end is not after
        the start.
    """
    for name, time in zip(MOMENTS, (since, until), strict=True):
        try:
            if time is not None:
                utc(name, time)
        except (ValueError, OverflowError) as error:
            raise Unreadable(str(error)) from error
    if since is not None and until is not None and since >= until:
        raise Unreadable(f"since {since} is not before until {until}")
