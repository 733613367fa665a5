"""A plan that is slower than its program says why, and what would help."""

import pytest

from optimiser.advice import AdviceStatus
from optimiser.planning.formulate import LEAST_DEPTH, OptimisationTask
from optimiser.planning.reasons import REMEDIES, slower_than_programmed
from optimiser.solver.problem import LimitName
from tests.optimiser.plans import advice_of, after, measured, plan_of

SLENDER = (
    "#422=MILLING_TOOL_DIMENSION(12.,$,$,26.,",
    "#422=MILLING_TOOL_DIMENSION(3.,$,$,26.,",
)

VERY_SLENDER = (SLENDER[0], "#422=MILLING_TOOL_DIMENSION(2.,$,$,26.,")


def test_a_slower_workingstep_names_the_bound_that_the_program_breaks() -> None:
    """MILL SLOT bends its tool by 0.0298 mm at the quantile, of 0.025 mm."""
    (told,) = slower_than_programmed(measured("bracket", OptimisationTask()))
    assert told.startswith("MILL SLOT takes 43.21 s instead of 41.15 s: as programmed")
    assert "0.02362 mm (× 1.263 for the spread of k_c) exceeds its bound of 0.025 mm" in told
    assert "by 19.4 %" in told
    assert told.endswith("or an allowance for a finishing pass would help")


@pytest.mark.parametrize("tool", [SLENDER, VERY_SLENDER])
def test_a_tool_that_bends_too_much_is_infeasible_as_tooled(tool: tuple[str, str]) -> None:
    """At 3 mm it would take 60 passes of 0.1 mm and 20 700 s of 116; at 2 mm it rubs."""
    plan = plan_of("bracket", OptimisationTask(), tool)
    advice = advice_of(plan, "MILL SLOT")
    assert advice.status is AdviceStatus.INFEASIBLE
    assert advice.reason.startswith("infeasible as tooled: tool deflection ")
    assert "a thicker tool or a shorter overhang" in advice.reason
    assert any(advice.reason in text for text in slower_than_programmed(plan))


def test_no_planned_pass_is_thinner_than_the_least_depth() -> None:
    for tool in ((), (SLENDER,)):
        plan = plan_of("bracket", OptimisationTask(), *tool)
        advised = [each for each in plan.advices if each.status is AdviceStatus.ADVISED]
        assert advised
        assert min(after(each).setting.depth for each in advised) >= LEAST_DEPTH


def test_what_would_help_is_known_for_every_limit_that_holds_a_feed() -> None:
    """A chip that is too thin needs more feed, which the other limit does not allow."""
    # What a reamer takes off does not depend on its feed.
    # The feed of least cost is an optimum, which nothing need lift.
    without = {LimitName.CHIP_THICKNESS, LimitName.ALLOWANCE, LimitName.LEAST_COST}
    assert set(LimitName) - set(REMEDIES) == without
