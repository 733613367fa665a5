"""LinuxCNC behind the ports of the loop, with a component that says what a test wants."""

from collections.abc import Mapping
from dataclasses import replace
from math import isnan, nan
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from extras.linuxcnc.drive import (
    CoursePlaces,
    LinuxCncMachine,
    Load,
    require_adaptive,
    require_process,
)
from extras.linuxcnc.link import ControlState, Link
from simulator.errors import MachineSilent, SimulationError
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from stepnc_model.errors import StepNcError
from tests.service.verbs.control.states import STATE
from tests.simulator.plant.courses import course

CELLS = 400


def state_of(**changes: Any) -> ControlState:
    values = {**STATE, **changes}
    values.pop("refused")
    return ControlState(**values)


class SaidLink:
    """Component that sends states one after another, and keeps what it was sent."""

    def __init__(self, *states: ControlState) -> None:
        self.states, self.sent = list(states), list[dict[str, Any]]()

    def send(self, words: Mapping[str, Any]) -> None:
        self.sent.append(dict(words))

    def state(self) -> ControlState:
        if not self.states:
            raise MachineSilent(0.0)
        return self.states.pop(0)


def straight(*, force: float = 200.0, lines: int = 1) -> NominalCourse:
    """A cut of 40 mm along x at 10 mm/s."""
    made = course(np.full(CELLS, force))
    position = np.zeros((CELLS, 3), np.float32)
    position[:, 0] = 0.1 * (np.arange(CELLS) + 0.5)
    line = 1 + np.arange(CELLS) * lines // CELLS
    return replace(made, position=position, line=line)


def machine_of(
    *states: ControlState,
    on: NominalCourse | None = None,
    hidden: HiddenTruth | None = None,
    load: Load | None = None,
) -> tuple[LinuxCncMachine, SaidLink]:
    link = SaidLink(*states)
    made = LinuxCncMachine(
        cast("Link", link),
        straight() if on is None else on,
        hidden=hidden or HiddenTruth(),
        load=load or Load(),
        efficiency=0.8,
    )
    return made, link


def cut(time: float, **changes: Any) -> ControlState:
    values = {"time": time, "position": (10.0 * time, 0.0, 0.0), **changes}
    return state_of(**values)


def test_a_reading_is_at_the_place_of_the_tool_with_the_force_of_its_feed() -> None:
    slow = {"speed": 5.0}
    machine, _ = machine_of(cut(1.0, **slow), cut(1.02, **slow))
    reading = machine.read()
    assert reading is not None
    assert reading.progress == pytest.approx(1.02, abs=0.006)
    assert reading.override == pytest.approx(0.5)
    # Half of the feed: the exponent of the course is 0.8.
    assert reading.force == pytest.approx([200.0 * 0.5**0.8])


def test_hidden_steps_change_the_force_at_their_time() -> None:
    hidden = HiddenTruth(
        changes=(HiddenChange(time=0.1, what=HiddenQuantity.HARDNESS, value=1.4),)
    )
    machine, _ = machine_of(cut(0.0), cut(0.05), cut(0.12), cut(0.14), hidden=hidden)
    first, second = machine.read(), machine.read()
    assert first is not None
    assert second is not None
    assert first.force == pytest.approx([200.0], rel=1e-5)
    assert second.force == pytest.approx([280.0], rel=1e-5)


