"""Bounds of workingsteps along their paths, from the advice for them."""

import pytest

from optimiser.advice import Advice, AdviceStatus, Plan
from optimiser.along_path.bounds import bounds_of
from optimiser.along_path.caps import CapName


def of(plan: Plan, name: str) -> Advice:
    """Advice for a workingstep."""
    return next(each for each in plan.advices if each.workingstep.id == name)


def test_a_finished_surface_keeps_its_roughness(bracket: Plan) -> None:
    advice = of(bracket, "FINISH FACE")
    found = bounds_of(advice)
    assert found is not None
    assert advice.after is not None
    assert dict(found.fixed)[CapName.ROUGHNESS] == pytest.approx(advice.after.setting.feed)


def test_a_bar_keeps_its_holding(shaft: Plan) -> None:
    found = bounds_of(of(shaft, "ROUGH CONTOUR"))
    assert found is not None
    assert found.plunge is None
    assert all(feed > 0.0 for _, feed in found.fixed)


def test_a_mill_has_a_feed_straight_down(bracket: Plan) -> None:
    found = bounds_of(of(bracket, "ROUGH POCKET"))
    assert found is not None
    assert found.plunge is not None
    assert found.plunge > 0.0


def test_a_locked_workingstep_has_no_bounds_to_plan_with(bracket: Plan) -> None:
    advice = of(bracket, "REAM HOLE 1")
    assert advice.status is AdviceStatus.UNTOUCHED
