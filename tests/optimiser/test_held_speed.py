"""The greatest cutting speed and the spindle's range hold whether the speed is free or not."""

from dataclasses import replace
from math import pi

import pytest

from optimiser.advice import AdviceStatus, Plan
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from simulator.library import load_machine, match_material
from simulator.spec import Machine
from stepnc_model.errors import Severity
from tests.optimiser.plans import ALL_FREE, advice_of, after, before, edited, plan_of

TITANIUM_MILLED, TITANIUM_REAMED = 90.0, 10.0
"""m/min, greatest speeds of solid carbide and of reamers in Ti-6Al-4V of the library"""


def titanium(*changes: tuple[str, str], machine: Machine | None = None, **more: object) -> Plan:
    return optimise_program(
        edited("bracket", *changes),
        machine=machine or load_machine("vmc15"),
        material=match_material(["ti6al4v"]),
        task=OptimisationTask(**more),  # type: ignore[arg-type]
    )


@pytest.fixture(scope="module")
def plan() -> Plan:
    return titanium()


def speed(advice_diameter: float, spindle: float) -> float:
    return pi * advice_diameter * spindle * 0.06


@pytest.mark.parametrize("name", ["ROUGH CONTOUR", "FINISH CONTOUR", "MILL SLOT"])
def test_no_speed_above_the_window_of_the_grade_is_advised(plan: Plan, name: str) -> None:
    """End mills in titanium ran at 90 to 121 m/min with exit code 0."""
    advice = advice_of(plan, name)
    diameter = advice.tool.diameter
    assert speed(diameter, before(advice).setting.speed) > TITANIUM_MILLED
    assert speed(diameter, after(advice).setting.speed) == pytest.approx(TITANIUM_MILLED)
    said = [
        str(finding) for finding in plan.findings if "m/min exceeds 90 m/min" in str(finding)
    ]
    assert any("; changed to 1432 rpm" in text for text in said)


def test_a_speed_below_the_window_stays_until_it_is_free() -> None:
    held = advice_of(plan_of("bracket", OptimisationTask()), "ROUGH CONTOUR")
    assert after(held).setting.speed == before(held).setting.speed
    assert held.saving_of_free_speed > 0.0
    freed = advice_of(plan_of("bracket", OptimisationTask(free=ALL_FREE)), "ROUGH CONTOUR")
    assert speed(20.0, after(freed).setting.speed) >= 200.0 - 1e-6
    assert freed.saving_of_free_speed == 0.0


def test_what_a_free_speed_saves_is_what_it_saves() -> None:
    """By features, where no path changes with the passes."""
    held, freed = (
        plan_of("bracket", OptimisationTask()),
        plan_of("bracket", OptimisationTask(free=ALL_FREE)),
    )
    for one, other in zip(held.advices, freed.advices, strict=True):
        if one.status is AdviceStatus.ADVISED:
            saved = after(one).time - after(other).time
            assert one.saving_of_free_speed == pytest.approx(max(0.0, saved), abs=1e-6)


def test_what_nobody_may_touch_and_is_too_fast_is_a_fault(plan: Plan) -> None:
    advice = advice_of(plan, "REAM HOLE 1")
    assert advice.status is AdviceStatus.UNTOUCHED
    assert any(
        "REAM HOLE 1: cutting speed 12.06 m/min exceeds" in fault for fault in plan.faults
    )
    errors = [str(each) for each in plan.findings if each.severity is Severity.ERROR]
    assert any(
        "the program locks the speed, and cutting speed 12.06" in text for text in errors
    )
    assert "the program locks this feed, and cutting speed 12.06 m/min exceeds" in advice.reason


def test_the_spindle_turns_no_faster_than_it_can() -> None:
    machine = load_machine("vmc15")
    slow = replace(machine, spindle=replace(machine.spindle, max_speed=25.0))
    advice = advice_of(
        optimise_program(
            edited("bracket"),
            machine=slow,
            material=match_material(["C45"]),
            task=OptimisationTask(),
        ),
        "ROUGH CONTOUR",
    )
    assert before(advice).setting.speed == pytest.approx(26.5)
    assert after(advice).setting.speed == pytest.approx(25.0)


@pytest.mark.parametrize(
    ("programmed", "reason"),
    [
        ("60.", "and cutting speed 339.3 m/min exceeds 240 m/min"),
        ("100.", "and spindle speed 6000 rpm exceeds 4000 rpm"),
    ],
)
def test_a_thread_too_fast_is_a_fault(programmed: str, reason: str) -> None:
    usual = advice_of(plan_of("shaft", OptimisationTask()), "THREAD M30 X 2")
    assert usual.status is AdviceStatus.UNTOUCHED
    change = ("#313=CONST_SPINDLE_SPEED(12.5)", f"#313=CONST_SPINDLE_SPEED({programmed})")
    plan = plan_of("shaft", OptimisationTask(), change)
    advice = advice_of(plan, "THREAD M30 X 2")
    assert advice.status is AdviceStatus.UNTOUCHED
    assert reason in advice.reason
    assert len(plan.faults) == 1
