"""Job ``advice``: optimise a program and store the result, the report and the NC code."""

import json

from service.jobs.task import NC_CODE, OPTIMISED, REPORT, RunningJob
from service.plan_output import plan_json
from service.requests.advice import AdviceRequest
from service.usecases import AdviceFiles, optimise


def run(task: RunningJob) -> None:
    """Run an advice job: optimise the feeds of a program and store the results.

    Raises
    ------
    StepNcError
        As :func:`service.usecases.optimise`.
    """
    request = task.request(AdviceRequest)
    file, name = task.program_file()
    outcome = optimise(
        task.named(request),
        AdviceFiles(
            file=file,
            name=name,
            output=task.folder / OPTIMISED,
            report=task.folder / REPORT,
            knowledge=task.data_folder.knowledge,
        ),
        tell=task.tell,
    )
    if request.nc_control is not None:
        _name_code(task)
    task.keep({
        **json.loads(plan_json(outcome.plan, outcome.confirmation, outcome.along)),
        "program": name,
        "is_written": outcome.written is not None,
        "nc_control": request.nc_control,
    })


def _name_code(task: RunningJob) -> None:
    """Rename the NC code file to the name under which it is served."""
    stem = OPTIMISED.removesuffix(".stpnc")
    for file in task.folder.glob(f"{stem}.*"):
        if file.name != OPTIMISED:
            file.replace(task.folder / NC_CODE)
