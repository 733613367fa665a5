"""Job ``advice``: optimise a program and store the result, the report and the NC code."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from service.file_names import naming, with_names
from service.jobs.task import CURVES, FEEDS, NC_CODE, OPTIMISED, REPORT, RunningJob
from service.plan_output import plan_json
from service.program_kind import ProgramKind
from service.requests.stored_advice import StoredAdviceRequest
from service.storage import files, programs
from service.storage.files import FileKind
from service.usecases import AdviceFiles, optimise

if TYPE_CHECKING:
    from service.along_path.run import FeedsAlongPath


def run(task: RunningJob) -> None:
    """Run an advice job: optimise the feeds of a program and store the results.

    Raises
    ------
    StepNcError
        As :func:`service.usecases.optimise`, or
        :func:`service.along_path.of_code.optimise_code` for NC code.
    """
    request = task.request(StoredAdviceRequest)
    file, name = task.program_file()
    names = {file: name}
    tools = None
    if request.tools_id is not None:
        tools = files.require_file(task.data_folder, request.tools_id, FileKind.TOOLS)
        names[tools] = files.get(task.data_folder, request.tools_id, FileKind.TOOLS).name
    request = task.with_stock(request, names)
    kind = programs.get(task.data_folder, task.job.program).kind
    advise = _advise_code if kind is ProgramKind.NC_CODE else _advise_program
    with naming(names):
        advise(task, request, file, tools, names)


def _advise_program(
    task: RunningJob,
    request: StoredAdviceRequest,
    file: Path,
    tools: Path | None,
    names: dict[Path, str],
) -> None:
    """Optimise a STEP-NC program."""
    outcome = optimise(
        request,
        AdviceFiles(
            file=file,
            name=names[file],
            output=task.folder / OPTIMISED,
            feeds=task.folder / FEEDS if request.is_along_path else None,
            report=task.folder / REPORT,
            tools=tools,
            knowledge=task.data_folder.knowledge,
        ),
        tell=task.tell,
    )
    if request.nc_control is not None:
        _name_code(task)
    if outcome.along is not None:
        _keep_curves(task, outcome.along)
    task.keep({
        **json.loads(plan_json(outcome.plan, outcome.confirmation, outcome.along)),
        "program": names[file],
        "is_written": outcome.written is not None,
        "nc_control": request.nc_control,
    })


def _advise_code(
    task: RunningJob,
    request: StoredAdviceRequest,
    file: Path,
    tools: Path | None,
    names: dict[Path, str],
) -> None:
    """Plan the feeds along the paths of NC code."""
    from service.along_path.code_output import code_advice_json, write_views  # noqa: PLC0415
    from service.along_path.of_code import CodeFiles, optimise_code  # noqa: PLC0415 (numba)

    places = CodeFiles(
        file=file,
        name=names[file],
        tools=tools,
        tools_unit=request.tools_unit,
        output=task.folder / NC_CODE,
        report=task.folder / REPORT,
        feeds=task.folder / FEEDS,
        knowledge=task.data_folder.knowledge,
    )
    found = optimise_code(request, places, tell=task.tell)
    findings = (
        replace(each, message=with_names(each.message, names)) for each in found.findings
    )
    found = replace(found, findings=tuple(findings))
    write_views(found, places)
    _keep_curves(task, found.along)
    task.keep({
        **json.loads(code_advice_json(found)),
        "is_written": found.written is not None,
        "nc_control": found.control,
    })


def _keep_curves(task: RunningJob, along: "FeedsAlongPath") -> None:
    """Keep feed, force and power of both runs for plots."""
    from service.along_path.curves import curves_record  # noqa: PLC0415 (numpy)

    task.keep(curves_record(along), CURVES)


def _name_code(task: RunningJob) -> None:
    """Rename the NC code file to the name under which it is served."""
    stem = OPTIMISED.removesuffix(".stpnc")
    for file in task.folder.glob(f"{stem}.*"):
        if file.name != OPTIMISED:
            file.replace(task.folder / NC_CODE)
