"""Worked problems of Mitsubishi Materials, "Technical information", formulae for cutting.

Pages "Formula for turning", "Formula for face milling", "Cutting power for turning" and
"Cutting power for face milling" of the maker's public technical information. The print takes
π = 3.14 and rounds, hence the tolerances.
"""

import pytest

from simulator.physics import cutting as power
from simulator.physics import engagement, kinematics, surface
from stepnc_model.units import (
    kw_from_watts,
    m_min_from_speed,
    mm_min_from_speed,
    rev_s_from_rpm,
    rpm_from_rev_s,
    speed_from_m_min,
    speed_from_mm_min,
    um_from_mm,
)
from tests.oracles import cutting as oracle
from tests.oracles import motion as moves


def test_turning_at_700_rpm_on_50_mm_cuts_with_110_m_min() -> None:
    speed = kinematics.cutting_speed(50.0, rev_s_from_rpm(700.0))
    assert m_min_from_speed(speed) == pytest.approx(110.0, rel=0.002)


def test_120_mm_min_at_500_rpm_is_0_24_mm_a_revolution() -> None:
    feed = kinematics.feed_per_tooth(speed_from_mm_min(120.0), rev_s_from_rpm(500.0))
    assert feed == pytest.approx(0.24)


def test_turning_100_mm_at_0_2_mm_and_1000_rpm_takes_30_s() -> None:
    feed = kinematics.feed(0.2, rev_s_from_rpm(1000.0))
    assert moves.machining_time(100.0, feed) == pytest.approx(30.0)


def test_feed_0_2_and_corner_0_8_leave_6_25_micrometres() -> None:
    depth = oracle.RT_PER_RA * surface.corner_coefficient(0.8) * 0.2**2
    assert um_from_mm(depth) == pytest.approx(6.25)


def test_milling_at_350_rpm_with_125_mm_cuts_with_137_4_m_min() -> None:
    speed = kinematics.cutting_speed(125.0, rev_s_from_rpm(350.0))
    assert m_min_from_speed(speed) == pytest.approx(137.4, rel=0.001)


def test_500_mm_min_at_500_rpm_and_10_teeth_is_0_1_mm_a_tooth() -> None:
    feed = kinematics.feed_per_tooth(speed_from_mm_min(500.0), rev_s_from_rpm(500.0), teeth=10)
    assert feed == pytest.approx(0.1)


def test_0_1_mm_a_tooth_at_500_rpm_and_10_teeth_is_500_mm_min() -> None:
    feed = kinematics.feed(0.1, rev_s_from_rpm(500.0), teeth=10)
    assert mm_min_from_speed(feed) == pytest.approx(500.0)


@pytest.mark.parametrize("radial_width", [50.0, 120.0, 200.0])
def test_face_milling_300_mm_with_200_mm_cutter_takes_37_5_s(radial_width: float) -> None:
    feed = kinematics.feed(0.25, rev_s_from_rpm(200.0), teeth=16)
    time = moves.machining_time(
        300.0,
        feed,
        approach=engagement.centred_approach(200.0, radial_width),
        overrun=oracle.centred_overrun(200.0, radial_width),
    )
    assert mm_min_from_speed(feed) == pytest.approx(800.0)
    assert time == pytest.approx(37.5)


def test_turning_mild_steel_takes_4_65_kw() -> None:
    rate = oracle.turning_removal_rate(0.2, depth=3.0, cutting_speed=speed_from_m_min(120.0))
    motor = power.motor_power(oracle.removal_power(3100.0, rate), 0.8)
    assert kw_from_watts(motor) == pytest.approx(4.65, rel=1e-3)


def test_milling_tool_steel_takes_1_68_kw() -> None:
    spindle_speed = kinematics.spindle_speed(250.0, speed_from_m_min(80.0))
    feed = speed_from_mm_min(280.0)
    rate = kinematics.milling_removal_rate(feed, axial_depth=2.0, radial_width=80.0)
    motor = power.motor_power(oracle.removal_power(1800.0, rate), 0.8)
    assert rpm_from_rev_s(spindle_speed) == pytest.approx(101.91, rel=0.001)
    assert kinematics.feed_per_tooth(feed, spindle_speed, teeth=12) == pytest.approx(
        0.228, rel=0.005
    )
    assert kw_from_watts(motor) == pytest.approx(1.68, rel=1e-3)
