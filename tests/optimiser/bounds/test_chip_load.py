"""Feeds per tooth by engagement: chip thinning, slots, and the least feed."""

from math import asin, pi, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.advice import AdviceStatus
from optimiser.bounds.chip_load import GREATEST_THINNING, feed_factor
from optimiser.planning.formulate import OptimisationTask
from optimiser.solver.problem import BoundSide, LimitName
from simulator.physics.engagement import unidirectional
from simulator.tool_windows import FeedWindow
from tests.every_case import every_case
from tests.optimiser.plans import advice_of, after, before, measured, plan_of

WINDOW = FeedWindow(width_ratio=0.5, slot_factor=0.75)
RATIOS = st.floats(0.001, 1.0)


def factor_of(width_ratio: float, window: FeedWindow = WINDOW) -> float:
    sine = unidirectional(width_ratio, 1.0).greatest_sine if width_ratio < 1.0 else 1.0
    return feed_factor(width_ratio, sine, window)


@every_case(
    ("percent", "factor"), [(50, 1.0), (30, 1.09), (20, 1.25), (10, 1.67), (5, 2.29), (2, 3.57)]
)
def test_chip_thinning_is_that_of_the_tables(percent: int, factor: float) -> None:
    """Radial chip thinning factor ``1/sqrt(1 - (1 - 2·a_e/D)²)`` as catalogues tabulate it."""
    assert factor_of(percent / 100.0) == pytest.approx(factor, abs=0.006)


@given(ratio=RATIOS)
def test_the_chip_is_never_thicker_than_in_the_window(ratio: float) -> None:
    factor = factor_of(ratio)
    thickest = 1.0 if ratio >= 0.5 else 2.0 * sqrt(ratio * (1.0 - ratio))
    assert 0.75 <= factor <= GREATEST_THINNING
    assert factor * thickest <= 1.0 + 1e-9


@given(narrow=RATIOS, wide=RATIOS)
def test_a_wider_cut_bears_no_higher_feed(narrow: float, wide: float) -> None:
    narrow, wide = sorted((narrow, wide))
    assert factor_of(wide) <= factor_of(narrow) + 1e-9


def test_the_widest_and_the_thickest_place_of_the_path_count() -> None:
    """A contour of 0.3 mm is met more deeply in its inner corners than along its walls."""
    cut = advice_of(measured("bracket", OptimisationTask()), "FINISH CONTOUR").cut
    assert cut is not None
    assert cut.chip_sine is not None
    assert cut.width_ratio is not None
    straight = asin(sqrt(0.3 / 20.0)) * 2.0
    assert cut.width_ratio > 0.3 / 20.0
    assert unidirectional(0.3, 20.0).contact_angle == pytest.approx(straight)
    assert unidirectional(0.3, 20.0).greatest_sine < cut.chip_sine < 0.5


def test_chip_load_follows_the_engagement() -> None:
    """0.12 mm a tooth in a full slot of 12 mm before; 0.75 of it is Helical's factor."""
    plan = measured("bracket", OptimisationTask())
    slot = advice_of(plan, "MILL SLOT")
    (bound,) = (
        load.bound
        for load in after(slot).loads
        if load.limit.name is LimitName.FEED_PER_TOOTH and load.limit.sense is BoundSide.AT_MOST
        if load.limit.words == "feed per tooth"
    )
    assert bound == pytest.approx(0.75 * 0.12)
    contour = advice_of(plan, "FINISH CONTOUR")
    assert after(contour).setting.feed > 1.5 * 0.2  # 0.01·D of the catalogue
    assert "× the catalogue value at this engagement" in contour.reason


def test_no_feed_is_below_the_least_at_which_edges_cut() -> None:
    """FINISH FACE had 0.037 mm a tooth where the catalogue begins at 0.08."""
    for advice in measured("bracket", OptimisationTask()).advices:
        if advice.status is AdviceStatus.ADVISED:
            for load in after(advice).loads:
                if load.limit.words.endswith("against rubbing"):
                    assert load.value >= load.bound * (1.0 - 1e-9)
    face = advice_of(measured("bracket", OptimisationTask()), "FINISH FACE")
    assert after(face).setting.feed >= 0.08


def test_roughness_and_rubbing_may_exclude_each_other() -> None:
    """Ra 0.1 µm is finer than any corner leaves at a feed that still cuts."""
    advice = advice_of(plan_of("bracket", OptimisationTask(roughness=0.1e-3)), "FINISH FACE")
    assert advice.status is AdviceStatus.INFEASIBLE


def test_papers_have_no_chip_load_by_engagement() -> None:
    advice = advice_of(plan_of("bracket", OptimisationTask(), machine="paper002"), "MILL SLOT")
    assert advice.cut is not None
    assert not any("rubbing" in load.limit.words for load in before(advice).loads)
    assert advice.cut.engagement is not None
    assert advice.cut.engagement.contact_angle <= pi
