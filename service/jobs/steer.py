"""The jobs ``trial`` and ``control-run``: people watch and change them while they go on."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from service.control.facts import exceeded, rows
from service.control.live import Changes, LiveControl
from service.control.live_run import Taken
from service.control.record import keep
from service.control.report import control_page
from service.control.run import ControlRequest, prepare
from service.control.wire import control_json
from service.depot.library import machine_word, material_word
from service.files import write_atomically
from service.jobs.task import REPORT, SAMPLES, Task
from service.simulation.run import SimulationRequest
from service.steering.helm import Helm
from service.steering.status import status_words
from service.trial.inputs import Inputs, changed
from service.trial.run import TrialRun

UNCHANGED = {"motor_power_percent": 100.0, "depth_percent": 100.0, "hardness_percent": 100.0}
"""of a run of which nothing was asked yet"""

LONGEST = 4 * 3600.0
"""s of a trial: then it was forgotten"""


@dataclass(kw_only=True)
class SteeredTrial:
    """A trial as the helm knows it. Running state."""

    trial: TrialRun
    is_ended: bool = False

    @property
    def time(self) -> float:
        """S of the machine."""
        return self.trial.time

    @property
    def is_waiting(self) -> bool:
        """The loop has stopped it, and it may be begun again."""
        return self.trial.status().is_stopped and not self.is_ended

    def advance(self, until: float) -> bool:
        """See :class:`service.steering.helm.Steered`."""
        if self.is_ended or self.time > LONGEST:
            return False
        return self.trial.advance(until)

    def taken(self) -> Taken:
        """See :class:`service.steering.helm.Steered`."""
        return self.trial.taken()

    def obey(self, order: Mapping[str, Any]) -> None:
        """Inputs to change, ``restart`` or ``end``."""
        if order.get("end"):
            self.is_ended = True
        elif order.get("restart"):
            self.trial.restart()
        elif order:
            self.trial.change(changed(self.trial.inputs, **order))

    def status(self) -> dict[str, Any]:
        """How it is."""
        return status_words(self.trial.status())


@dataclass(kw_only=True)
class SteeredControl:
    """A program under control as the helm knows it. Running state."""

    control: LiveControl
    _asked: dict[str, Any] = field(default_factory=dict)
    """changes that the run has taken"""

    @property
    def time(self) -> float:
        """S of the machine."""
        return self.control.time

    @property
    def is_waiting(self) -> bool:
        """A program that was stopped is over."""
        return False

    def advance(self, until: float) -> bool:
        """See :class:`service.steering.helm.Steered`."""
        return self.control.advance(until)

    def taken(self) -> Taken:
        """See :class:`service.steering.helm.Steered`."""
        return self.control.taken()

    def obey(self, order: Mapping[str, Any]) -> None:
        """What is to be otherwise."""
        if order:
            self.control.change(Changes(**order))
            self._asked |= order

    def status(self) -> dict[str, Any]:
        """How it is, and with what it was told to run; the machine's truth may be another."""
        found, session = status_words(self.control.status()), self.control.session
        held = {"mode": found["criterion"], "is_on": found["is_on"]}
        usual = {**UNCHANGED, "material": session.plan.material.material.name}
        tools = {each.workingstep.id: each.tool.id for each in session.advices if each}
        return {
            **found,
            "tool": tools.get(found["workingstep"], ""),
            "inputs": {**usual, **self._asked, **held},
        }


def run_trial(task: Task) -> None:
    """Run a trial until somebody ends it.

    Raises
    ------
    StepNcError
        When an input is beyond its bounds.
    """
    asked = task.request
    inputs = changed(Inputs(), **asked["inputs"])
    steered = SteeredTrial(trial=TrialRun(inputs, seed=asked["seed"]))
    Helm(run=steered, folder=task.live, pace=asked["pace"]).go()
    task.keep({"status": steered.status()})


def run_control(task: Task) -> None:
    """Run a program under the loop.

    Raises
    ------
    StepNcError
        As :func:`service.control.run.control`.
    """
    asked = task.request
    request = _request(task)
    session = prepare(request, tell=task.tell)
    steered = SteeredControl(control=LiveControl(session))

    def tell(status: Mapping[str, Any]) -> None:
        task.progress(status["progress_share"], status["workingstep"])

    try:
        Helm(run=steered, folder=task.live, pace=asked["pace"], tell=tell).go()
    finally:
        run = steered.control.finish()
    if run.trace is not None:
        write_atomically(
            task.folder / REPORT, control_page(run, run.trace).encode(errors="replace")
        )
    if asked["is_recorded"]:
        trace = f"/v1/control-runs/{task.job.id}/samples"
        keep(run, task.depot.knowledge, by=task.job.owner, trace=trace, tell=task.tell)
    found = json.loads(control_json(run))
    task.keep({**found, "is_good": not exceeded(run, rows(run))})


def _request(task: Task) -> ControlRequest:
    asked = task.request
    file, name = task.program_file()
    return ControlRequest(
        simulation=SimulationRequest(
            file=file,
            name=name,
            machine=machine_word(task.depot, asked["machine"]),
            material=material_word(task.depot, asked["material"]),
            units=asked["units"],
        ),
        mode=asked["mode"],
        law=asked["law"],
        has_preview=asked["has_preview"],
        look_ahead=asked["look_ahead"],
        disturbances=tuple(asked["disturbances"]),
        seed=asked["seed"],
        set_point=asked["force_set_point_n"],
        band=(asked["override_low_percent"], asked["override_high_percent"]),
        sensor=asked["sensor"],
        output=task.folder / SAMPLES,
        report=task.folder / REPORT,
        knowledge=task.depot.knowledge if asked["has_corrections"] else "",
        recorded_by=task.job.owner,
    )
