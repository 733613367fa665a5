"""Plunge feeds where the axes speed up at the end of the ramp, with a control made by hand."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from optimiser.bounds.plunge_feed import CLOSE, PlungeOptimum, best_plunge, with_plunge_feed
from optimiser.cuts.cut import Cut, PlungeEngagement
from optimiser.solver.problem import Setting
from simulator.physics.engagement import full_immersion
from tests.optimiser.sample_cuts import CARBIDE, CUT

BENT = replace(CARBIDE, deflection=replace(CARBIDE.deflection, value=2e-3))
"""A deflection that holds the ramp."""

RAMP = replace(CUT.bare, engagement=full_immersion())
M_C = BENT.material.kienzle.m_c
RAMP_LENGTH = 200.0


def run_with(share: float) -> Callable[[Cut, Setting], Cut]:
    """A control whose speed at the end of the ramp is a mean of both feeds."""

    def timed(cut: Cut, setting: Setting) -> Cut:
        plunge = setting.plunge_feed or setting.feed
        speed = (1.0 - share) * plunge + share * setting.feed
        over = max(speed / plunge, 1.0) ** (1.0 - M_C)
        rest = RAMP_LENGTH / (CUT.tool.teeth * plunge * setting.speed)
        way_in = PlungeEngagement(ramp=replace(RAMP, fill=over), sine=0.05)
        return replace(cut, way_in=way_in, rest_time=rest / setting.passes)

    return timed


def found(share: float, feed_ratio: float) -> tuple[PlungeOptimum, float]:
    """The search, and the plunge feed that the ramp bears on its own."""
    timed = run_with(share)
    alone = timed(CUT, replace(CUT.programmed, plunge_feed=CUT.programmed.feed))
    alone = replace(alone, way_in=PlungeEngagement(ramp=RAMP, sine=0.05))
    borne = with_plunge_feed(alone, BENT, CUT.programmed).plunge_feed
    assert borne is not None
    setting = replace(CUT.programmed, feed=feed_ratio * borne)
    return best_plunge(alone, BENT, setting, timed), borne


def test_a_pass_that_is_not_faster_leaves_the_plunge_feed_alone() -> None:
    optimum, borne = found(0.5, 0.9)
    assert optimum.setting.plunge_feed == pytest.approx(borne)
    assert optimum.balanced_feed is None


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_the_mean_of_both_feeds_is_what_the_ramp_bears(share: float) -> None:
    optimum, borne = found(share, 1.3)
    plunge = optimum.setting.plunge_feed
    assert plunge is not None
    assert plunge < borne
    mean = (1.0 - share) * plunge + share * 1.3 * borne
    assert mean == pytest.approx(borne, rel=2.0 * CLOSE)
    assert optimum.excess <= 1.0 + CLOSE


def test_a_pass_that_is_too_fast_for_any_plunge_says_so() -> None:
    """At half and half, more than twice what the ramp bears passes it however slow the ramp."""
    optimum, _ = found(0.5, 3.0)
    assert optimum.excess > 1.2
    assert optimum.limit is not None


def test_the_balanced_feed_takes_least_time() -> None:
    """Of all pairs on ``(f + p)/2 = v``, compared on a grid."""
    optimum, borne = found(0.5, 1.5)
    length = CUT.programmed.passes * CUT.length

    def time(feed: float) -> float:
        return length / feed + RAMP_LENGTH / (2.0 * borne - feed)

    grid = [borne * (1.0 + 0.001 * step) for step in range(500)]
    best = min(grid, key=time)
    balanced = optimum.balanced_feed or 1.5 * borne
    assert time(balanced) == pytest.approx(time(best), rel=0.01)
