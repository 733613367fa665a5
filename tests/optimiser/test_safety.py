"""Bounds are kept at a quantile of k_c; what is told stays nominal."""

from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import lognorm

from optimiser.advice import AdviceStatus, Plan
from optimiser.planning.formulate import OptimisationTask
from optimiser.safety import safety_factor
from optimiser.solver.problem import SCALES_WITH_FORCE, LimitName
from tests.every_case import every_case
from tests.optimiser.plans import advice_of, after, measured, plan_of

QUANTILES = st.floats(0.5, 0.999)


@given(spread=st.floats(0.01, 1.0), quantile=QUANTILES)
def test_factor_is_the_quantile_of_a_lognormal_k_c(spread: float, quantile: float) -> None:
    expected = lognorm.ppf(quantile, s=log(1.0 + spread))
    assert safety_factor(spread, quantile) == pytest.approx(expected, rel=1e-9)


def test_nominal_plans_have_no_factor() -> None:
    assert safety_factor(0.2, 0.5) == 1.0
    plan = plan_of("bracket", OptimisationTask(safety=0.5))
    assert {advice.safety_factor for advice in plan.advices} == {1.0}
    assert {advice.cost_of_safety for advice in plan.advices} == {0.0}


@every_case("quantile", [0.49, 0.9991, float("nan")])
def test_other_quantiles_are_refused(quantile: float) -> None:
    with pytest.raises(ValueError, match=r"0\.5 to 0\.999"):
        OptimisationTask(safety=quantile)


def active_shares(plan: Plan) -> list[float]:
    """Nominal load over bound, of limits that hold a feed and move with k_c."""
    return [
        max(
            load.value / load.bound
            for load in after(advice).loads
            if load.limit.name is advice.active
        )
        for advice in plan.advices
        if advice.status is AdviceStatus.ADVISED and advice.active in SCALES_WITH_FORCE
    ]


@pytest.mark.parametrize(("safety", "passed", "within"), [(0.9, 0.10, 0.05), (0.5, 0.50, 0.08)])
def test_every_bound_has_a_margin_for_the_spread_of_k_c(
    safety: float, passed: float, within: float
) -> None:
    """Of 200 draws of k_c, one from each half per cent, so many pass a bound that holds."""
    plan = measured("bracket", OptimisationTask(safety=safety))
    assert plan.material.material.spread == 0.2
    quantiles = (np.arange(200) + np.random.default_rng(7).random(200)) / 200.0
    draws = lognorm.ppf(quantiles, s=log(1.2))
    loads = draws[:, None] * np.array(active_shares(plan))[None, :]
    assert loads.shape[1] >= 3
    assert float((loads > 1.0 + 1e-9).mean()) == pytest.approx(passed, abs=within)


def test_margin_costs_what_a_nominal_plan_saves() -> None:
    """By features, where nothing but the setting changes the time."""
    safe, nominal = (
        plan_of("bracket", OptimisationTask()),
        plan_of("bracket", OptimisationTask(safety=0.5)),
    )
    cost = sum(advice.cost_of_safety for advice in safe.advices)
    assert cost > 10.0
    assert cost == pytest.approx(safe.time_after - nominal.time_after, rel=1e-6)


def test_loads_are_told_nominal_and_bounds_in_full() -> None:
    advice = advice_of(plan_of("bracket", OptimisationTask()), "MILL SLOT")
    (load,) = (
        each for each in after(advice).loads if each.limit.name is LimitName.TOOL_DEFLECTION
    )
    assert load.bound == pytest.approx(0.025)
    assert load.value * safety_factor(0.2, 0.9) == pytest.approx(0.025)
    assert load.margin == pytest.approx(0.0, abs=1e-9)
    assert "(× 1.263 for the spread of k_c) reaches its bound of 0.025 mm" in advice.reason


def test_what_was_learned_of_a_tool_has_its_own_interval() -> None:
    tool = "END MILL 12MM"
    task = OptimisationTask(force_factors={tool: 1.1}, learned_safety_factors={tool: 1.05})
    factors = {
        advice.tool.id: advice.safety_factor for advice in plan_of("bracket", task).advices
    }
    assert factors[tool] == 1.05
    assert factors["END MILL 20MM"] == pytest.approx(safety_factor(0.2, 0.9))


@pytest.mark.parametrize(
    ("part", "machine"), [("paper002", "paper002"), ("bracket", "paper002")]
)
def test_papers_keep_their_limits_alone(part: str, machine: str) -> None:
    plan = plan_of(part, OptimisationTask(), machine=machine)
    assert {advice.safety_factor for advice in plan.advices} == {1.0}
