"""Jobs ``trial`` and ``control-run``: runs that people watch and change as they go on."""

from collections.abc import Mapping
from typing import Any

from service.control.facts import exceeded, rows
from service.control.live import LiveControl
from service.control.record import keep
from service.control.run import prepare
from service.jobs.task import RunningJob, samples_place
from service.live.runner import LiveRunner
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from service.storage.results import REPORT
from service.trial.request import TrialRequest
from service.trial.run import TrialRun
from service.verbs.control.result import ControlResult


def run_trial(task: RunningJob) -> None:
    """Run a trial cut until it is ended.

    Raises
    ------
    StepNcError
        When an input exceeds its bounds.
    """
    request = task.request(TrialRequest)
    trial = TrialRun(request.inputs, seed=request.seed)
    LiveRunner(run=trial, folder=task.live, pace=request.pace).go()
    task.keep({"status": trial.snapshot()})


def run_control(task: RunningJob) -> None:
    """Run a program under force control.

    Raises
    ------
    StepNcError
        As :func:`service.control.run.control`.
    """
    request = task.request(ControlRequest)
    file, name = task.program_file()
    files = RunFiles(
        file=file, name=name, output=samples_place(task.folder), report=task.folder / REPORT
    )
    session = prepare(request, files, knowledge=task.data_folder.knowledge, tell=task.tell)
    live = LiveControl(session)

    def tell(status: Mapping[str, Any]) -> None:
        task.progress(status["progress_share"], status["workingstep"])

    try:
        LiveRunner(run=live, folder=task.live, pace=request.pace, tell=tell).go()
    finally:
        run = live.finish()
    found = ControlResult(run=run)
    if run.trace is not None:
        task.keep_report(found.page())
    if request.is_recorded:
        trace = f"/v1/control-runs/{task.job.id}/samples"
        keep(run, task.data_folder.knowledge, by=task.job.owner, trace=trace, tell=task.tell)
    task.keep({**found.record(), "is_good": not exceeded(run, rows(run))})
