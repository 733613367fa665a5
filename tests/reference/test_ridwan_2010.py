"""Ridwan, Xu and Liu, "A framework for machining optimisation based on STEP-NC", 2010.

Table 2 and Fig. 11: motor 0.29 kW, efficiency 0.9, depth 3 mm, 35 m/min, k_s 1000 N/mm², Ø18.
The paper prints no solution; the figures below are the closed form
``f = 2π·F_mt/(k_s·a·C)`` evaluated, and the consequences of its misprints.
"""

from math import pi

import pytest

from simulator.physics import cutting as power
from simulator.physics import engagement, kinematics, milling, surface
from simulator.physics.engagement import Engagement
from simulator.spec import Kienzle
from stepnc_model.units import (
    kw_from_watts,
    mm_min_from_speed,
    rpm_from_rev_s,
    speed_from_m_min,
)
from tests.oracles.motion import machining_time

DIAMETER = 18.0  # mm
DEPTH = 3.0  # mm
SPEED = speed_from_m_min(35.0)
SPINDLE = kinematics.spindle_speed(DIAMETER, SPEED)
MOTOR = 290.0  # W
EFFICIENCY = 0.9
FORCE = 1000.0 * MOTOR * EFFICIENCY / SPEED  # N
PAPER = Kienzle(k_c11=1000.0, m_c=0.0)
FULL = engagement.full_immersion()
HALF = engagement.unidirectional(9.0, DIAMETER)


def feed_at_motor_limit(kienzle: Kienzle, arc: Engagement, teeth: int) -> float:
    """Feed per tooth at which the mean force is the motor's: F ∝ f_z^(1−m)."""
    cut = milling.MillingCut(feed_per_tooth=0.1, teeth=teeth, axial_depth=DEPTH, engagement=arc)
    ratio = FORCE / milling.mean_force(kienzle, cut)
    return float(0.1 * ratio ** (1.0 / (1.0 - kienzle.m_c)))


def motor_kw(feed_per_tooth: float, *, teeth: int) -> float:
    """Motor power of a full slot in kW."""
    cut = milling.MillingCut(
        feed_per_tooth=feed_per_tooth, teeth=teeth, axial_depth=DEPTH, engagement=FULL
    )
    cutting_power = power.cutting_power(milling.mean_force(PAPER, cut), SPEED)
    return kw_from_watts(power.motor_power(cutting_power, EFFICIENCY))


def test_spindle_speed_and_force_of_the_motor() -> None:
    assert rpm_from_rev_s(SPINDLE) == pytest.approx(618.9, abs=0.05)
    assert pytest.approx(447.429, rel=1e-6) == FORCE


@pytest.mark.parametrize(
    ("teeth", "feed_per_tooth"),
    [(1, 0.4685), (2, 0.2343), (3, 0.1562), (4, 0.1171), (6, 0.0781), (8, 0.0586)],
)
def test_full_immersion_optimum_for_each_number_of_teeth(
    teeth: int, feed_per_tooth: float
) -> None:
    f_z = feed_at_motor_limit(PAPER, FULL, teeth)
    feed = kinematics.feed(f_z, SPINDLE, teeth=teeth)
    assert f_z == pytest.approx(feed_per_tooth, abs=6e-5)
    assert mm_min_from_speed(feed) == pytest.approx(290.0)


@pytest.mark.parametrize("radial_width", [4.5, 9.0, 13.5, 18.0])
def test_every_immersion_removes_the_same_volume_at_the_motor_limit(
    radial_width: float,
) -> None:
    arc = engagement.unidirectional(radial_width, DIAMETER)
    feed = kinematics.feed(feed_at_motor_limit(PAPER, arc, 4), SPINDLE, teeth=4)
    rate = kinematics.milling_removal_rate(feed, axial_depth=DEPTH, radial_width=radial_width)
    assert rate * 60.0 == pytest.approx(15_660.0, rel=1e-3)


@pytest.mark.parametrize("diameter", [6.0, 18.0, 100.0])
def test_diameter_cancels_at_fixed_cutting_speed(diameter: float) -> None:
    arc = engagement.bilateral(0.4 * diameter, diameter)
    reference = engagement.bilateral(0.4 * DIAMETER, DIAMETER)
    assert feed_at_motor_limit(PAPER, arc, 4) == pytest.approx(
        feed_at_motor_limit(PAPER, reference, 4)
    )


@pytest.mark.parametrize(
    ("teeth", "immersion"), [(4, 0.2929), (2, 0.5857), (8, (1.0 - 2.0**-0.5) / 2.0)]
)
def test_settings_that_give_the_0_4_mm_of_table_1(teeth: int, immersion: float) -> None:
    arc = engagement.unidirectional(immersion * DIAMETER, DIAMETER)
    assert feed_at_motor_limit(PAPER, arc, teeth) == pytest.approx(0.4, abs=2e-4)


