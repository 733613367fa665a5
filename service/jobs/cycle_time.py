"""Job ``cycle-time``: time of a program as programmed, predicted and logged."""

import json
from dataclasses import replace

from service.blocks.cycle_output import cycle_time_json, cycle_time_page
from service.blocks.cycle_time import CycleTimeRequest, cycle_time
from service.file_names import naming, with_names
from service.files import write_atomically
from service.jobs.logs import log_of, told
from service.jobs.task import REPORT, RunningJob
from service.requests.stored_cycle_time import QueuedCycleTime


def run(task: RunningJob) -> None:
    """Estimate a cycle time and store result and report.

    Raises
    ------
    StepNcError
        As :func:`service.blocks.cycle_time.cycle_time`; and when an agent does not answer.
    """
    request = task.request(QueuedCycleTime)
    program, name = task.program_file()
    log = log_of(task, request)
    names = {program: name} | ({} if log is None else {log.path: log.name})
    with naming(names):
        found = cycle_time(
            CycleTimeRequest(
                file=program,
                machine=request.machine,
                log="" if log is None else str(log.path),
                program=request,
                control=request.control,
            ),
            tell=lambda message: told(task, with_names(message, names)),
        )
    findings = (
        replace(each, message=with_names(each.message, names)) for each in found.findings
    )
    found = replace(
        found, name=name, findings=(*(() if log is None else log.findings), *findings)
    )
    write_atomically(task.folder / REPORT, cycle_time_page(found).encode())
    task.keep({
        **json.loads(cycle_time_json(found)),
        "log": None if log is None else log.name,
    })
