"""A cut with its conditions becomes the problem that was meant."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.modes import Free
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask, problem_of, state_of
from optimiser.solver.problem import LimitName, Setting
from simulator.library import load_machine, load_material, match_material
from simulator.physics.engagement import full_immersion
from simulator.spec import CuttingMaterial, ToolKind
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import Tool

PARTS = Path(__file__).parents[3] / "examples" / "parts"
TASK = OptimisationTask()


def plan(task: OptimisationTask, name: str = "bracket", machine: str = "vmc15"):  # type: ignore[no-untyped-def]
    program = Program.load(PARTS / f"{name}.stpnc")
    material = program.material()
    assert material is not None
    match = match_material((material.standard_identifier, material.material_identifier))
    return optimise_program(program, machine=load_machine(machine), material=match, task=task)


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
    corrected = replace(TASK, force_factors={one.tool.id: 1.25})
    harder = plan(corrected, "paper002", "paper002").advices[0]
    assert harder.after.setting.feed == pytest.approx(one.after.setting.feed / 1.25)


def test_an_idle_machine_draws_its_standby_power() -> None:
    state = plan(TASK).advices[0].after
    machine = load_machine("vmc15")
    standby = machine.base_power + machine.coolant_power + machine.spindle.idle_power
    assert state.energy > standby * state.time


def test_a_correction_is_looked_up_by_tool() -> None:
    task = OptimisationTask(force_factors={"MILL 18MM": 1.31})
    assert task.force_factor("MILL 18MM") == 1.31
    assert task.force_factor("mill 18mm") == 1.0


def test_a_task_keeps_the_factors_it_was_given() -> None:
    factors = {"MILL 18MM": 1.31}
    task = OptimisationTask(force_factors=factors)
    factors["MILL 18MM"] = 2.0
    assert task.force_factor("MILL 18MM") == 1.31
    with pytest.raises(TypeError):
        task.force_factors["MILL 18MM"] = 2.0  # type: ignore[index]


def test_tasks_are_equal_and_hashed_by_value() -> None:
    one, other = (
        OptimisationTask(force_factors={"a": 1.2}),
        OptimisationTask(force_factors={"a": 1.2}),
    )
    assert one == other
    assert hash(one) == hash(other)
    assert one != OptimisationTask()
    assert replace(one, front=True).force_factor("a") == 1.2


@pytest.mark.parametrize("factor", [0.0, -1.0, float("inf"), float("nan")])
def test_a_factor_that_no_force_can_have_is_refused(factor: float) -> None:
    with pytest.raises(ValueError, match="tool 'a': k_c factor must be finite and above 0"):
        OptimisationTask(force_factors={"a": factor})


def test_a_plunge_has_its_thrust_and_power_and_no_part_in_the_cutting_force() -> None:
    """Light passes of 0.1 mm, but a plunge into the solid between them."""
    mill = Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=10.0, teeth=4)
    cut = Cut(
        kind=CutKind.MILLING,
        tool=mill,
        tool_kind=ToolKind.ENDMILL,
        diameter=10.0,
        programmed=Setting(feed=0.05, depth=0.1, passes=10, speed=50.0),
        length=100.0,
        total_depth=1.0,
        is_depth_free=True,
        engagement=full_immersion(),
    )
    down = replace(
        cut, kind=CutKind.DRILLING, tool=replace(mill, point_angle=pi), engagement=None
    )
    at = CuttingConditions(
        machine=load_machine("vmc15"),
        material=load_material("c45"),
        cutting_material=CuttingMaterial.CARBIDE,
        grade=None,
        roughness=None,
    )
    plain, plunged, alone = (
        state_of(each, problem_of(each, at, TASK), at, cut.programmed)
        for each in (cut, replace(cut, plunge=down), down)
    )
    assert plunged.cutting_force == plain.cutting_force < alone.cutting_force
    assert plunged.thrust == alone.thrust > plain.thrust == 0.0
    assert plunged.motor_power == alone.motor_power > plain.motor_power
    assert plunged.time == plain.time
