from math import asin, atan, cos, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.physics.engagement import Engagement
from simulator.physics.milling import MillingCut, mean_force
from simulator.plant.course import (
    SAMPLES,
    EngagedTeeth,
    pattern,
    peak_over_mean,
    wall_over_mean,
)
from simulator.spec import Kienzle
from tests.simulator.physics.discs import Mill

SLOT = EngagedTeeth(number=2, entry_angle=0.0, exit_angle=pi, exponent=1.0)


@given(
    st.integers(1, 8),
    st.floats(0.0, 3.0),
    st.floats(1e-4, pi),
    st.floats(0.5, 1.0),
    st.floats(0.0, 0.5),
    st.floats(0.0, 5.0),
)
def test_the_mean_of_a_revolution_is_one(
    count: int, entry: float, contact: float, exponent: float, runout: float, lag: float
) -> None:
    teeth = EngagedTeeth(
        number=count,
        entry_angle=entry,
        exit_angle=min(entry + contact, pi),
        exponent=exponent,
        runout=runout,
        lag=lag,
    )
    shape = pattern(teeth)
    assert shape.shape == (count, SAMPLES)
    assert shape.mean() == pytest.approx(1.0)
    assert (shape >= 0.0).all()


def test_one_tooth_of_two_in_a_slot_takes_the_sine() -> None:
    edges = np.linspace(0.0, pi, SAMPLES + 1)
    expected = -np.diff(np.cos(edges)) / np.diff(edges) * pi / 2.0
    for row in pattern(SLOT):
        np.testing.assert_allclose(row, expected, rtol=1e-3)


def test_four_teeth_in_a_half_immersion_never_take_nothing() -> None:
    half = EngagedTeeth(number=4, entry_angle=pi / 2.0, exit_angle=pi, exponent=1.0)
    assert pattern(half).min() > 0.0


def test_runout_loads_the_highest_tooth() -> None:
    shape = pattern(
        EngagedTeeth(number=2, entry_angle=0.0, exit_angle=pi, exponent=1.0, runout=0.2)
    )
    high, low = shape.mean(axis=1)
    # Chips min(sin φ + 0.4, 2·sin φ) and max(sin φ − 0.4, 0), integrated over the arc.
    begin = asin(0.4)
    expected = 0.4 * (pi - 2.0 * begin) + 2.0 * (1.0 - cos(begin))
    assert high - low == pytest.approx(expected, rel=1e-3)


def test_a_broken_tooth_leaves_its_chip_to_the_next() -> None:
    broken = EngagedTeeth(number=2, entry_angle=0.0, exit_angle=pi, exponent=1.0, broken=0)
    none, double = pattern(broken).mean(axis=1)
    assert none == 0.0
    assert double == pytest.approx(2.0)


def test_a_revolution_with_a_broken_tooth_takes_less_by_the_law_of_the_chip() -> None:
    broken = EngagedTeeth(number=2, entry_angle=0.0, exit_angle=pi, exponent=0.75, broken=1)
    assert pattern(broken).mean() == pytest.approx(0.5 * 2.0**0.75)


def test_without_an_arc_the_force_is_even() -> None:
    assert (
        pattern(EngagedTeeth(number=3, entry_angle=0.0, exit_angle=0.0, exponent=0.8)) == 1.0
    ).all()


def test_the_peak_of_a_slot_with_four_teeth_is_that_of_two_at_45_degrees() -> None:
    # Two teeth at 45° and 135°: 1 towards the side and 0.3 against the feed at any rotation,
    # over the mean 4/π of four teeth in a slot.
    slot = EngagedTeeth(number=4, entry_angle=0.0, exit_angle=pi, exponent=1.0)
    assert peak_over_mean(slot) == pytest.approx((1.0 + 0.3**2) ** 0.5 * pi / 4.0, rel=1e-3)


def test_peak_over_mean_is_that_of_the_plan() -> None:
    """Thin discs over the mean force of the physics, D = 12 mm and a_p = 9 mm."""
    law, arc = Kienzle(k_c11=1.0, m_c=0.22), Engagement(entry_angle=1.9, exit_angle=pi)
    cut = MillingCut(feed_per_tooth=1.0, teeth=3, axial_depth=9.0, engagement=arc)
    teeth = EngagedTeeth(number=3, entry_angle=1.9, exit_angle=pi, exponent=0.78, lag=0.8)
    mill = Mill(
        teeth=3,
        diameter=12.0,
        helix=atan(0.8 * 6.0 / 9.0),
        entry=1.9,
        exit=pi,
        depth=9.0,
        exponent=0.78,
    )
    mean = mean_force(law, cut)
    assert peak_over_mean(teeth) == pytest.approx(mill.peak() / mean, rel=0.01)
    assert wall_over_mean(teeth) == pytest.approx(mill.wall(pi) / mean, rel=0.01)


@given(st.floats(0.01, pi), st.floats(0.5, 1.0), st.floats(0.0, 3.0))
def test_no_mean_of_a_single_tooth_is_above_its_peak(
    contact: float, exponent: float, lag: float
) -> None:
    arc = EngagedTeeth(
        number=1, entry_angle=0.0, exit_angle=contact, exponent=exponent, lag=lag
    )
    assert peak_over_mean(arc) >= 1.0


def test_a_helix_evens_the_force_out() -> None:
    straight = EngagedTeeth(number=3, entry_angle=1.9, exit_angle=pi, exponent=0.78)
    spread = [pattern(straight._replace(lag=lag)).std() for lag in (0.0, 0.8, 1.6)]
    assert spread == sorted(spread, reverse=True)
    # At the lag of a tooth pitch the force stays the same.
    assert pattern(straight._replace(lag=2.0 * pi / 3.0)).std() < 1e-3


def test_without_an_arc_the_peak_is_the_mean() -> None:
    nothing = EngagedTeeth(number=2, entry_angle=0.0, exit_angle=0.0, exponent=0.8)
    assert peak_over_mean(nothing) == 1.0
    assert wall_over_mean(nothing) == 0.0
