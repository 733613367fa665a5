"""Both runs that are watched while they run are used alike."""

from collections.abc import Callable

from service.control.live import Changes, ControlStatus, LiveControl
from service.control.live_run import LiveRun, Taken
from service.control.run import ControlRequest, prepare
from service.trial.inputs import Inputs
from service.trial.run import Status, TrialRun


def watched(run: LiveRun[object, ControlStatus] | LiveRun[object, Status]) -> Taken:
    assert run.advance(1.0)
    assert run.time >= 1.0
    assert run.status().time == run.time
    return run.taken()


def test_a_program_and_a_trial_are_watched_alike(
    controlled: Callable[..., ControlRequest],
) -> None:
    program: LiveRun[Changes, ControlStatus] = LiveControl(prepare(controlled()))
    trial: LiveRun[Inputs, Status] = TrialRun(Inputs())
    program.change(Changes(depth_percent=110.0))
    trial.change(Inputs(axial_depth_mm=2.2))
    for run in (program, trial):
        taken = watched(run)  # type: ignore[arg-type]
        assert taken.moments
        assert taken.events[0].text.startswith("depth ")
