"""Figures from textbooks and worksheets, each with its source."""

from math import pi, sin, sqrt

import pytest

from simulator.physics import cutting as power
from simulator.physics import (
    drilling,
    engagement,
    kinematics,
    milling,
    surface,
    tool_life,
    turning,
)
from simulator.spec import Kienzle, LinearEdge, Taylor
from stepnc_model.units import (
    deg_from_rad,
    kw_from_watts,
    m_min_from_speed,
    mm_min_from_speed,
    nm_from_nmm,
    rad_from_deg,
    rev_s_from_rpm,
    speed_from_m_min,
    speed_from_mm_min,
    um_from_mm,
)
from tests.oracles import cutting as oracle
from tests.oracles import motion as moves

CONSTANT_1000 = Kienzle(k_c11=1000.0, m_c=0.0)


def test_el_hofy_mean_milling_force_is_1019_n() -> None:
    """El-Hofy, "Fundamentals of Machining Processes", ch. 6: f 120, n 150, t 4; 1019 N."""
    feed = kinematics.feed_per_tooth(speed_from_mm_min(120.0), rev_s_from_rpm(150.0), teeth=8)
    slot = milling.MillingCut(
        feed_per_tooth=feed, teeth=8, axial_depth=4.0, engagement=engagement.full_immersion()
    )
    force = milling.mean_force(CONSTANT_1000, slot)
    assert force == pytest.approx(1018.6, abs=0.05)
    assert round(force) == 1019


def test_el_hofy_time_counts_the_approach() -> None:
    """El-Hofy, ch. 6: 300 mm and 21 mm approach at 120 mm/min take 2.675 min."""
    time = moves.machining_time(300.0, speed_from_mm_min(120.0), approach=21.0)
    assert time / 60.0 == pytest.approx(2.675)


def test_groover_peripheral_milling() -> None:
    """Groover, machining operations: 735 × 50 mm, Ø65, 5 teeth; answer 2.675 min."""
    spindle_speed = kinematics.spindle_speed(65.0, speed_from_m_min(60.0))
    feed = kinematics.feed(0.2, spindle_speed, teeth=5)
    time = moves.machining_time(
        735.0, feed, approach=5.0 + engagement.one_sided_approach(65.0, 7.5), overrun=25.0
    )
    rate = kinematics.milling_removal_rate(feed, axial_depth=50.0, radial_width=7.5)
    assert time / 60.0 == pytest.approx(2.675, rel=1e-3)
    assert rate * 60.0 == pytest.approx(110_188.0, rel=1e-3)


def test_taylor_half_speed_gives_four_lives() -> None:
    """Worksheet WS-CH4: n = 0.5, C = 400 m/min; half the speed adds 300 % of life."""
    taylor = Taylor(exponent=0.5, constant=speed_from_m_min(400.0))
    speed = speed_from_m_min(150.0)
    gain = tool_life.tool_life(taylor, 0.5 * speed) / tool_life.tool_life(taylor, speed) - 1.0
    assert 100.0 * gain == pytest.approx(300.0)


def test_arithmetic_roughness_of_a_round_corner() -> None:
    """El-Hofy: R_a = 1000·f²/(18·√3·r) in µm, and the feed for 1.6 µm."""
    coefficient = surface.corner_coefficient(0.8)
    assert um_from_mm(coefficient * 0.2**2) == pytest.approx(1.6037, rel=1e-3)
    assert sqrt(1.6e-3 / coefficient) == pytest.approx(0.19977, rel=1e-3)


def test_groover_rounds_the_roughness_constant_by_2_6_per_cent() -> None:
    """Groover takes R_a = f²/(32·r)."""
    rounded = 1.0 / (32.0 * 0.8)
    assert rounded / surface.corner_coefficient(0.8) == pytest.approx(0.974, abs=5e-4)


def test_kienzle_turning_force_with_iscar_group_2() -> None:
    """ISCAR table after VDI 3323, group 2 (1500 N/mm², 0.22), κ 95°, 150 m/min."""
    cut = turning.TurningCut(
        feed_per_revolution=0.25, depth=2.5, cutting_edge_angle=rad_from_deg(95.0)
    )
    force = turning.cutting_force(Kienzle(k_c11=1500.0, m_c=0.22), cut)
    assert force == pytest.approx(1272.884, rel=1e-3)
    cutting_power = power.cutting_power(force, speed_from_m_min(150.0))
    assert kw_from_watts(cutting_power) == pytest.approx(3.18221, rel=1e-3)


