"""Job ``advice``: optimise a program and store the result, the report and the NC code."""

from dataclasses import replace
from typing import TYPE_CHECKING

from service.file_names import naming, with_names
from service.files import write_atomically
from service.jobs.task import CURVES, FEEDS, NC_CODE, OPTIMISED, REPORT, RunningJob
from service.program_kind import ProgramKind
from service.requests.stored_advice import StoredAdviceRequest
from service.storage import files, programs
from service.storage.files import FileKind
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from service.verbs.optimise.run import run as optimise

if TYPE_CHECKING:
    from service.along_path.run import FeedsAlongPath


def run(task: RunningJob) -> None:
    """Run an advice job: optimise the feeds of a program and store the results.

    Raises
    ------
    StepNcError
        As :func:`service.verbs.optimise.run.run`.
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
    is_code = kind is ProgramKind.NC_CODE
    places = AdviceFiles(
        file=file,
        name=name,
        output=task.folder / (NC_CODE if is_code else OPTIMISED),
        report=task.folder / REPORT,
        feeds_csv=task.folder / FEEDS if is_code or request.is_along_path else None,
        tools=tools,
        tools_unit=request.tools_unit if is_code else None,
        kb=task.data_folder.knowledge,
    )
    with naming(names):
        found = optimise(request, places, tell=task.tell)
    if isinstance(found, CodeAdvice):
        findings = (
            replace(each, message=with_names(each.message, names)) for each in found.findings
        )
        found = replace(found, findings=tuple(findings))
    elif request.nc_control is not None:
        _name_code(task)
    write_atomically(task.folder / REPORT, found.page().encode())
    if found.along is not None:
        _keep_curves(task, found.along)
    task.keep({
        **found.record(),
        "program": name,
        "is_written": found.written is not None,
        "nc_control": found.control if isinstance(found, CodeAdvice) else request.nc_control,
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
