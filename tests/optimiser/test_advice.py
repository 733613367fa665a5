"""What is said of a workingstep, and of a whole program."""

from dataclasses import replace
from pathlib import Path

import pytest

from optimiser.advice import AdviceStatus, LimitLoad, Plan
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import BoundSide, Limit, LimitName, Monomial
from simulator.library import load_machine, match_material
from stepnc_model.programs.program import Program

PART = Path(__file__).parents[2] / "examples" / "parts" / "bracket.stpnc"


@pytest.fixture(scope="module")
def plan() -> Plan:
    return optimise_program(
        Program.load(PART),
        machine=load_machine("vmc15"),
        material=match_material(["C45"]),
        task=OptimisationTask(),
        selected=lambda step: step.id in {"ROUGH FACE", "ROUGH POCKET", "REAM HOLE 1"},
    )


@pytest.mark.parametrize(
    ("sense", "value", "margin"),
    [
        (BoundSide.AT_MOST, 150.0, 0.25),
        (BoundSide.AT_MOST, 200.0, 0.0),
        (BoundSide.AT_MOST, 250.0, -0.25),
        (BoundSide.AT_LEAST, 250.0, 0.25),
        (BoundSide.AT_LEAST, 150.0, -0.25),
    ],
)
def test_margin_is_the_share_of_the_bound_that_is_left(
    sense: BoundSide, value: float, margin: float
) -> None:
    limit = Limit(
        name=LimitName.CUTTING_FORCE,
        load=Monomial(coefficient=1.0),
        bound=200.0,
        unit="N",
        sense=sense,
    )
    load = LimitLoad(limit=limit, value=value, bound=200.0)
    assert load.margin == pytest.approx(margin)


def test_times_are_summed_over_the_workingsteps(plan: Plan) -> None:
    before = [advice.before.time for advice in plan.advices if advice.before]
    after = [advice.after.time for advice in plan.advices if advice.after]
    assert len(before) == len(after) == 3
    assert plan.time_before == pytest.approx(sum(before))
    assert plan.time_after == pytest.approx(sum(after))
    assert plan.time_after < plan.time_before


def test_untouched_workingstep_takes_as_long_as_before(plan: Plan) -> None:
    (reaming,) = (each for each in plan.advices if each.status is AdviceStatus.UNTOUCHED)
    assert reaming.after == reaming.before


def test_infeasible_workingstep_counts_as_programmed(plan: Plan) -> None:
    first, *others = plan.advices
    failed = replace(first, status=AdviceStatus.INFEASIBLE, after=None)
    changed = replace(plan, advices=(failed, *others))
    assert changed.is_infeasible
    assert not plan.is_infeasible
    assert first.before is not None
    assert first.after is not None
    longer = first.before.time - first.after.time
    assert changed.time_after == pytest.approx(plan.time_after + longer)


def test_workingstep_of_unknown_time_does_not_count(plan: Plan) -> None:
    advices = tuple(replace(each, before=None, after=None) for each in plan.advices)
    empty = replace(plan, advices=advices)
    assert (empty.time_before, empty.time_after) == (0.0, 0.0)