def test_slot_with_edge_term() -> None:
    """Altintas' linear-edge law, Al 7075-T6 (767.01 N/mm², 27.7 N/mm), Ø10, z 4, 3000 rpm."""
    slot = milling.MillingCut(
        feed_per_tooth=0.1, teeth=4, axial_depth=2.0, engagement=engagement.full_immersion()
    )
    force = oracle.edge_mean_force(LinearEdge(k_tc=767.01, k_te=27.7), slot)
    spindle_speed = rev_s_from_rpm(3000.0)
    cutting_power = power.cutting_power(force, kinematics.cutting_speed(10.0, spindle_speed))
    assert cutting_power == pytest.approx(480.848, rel=1e-3)
    torque = oracle.power_torque(cutting_power, spindle_speed)
    assert nm_from_nmm(torque) == pytest.approx(1.530587, rel=1e-3)


def test_mean_chip_of_the_catalogues() -> None:
    """Palbit and Sandvik: h_m = 360·f_z·a_e·sin κ/(π·D·ω_e); f_z 0.1, a_e 15, D 20."""
    arc = engagement.unidirectional(15.0, 20.0)
    assert deg_from_rad(arc.contact_angle) == pytest.approx(120.0)
    assert engagement.mean_chip_thickness(0.1, arc) == pytest.approx(0.07162, rel=1e-4)


@pytest.mark.parametrize(("radial_width", "kappa"), [(2.0, 45.0), (10.0, 75.0), (50.0, 90.0)])
def test_equation_1_equals_the_catalogue_form(radial_width: float, kappa: float) -> None:
    arc = engagement.conventional(radial_width, 50.0)
    omega = deg_from_rad(arc.contact_angle)
    edge_angle = rad_from_deg(kappa)
    catalogue = 360.0 * 0.2 * radial_width * sin(edge_angle) / (pi * 50.0 * omega)
    ours = engagement.mean_chip_thickness(0.2, arc, cutting_edge_angle=edge_angle)
    assert ours == pytest.approx(catalogue, rel=1e-12)


def test_drilling_speed_feed_and_time() -> None:
    """LZQ Tool, formulae of hole machining: Ø12 at 1350 rpm; Ø15, 30 mm deep, 50 m/min."""
    spindle_speed = rev_s_from_rpm(1350.0)
    speed = kinematics.cutting_speed(12.0, spindle_speed)
    assert m_min_from_speed(speed) == pytest.approx(50.9, rel=1e-3)
    assert mm_min_from_speed(kinematics.feed(0.2, spindle_speed)) == pytest.approx(270.0)
    feed = kinematics.feed(0.15, kinematics.spindle_speed(15.0, speed_from_m_min(50.0)))
    assert moves.machining_time(30.0, feed) == pytest.approx(11.3, rel=1e-3)


def test_drilling_power_equals_the_sandvik_formula() -> None:
    """Sandvik: P_c = f·v_c·D·k_c/(240·10³) kW with f in mm, v_c in m/min, D in mm."""
    steel = Kienzle(k_c11=1500.0, m_c=0.22)
    hole = drilling.DrillingCut(feed_per_revolution=0.2, tool_diameter=12.0)
    spindle_speed = kinematics.spindle_speed(12.0, speed_from_m_min(80.0))
    k_c = drilling.drilling_specific_force(steel, hole)
    printed = 0.2 * 80.0 * 12.0 * k_c / 240e3
    torque = drilling.drilling_torque(steel, hole)
    ours = kw_from_watts(oracle.torque_power(torque, spindle_speed))
    assert ours == pytest.approx(printed, rel=1e-12)


def test_circles_of_a_mill_leave_the_ridges_of_print() -> None:
    """MachineCalcs, stepover on Ø6: 0.5 mm leaves 0.0104 mm; 0.005 mm at 0.346 mm."""
    coefficient = surface.RZ_PER_RA * surface.wall_coefficient(6.0)
    assert coefficient * 0.5**2 == pytest.approx(0.0104, abs=5e-5)
    assert sqrt(0.005 / coefficient) == pytest.approx(0.346, abs=5e-4)
