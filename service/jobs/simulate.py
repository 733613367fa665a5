"""The job ``simulation``: a program on the virtual machine, watched while it runs."""

import json
from math import inf

from service.depot.library import machine_word, material_word
from service.files import write_atomically
from service.jobs.task import REPORT, SAMPLES, Task
from service.live.pace import Pace
from service.simulation.live import LiveSamples
from service.simulation.report import simulation_page
from service.simulation.run import SimulationRequest, simulate
from service.simulation.wire import simulation_json

SHOWN = 0.1
"""s of ours between two looks at a run with a pace"""


def run(task: Task) -> None:
    """Simulate.

    Raises
    ------
    StepNcError
        As :func:`service.simulation.run.simulate`.
    """
    asked = task.request
    file, name = task.program_file()
    pace = Pace(asked["pace"])
    live = LiveSamples(task.live, pace.wait_for, apart=pace.factor * SHOWN or inf)
    with live.writer:
        simulation = simulate(
            SimulationRequest(
                file=file,
                name=name,
                machine=machine_word(task.depot, asked["machine"]),
                material=material_word(task.depot, asked["material"]),
                units=asked["units"],
                rate=asked["rate_hz"],
                control=asked["control"],
                noise=asked["noise"],
                has_lag=asked["has_lag"],
                has_wear=asked["has_wear"],
                kc_factor=asked["kc_factor"],
                seed=asked["seed"],
                output=task.folder / SAMPLES,
                report=task.folder / REPORT,
            ),
            tell=task.tell,
            watchers=(live,),
        )
    if simulation.trace is not None:
        page = simulation_page(simulation, simulation.trace, material=simulation.material)
        write_atomically(task.folder / REPORT, page.encode(errors="replace"))
    # What is written and shown is kept under the program's name, not under that of its file.
    task.keep(json.loads(simulation_json(simulation)))