def test_no_more_than_the_programmed_feed_is_commanded() -> None:
    machine, link = machine_of()
    machine.set(1.2)
    assert link.sent[-1]["override"] == 1.0
    with pytest.raises(ValueError, match="finite"):
        machine.set(nan)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"is_estop": True}, "emergency stop"),
        ({"is_on": False}, "emergency stop"),
        ({"is_tripped": True}, "hard load limit"),
        ({"is_armed": False}, "watchdog"),
        ({"feed_override": 0.8}, "override is 80 %, not 100 %"),
        ({"is_adaptive": False}, "no M52 P1"),
        ({"is_hold_allowed": False}, "M53 P0"),
    ],
)
def test_what_the_loop_cannot_steer_is_held_and_told(
    change: dict[str, Any], words: str
) -> None:
    machine, link = machine_of(cut(0.0), cut(0.02, **change))
    with pytest.raises(MachineSilent, match=words):
        machine.read()
    machine.set(0.2)
    assert link.sent[-1]["hold"], "the safe override does not release the hold"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"feed_override": 1.2}, "override is 120 %, not 100 %"),
        ({"is_on": False}, "machine is off"),
        ({"is_armed": False}, "not armed"),
    ],
)
def test_nothing_starts_unless_all_is_as_agreed(change: dict[str, Any], words: str) -> None:
    waits = {"is_running": False, "line": 0}
    states = [cut(time, **waits, **change) for time in (0.0, 0.6, 1.2)]
    with pytest.raises(SimulationError, match=words):
        machine_of(*states)[0].start()


def test_a_program_that_does_not_begin_is_told() -> None:
    states = [cut(time, is_running=False, line=0) for time in (0.0, 61.0)]
    with pytest.raises(SimulationError, match="no program began within 60 s"):
        machine_of(*states)[0].start()


def test_the_end_of_the_program_ends_the_readings_and_holds_nothing() -> None:
    machine, link = machine_of(cut(0.0), cut(0.02, is_running=False))
    assert machine.read() is None
    machine.close()
    assert not any(each["hold"] for each in link.sent)


def test_a_loop_that_leaves_early_holds_the_feed() -> None:
    machine, link = machine_of(cut(0.0), cut(0.02), cut(0.03))
    machine.read()
    machine.close()
    assert link.sent[-1]["hold"]


def test_a_load_that_never_changes_in_a_cut_is_stale() -> None:
    times = np.arange(0.0, 2.3, 0.02)
    states = [cut(time, load=190.0) for time in times]
    machine, _ = machine_of(*states, load=Load(pin="load", watts=0.0))
    forces = [machine.read() for _ in times[1:]]
    shown = [float(each.force[0]) for each in forces if each is not None]
    assert shown[0] == 190.0
    assert isnan(shown[-1])


def test_a_load_in_per_cent_is_a_power() -> None:
    machine, link = machine_of(
        cut(0.0, load=20.0), cut(0.02, load=21.0), load=Load(pin="vfd.load", watts=150.0)
    )
    reading = machine.read()
    assert reading is not None
    assert reading.power == pytest.approx(3150.0)
    assert link.sent[-1]["load_pin"] == "vfd.load"


def test_the_place_is_within_the_line_that_runs() -> None:
    # The path comes back along itself: only the line tells where the tool is.
    there = straight(lines=2)
    position = there.position.copy()
    position[CELLS // 2 :, 0] = position[: CELLS // 2, 0][::-1]
    places = CoursePlaces(replace(there, position=position))
    at = (5.0, 0.0, 0.0)
    assert places.nearest(state_of(position=at, line=1), 0.0)[0] == pytest.approx(0.5, abs=0.01)
    assert places.nearest(state_of(position=at, line=2), 0.0)[0] == pytest.approx(3.5, abs=0.01)
    # It never goes back.
    assert places.nearest(state_of(position=at, line=1), 3.5)[0] == 3.5


def test_only_hardness_and_depth_are_hidden_behind_real_motion() -> None:
    with pytest.raises(StepNcError, match="only kc, hardness, material and depth"):
        require_process(HiddenTruth(flank_wear=0.2), Load())
    with pytest.raises(StepNcError, match="a measured load is not disturbed"):
        require_process(HiddenTruth(force_factor=1.2), Load(pin="load"))


def test_code_without_adaptive_feed_is_refused(tmp_path: Path) -> None:
    code = tmp_path / "part.ngc"
    code.write_text("G21\nM52 P0\nM2\n")
    with pytest.raises(StepNcError, match="no M52 P1"):
        require_adaptive(code)
    code.write_text("G21\nN20 m52 p1\nM2\n")
    require_adaptive(code)
