"""What an optimum may change, and what stays as it was programmed."""

from math import pi, sqrt

import pytest

from optimiser.advice import AdviceStatus, Plan
from optimiser.modes import Free
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import LimitName
from tests.optimiser.plans import (
    ALL_FREE,
    advice_of,
    after,
    before,
    plan_of,
)


def test_feed_that_is_not_free_stays() -> None:
    plan = plan_of("bracket", OptimisationTask(free=frozenset({Free.DEPTH})))
    advice = advice_of(plan, "ROUGH POCKET")
    assert advice.status is AdviceStatus.ADVISED
    assert after(advice).setting.feed == pytest.approx(before(advice).setting.feed)
    assert after(advice).setting.passes < before(advice).setting.passes
    assert advice.active is LimitName.PROGRAMMED_FEED


def test_programmed_feed_that_breaks_a_limit_is_infeasible_when_it_is_not_free() -> None:
    """The cap and the held feed conflict."""
    plan = plan_of("shaft", OptimisationTask(free=frozenset({Free.DEPTH}), roughness=0.5e-3))
    advice = advice_of(plan, "FINISH CONTOUR")
    assert advice.status is AdviceStatus.INFEASIBLE
    assert plan.is_infeasible
    assert advice.after is None
    for part in ("roughness", "0.5 µm", "programmed feed", "0.12 mm"):
        assert part in advice.reason


def test_depth_that_is_not_free_stays() -> None:
    plan = plan_of("bracket", OptimisationTask(free=frozenset({Free.FEED})))
    for advice in plan.advices:
        if advice.status is AdviceStatus.ADVISED:
            setting, given = after(advice).setting, before(advice).setting
            assert (setting.depth, setting.passes) == (given.depth, given.passes)


def test_speed_that_is_not_free_stays(bracket: Plan) -> None:
    for advice in bracket.advices:
        assert after(advice).setting.speed == before(advice).setting.speed


def test_free_speed_lies_in_the_window_of_the_tool() -> None:
    """End mills of carbide in C45: 200 to 250 m/min."""
    advice = advice_of(plan_of("bracket", OptimisationTask(free=ALL_FREE)), "ROUGH POCKET")
    velocity = pi * 12.0 * after(advice).setting.speed * 60.0 / 1000.0
    assert 200.0 - 1e-6 <= velocity <= 250.0 + 1e-6


def test_free_speed_is_never_slower_where_the_programmed_one_is_allowed() -> None:
    fixed, free = (
        plan_of("bracket", OptimisationTask()),
        plan_of("bracket", OptimisationTask(free=ALL_FREE)),
    )
    compared = 0
    for one, other in zip(fixed.advices, free.advices, strict=True):
        is_allowed = all(
            load.margin >= 0.0
            for load in before(one).loads
            if load.limit.name is LimitName.CUTTING_SPEED
        )
        if one.status is AdviceStatus.ADVISED and is_allowed:
            compared += 1
            assert after(other).time <= after(one).time * (1.0 + 1e-8)
    assert compared >= 2


def test_finishing_operations_keep_their_depth() -> None:
    plan = plan_of("bracket", OptimisationTask(free=ALL_FREE))
    for name in ("FINISH CONTOUR", "FINISH POCKET", "DRILL HOLE 1"):
        advice = advice_of(plan, name)
        assert after(advice).setting.depth == before(advice).setting.depth


def test_floor_of_a_bottom_and_side_finish_limits_the_feed_too() -> None:
    """Eight millimetres of floor instead of 0.2 mm."""
    thin = plan_of("bracket", OptimisationTask())
    thick = plan_of("bracket", OptimisationTask(), ("4.,6.,0.3,0.2", "4.,6.,0.3,8."))
    name = "FINISH POCKET"
    forces = [after(advice_of(plan, name)).cutting_force for plan in (thin, thick)]
    assert forces[1] > 5.0 * forces[0]


def test_roughness_of_the_floor_limits_the_feed_too() -> None:
    """The floor's ideal Ra 0.4 µm at a corner of 0.2 mm; 0.2 µm of it are there at any feed.

    No feed promises so fine a surface, so that the program's feed is not passed either.
    """
    wide = ("#510=PLUS_MINUS_VALUE(0.1,0.1,3)", "#510=PLUS_MINUS_VALUE(0.2,0.2,3)")
    advice = advice_of(
        plan_of("bracket", OptimisationTask(roughness=0.4e-3), wide), "FINISH POCKET"
    )
    ideal = sqrt(18 * sqrt(3) * 0.2 * 0.2e-3)
    feed = after(advice).setting.feed
    assert feed == pytest.approx(min(ideal, before(advice).setting.feed))
    load = next(each for each in after(advice).loads if each.limit.name is LimitName.ROUGHNESS)
    assert load.limit.feed_at_bound(1.0, 1.0) >= feed
