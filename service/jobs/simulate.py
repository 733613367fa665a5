"""Job ``simulation``: run a program on the virtual machine, watched while it runs."""

from math import inf

from service.files import write_atomically
from service.jobs.task import REPORT, RunningJob, samples_place
from service.live.playback import PlaybackClock
from service.requests.runs import SimulationRequest
from service.simulation.live import LiveSamples
from service.simulation.run import RunFiles, simulate
from service.verbs.simulate.result import SimulateResult

SHOWN = 0.1
"""Wall-clock time between two updates of a paced run, in s."""


def run(task: RunningJob) -> None:
    """Simulate a program and store samples, report and result.

    Raises
    ------
    StepNcError
        As :func:`service.simulation.run.simulate`.
    """
    request = task.request(SimulationRequest)
    file, name = task.program_file()
    pace = PlaybackClock(request.pace)
    live = LiveSamples(task.live, pace.wait_for, apart=pace.factor * SHOWN or inf)
    files = RunFiles(
        file=file, name=name, output=samples_place(task.folder), report=task.folder / REPORT
    )
    with live.writer:
        simulation = simulate(request, files, tell=task.tell, watchers=(live,))
    found = SimulateResult(simulation=simulation)
    if simulation.trace is not None:
        write_atomically(task.folder / REPORT, found.page().encode(errors="replace"))
    # The result names the program as its owner does, not its stored file.
    task.keep(found.record())
