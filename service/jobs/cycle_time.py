"""Job ``cycle-time``: time of a program as programmed, predicted and logged."""

from dataclasses import replace

from service.file_names import naming, with_names
from service.files import write_atomically
from service.jobs.logs import log_of, told
from service.jobs.task import REPORT, RunningJob
from service.requests.given import GIVEN
from service.requests.stored_cycle_time import QueuedCycleTime
from service.verbs.cycletime import run as cycletime
from service.verbs.cycletime.request import CycleTimeFiles, CycleTimeRequest


def run(task: RunningJob) -> None:
    """Estimate a cycle time and store result and report.

    Raises
    ------
    StepNcError
        As :func:`service.verbs.cycletime.run.run`; and when an agent does not answer.
    """
    request = task.request(QueuedCycleTime)
    program, name = task.program_file()
    log = log_of(task, request)
    names = {program: name} | ({} if log is None else {log.path: log.name})
    with naming(names):
        found = cycletime.run(
            CycleTimeRequest(**{
                name: getattr(request, name) for name in (*GIVEN, "machine", "control")
            }),
            CycleTimeFiles(file=program, log=None if log is None else str(log.path)),
            tell=lambda message: told(task, with_names(message, names)),
        )
    findings = (
        replace(each, message=with_names(each.message, names)) for each in found.findings
    )
    found = replace(
        found, name=name, findings=(*(() if log is None else log.findings), *findings)
    )
    write_atomically(task.folder / REPORT, found.page().encode())
    task.keep({
        **found.record(),
        "log": None if log is None else log.name,
    })