@pytest.mark.parametrize(("feed", "kilowatt"), [(0.5, 0.3095), (0.4, 0.2476), (0.33, 0.2042)])
def test_steps_of_0_1_mm_with_one_tooth_stop_at_0_4(feed: float, kilowatt: float) -> None:
    assert motor_kw(feed, teeth=1) == pytest.approx(kilowatt, abs=6e-5)


@pytest.mark.parametrize(
    ("kienzle", "arc", "feed_per_tooth", "feed"),
    [
        (Kienzle(k_c11=1350.0, m_c=0.21), FULL, 0.0402, 99.5),
        (Kienzle(k_c11=1500.0, m_c=0.22), FULL, 0.0335, 82.9),
        (Kienzle(k_c11=1780.0, m_c=0.17), FULL, 0.0344, 85.1),
        (Kienzle(k_c11=1350.0, m_c=0.21), HALF, 0.0966, 239.0),
        (Kienzle(k_c11=1500.0, m_c=0.22), HALF, 0.0815, 202.0),
        (Kienzle(k_c11=1780.0, m_c=0.17), HALF, 0.0792, 196.0),
    ],
)
def test_realistic_specific_force_leaves_a_third_of_the_feed(
    kienzle: Kienzle, arc: Engagement, feed_per_tooth: float, feed: float
) -> None:
    f_z = feed_at_motor_limit(kienzle, arc, 4)
    assert f_z == pytest.approx(feed_per_tooth, abs=6e-5)
    v_f = mm_min_from_speed(kinematics.feed(f_z, SPINDLE, teeth=4))
    assert v_f == pytest.approx(feed, rel=3e-3)


@pytest.mark.parametrize(
    ("kienzle", "specific_force"),
    [
        (Kienzle(k_c11=1350.0, m_c=0.21), 2915.0),
        (Kienzle(k_c11=1500.0, m_c=0.22), 3497.0),
        (Kienzle(k_c11=1780.0, m_c=0.17), 3409.0),
    ],
)
def test_realistic_specific_force_is_three_times_the_paper_s(
    kienzle: Kienzle, specific_force: float
) -> None:
    cut = milling.MillingCut(
        feed_per_tooth=feed_at_motor_limit(kienzle, FULL, 4),
        teeth=4,
        axial_depth=DEPTH,
        engagement=FULL,
    )
    assert milling.mean_specific_force(kienzle, cut) == pytest.approx(specific_force, abs=1.0)


def test_figure_11_contradicts_table_2() -> None:
    """Table 2 has 35 m/min: its 500 rpm are 28, its #40 41, and that feeds 0.83 mm a tooth."""
    slow, fast = (kinematics.cutting_speed(DIAMETER, n) for n in (500.0 / 60.0, 12.0))
    assert (0.06 * slow, 0.06 * fast) == pytest.approx((28.27, 40.72), abs=5e-3)
    assert kinematics.feed_per_tooth(40.0, 12.0, teeth=4) == pytest.approx(0.8333, abs=5e-5)


def test_evaluated_0_33_of_table_1_needs_a_resistance_of_1420() -> None:
    assert 1000.0 * 0.29 / motor_kw(0.33, teeth=1) == pytest.approx(1420.0, abs=1.0)


def test_length_of_table_2_takes_62_s_at_290_mm_min() -> None:
    assert machining_time(300.0, 290.0 / 60.0) == pytest.approx(62.07, abs=5e-3)


def test_all_three_rise_with_the_motor_s_power() -> None:
    """The text says that force, chip load and removal rate fall; they are in proportion."""
    cut = milling.MillingCut(
        feed_per_tooth=2.0 * feed_at_motor_limit(PAPER, FULL, 4),
        teeth=4,
        axial_depth=DEPTH,
        engagement=FULL,
    )
    assert milling.mean_force(PAPER, cut) == pytest.approx(2.0 * FORCE)


def test_printed_equation_12_is_a_factor_1_974_too_small() -> None:
    printed = (8.0 * 0.8 * 1.6e-3) ** 0.5
    assert printed == pytest.approx(0.1012, abs=5e-5)
    correct = (1.6e-3 / surface.corner_coefficient(0.8)) ** 0.5
    assert correct == pytest.approx(0.1998, abs=5e-5)
    assert correct / printed == pytest.approx(1.974, abs=5e-4)


def test_equation_4_in_the_paper_s_units() -> None:
    """k_s·f_s·a_s·(cos φ1 − cos φ2)/(2π·n) with f_s in mm/min and n in rpm."""
    cut = milling.MillingCut(feed_per_tooth=0.2, teeth=3, axial_depth=DEPTH, engagement=HALF)
    feed_mm_min = mm_min_from_speed(kinematics.feed(0.2, SPINDLE, teeth=3))
    printed = 1000.0 * feed_mm_min * DEPTH * 1.0 / (2.0 * pi * rpm_from_rev_s(SPINDLE))
    assert milling.mean_force(PAPER, cut) == pytest.approx(printed)
