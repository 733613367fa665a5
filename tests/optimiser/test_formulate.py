"""A cut with its conditions becomes the problem that was meant."""

from dataclasses import replace
from pathlib import Path

import pytest

from optimiser.formulate import Task
from optimiser.limit import LimitName
from optimiser.modes import Free
from optimiser.optimise import optimise
from simulator.library import load_machine
from simulator.matching import match_material
from stepnc_model.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"
TASK = Task()


def plan(task: Task, name: str = "bracket", machine: str = "vmc15"):  # type: ignore[no-untyped-def]
    program = Program.load(PARTS / f"{name}.stpnc")
    material = program.material()
    assert material is not None
    match = match_material((material.standard_identifier, material.material_identifier))
    return optimise(program, machine=load_machine(machine), material=match, task=task)


def test_a_feed_that_is_not_free_stays_and_only_depth_is_chosen() -> None:
    advices = plan(replace(TASK, free=frozenset({Free.DEPTH}))).advices
    kept = [a for a in advices if a.after and a.active is LimitName.PROGRAMMED_FEED]
    assert kept
    for advice in kept:
        assert advice.after.setting.feed == pytest.approx(advice.before.setting.feed)


def test_a_depth_that_is_not_free_stays() -> None:
    for advice in plan(replace(TASK, free=frozenset({Free.FEED}))).advices:
        if advice.after:
            assert advice.after.setting.depth == advice.before.setting.depth


def test_a_free_speed_stays_within_machine_and_grade() -> None:
    for advice in plan(replace(TASK, free=frozenset(Free))).advices:
        if advice.active is None:
            continue
        for load in advice.after.loads:
            if load.limit.name in {LimitName.CUTTING_SPEED, LimitName.SPINDLE_SPEED}:
                assert load.margin >= -1e-9


def test_worn_tools_make_the_freed_spindle_slower() -> None:
    free = replace(TASK, free=frozenset(Free))
    fast = plan(free, "shaft", "lathe22")
    lasting = plan(replace(free, tool_change=600.0), "shaft", "lathe22")
    pairs = [
        (one.after.setting.speed, other.after.setting.speed)
        for one, other in zip(fast.advices, lasting.advices, strict=True)
        if one.active is not None
    ]
    assert all(slow <= quick * (1.0 + 1e-6) for quick, slow in pairs)
    assert any(slow < 0.9 * quick for quick, slow in pairs)


def test_a_corrected_force_moves_the_power_limit() -> None:
    one = plan(TASK, "paper002", "paper002").advices[0]
    harder = plan(replace(TASK, force_factor=1.25), "paper002", "paper002").advices[0]
    assert harder.after.setting.feed == pytest.approx(one.after.setting.feed / 1.25)


def test_an_idle_machine_draws_its_standby_power() -> None:
    state = plan(TASK).advices[0].after
    machine = load_machine("vmc15")
    standby = machine.base_power + machine.coolant_power + machine.spindle.idle_power
    assert state.energy > standby * state.time
