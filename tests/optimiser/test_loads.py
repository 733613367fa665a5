"""Loads as monomials equal the physics they are taken from."""

from dataclasses import replace
from math import cos, pi, radians, sin

import pytest

from optimiser import loads
from optimiser.cut import Cut, CutKind, Place
from optimiser.problem import Setting
from simulator.physics import drilling, milling, turning
from simulator.physics.engagement import Engagement, full_immersion, unidirectional
from simulator.spec import Kienzle, ToolKind
from stepnc_model.tool import Tool

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
CONSTANT = Kienzle(k_c11=1000.0, m_c=0.0)
FEEDS = (0.004, 0.05, 0.1, 0.37, 1.2)
MILL = Tool(id="end mill", keyword="TAPERED_ENDMILL", diameter=20.0, teeth=4)
DRILL = Tool(
    id="drill", keyword="TWIST_DRILL", diameter=10.0, teeth=2, point_angle=radians(118.0)
)
INSERT = Tool(id="insert", keyword="GENERAL_TURNING_TOOL", cutting_edge_angle=radians(95.0))


def cut_of(kind: CutKind, tool: Tool) -> Cut:
    return Cut(
        kind=kind,
        tool=tool,
        tool_kind=ToolKind.ENDMILL,
        diameter=tool.diameter or 40.0,
        programmed=Setting(feed=0.1, depth=2.0, passes=1, speed=20.0),
        length=100.0,
        total_depth=2.0,
        is_depth_free=False,
        radial_width=3.0,
    )


def milled(arc: Engagement, tool: Tool = MILL) -> Cut:
    return replace(cut_of(CutKind.MILLING, tool), engagement=arc)


@pytest.mark.parametrize("feed", FEEDS)
@pytest.mark.parametrize("depth", [0.2, 3.0])
def test_milling_force_is_the_mean_force_of_the_physics(feed: float, depth: float) -> None:
    arc = unidirectional(6.0, 20.0)
    load = loads.cutting_force(milled(arc), STEEL, 1.3)
    asked = milling.MillingCut(feed_per_tooth=feed, teeth=4, axial_depth=depth, engagement=arc)
    expected = milling.mean_force(STEEL, asked, factor=1.3)
    assert load.value(feed, depth, 99.0) == pytest.approx(expected)


def test_milling_force_of_constant_resistance_by_hand() -> None:
    """k_s·a·z·f_z·C/2π with C = 2 in a slot: 1000·3·4·0.1·2/2π N."""
    load = loads.cutting_force(milled(full_immersion()), CONSTANT, 1.0)
    assert load.value(0.1, 3.0, 1.0) == pytest.approx(1200.0 / pi)


@pytest.mark.parametrize("feed", FEEDS)
def test_bending_force_is_the_peak_force_of_the_physics(feed: float) -> None:
    arc = unidirectional(2.0, 20.0)
    load = loads.bending_force(milled(arc), STEEL, 1.0)
    asked = milling.MillingCut(feed_per_tooth=feed, teeth=4, axial_depth=5.0, engagement=arc)
    assert load.value(feed, 5.0, 1.0) == pytest.approx(milling.peak_force(STEEL, asked))


@pytest.mark.parametrize("feed", FEEDS)
@pytest.mark.parametrize("previous", [0.0, 6.0])
def test_drilling_force_and_thrust_are_those_of_the_physics(
    feed: float, previous: float
) -> None:
    cut = replace(cut_of(CutKind.DRILLING, DRILL), previous_diameter=previous)
    asked = drilling.DrillingCut(
        feed_per_revolution=2.0 * feed,
        tool_diameter=10.0,
        previous_diameter=previous,
        teeth=2,
        cutting_edge_angle=radians(59.0),
    )
    torque = loads.torque(cut, loads.cutting_force(cut, STEEL, 1.1))
    thrust = loads.thrust(cut, STEEL, 1.1)
    expected = drilling.drilling_torque(STEEL, asked, factor=1.1)
    assert torque.value(feed, 40.0, 1.0) == pytest.approx(expected)
    expected = drilling.drilling_thrust(STEEL, asked, factor=1.1)
    assert thrust.value(feed, 40.0, 1.0) == pytest.approx(expected)


def test_depth_of_a_hole_does_not_load_the_drill() -> None:
    load = loads.cutting_force(cut_of(CutKind.DRILLING, DRILL), STEEL, 1.0)
    assert load.value(0.1, 10.0, 1.0) == load.value(0.1, 50.0, 1.0)


@pytest.mark.parametrize("feed", FEEDS)
def test_turning_force_is_that_of_the_physics(feed: float) -> None:
    load = loads.cutting_force(cut_of(CutKind.TURNING, INSERT), STEEL, 1.0)
    asked = turning.TurningCut(
        feed_per_revolution=feed, depth=2.5, cutting_edge_angle=radians(95.0)
    )
    assert load.value(feed, 2.5, 1.0) == pytest.approx(turning.cutting_force(STEEL, asked))


def test_turning_force_by_hand() -> None:
    """k_c1.1·a/sin κ·(f·sin κ)^(1 − m_c)"""
    edge = sin(radians(95.0))
    load = loads.cutting_force(cut_of(CutKind.TURNING, INSERT), STEEL, 1.0)
    assert load.value(0.2, 2.0, 1.0) == pytest.approx(3000.0 / edge * (0.2 * edge) ** 0.78)


def test_groove_is_as_wide_as_its_insert_whatever_its_depth() -> None:
    load = loads.cutting_force(cut_of(CutKind.GROOVING, INSERT), CONSTANT, 1.0)
    assert load.value(0.1, 1.0, 1.0) == pytest.approx(1000.0 * 3.0 * 0.1)
    assert load.value(0.1, 8.0, 1.0) == pytest.approx(1000.0 * 3.0 * 0.1)


def test_motor_power_is_force_times_cutting_speed_over_efficiency() -> None:
    cut = milled(full_immersion())
    force = loads.cutting_force(cut, STEEL, 1.0)
    power = loads.motor_power(cut, force, 0.8)
    velocity = pi * 20.0 * 25.0 / 1000.0  # m/s
    expected = force.value(0.1, 3.0, 25.0) * velocity / 0.8
    assert power.value(0.1, 3.0, 25.0) == pytest.approx(expected)


def test_torque_is_force_at_half_the_diameter() -> None:
    cut = milled(full_immersion())
    force = loads.cutting_force(cut, STEEL, 1.0)
    torque = loads.torque(cut, force)
    assert torque.value(0.1, 3.0, 1.0) == pytest.approx(10.0 * force.value(0.1, 3.0, 1.0))


@pytest.mark.parametrize("width", [0.5, 4.0, 10.0, 16.0])
def test_power_of_a_milling_cut_is_resistance_times_removal(width: float) -> None:
    """k_s·a_e·a·v_f: 1000 N/mm² times mm³/s is 1000 mW a mm³/s."""
    cut = milled(unidirectional(width, 20.0))
    power = loads.motor_power(cut, loads.cutting_force(cut, CONSTANT, 1.0), 1.0)
    removal = width * 3.0 * 0.1 * 4 * 25.0
    assert power.value(0.1, 3.0, 25.0) == pytest.approx(1000.0 * removal / 1000.0)


def test_scaled_load_is_the_load_times_a_factor() -> None:
    force = loads.cutting_force(milled(full_immersion()), STEEL, 1.0)
    half = loads.scaled(force, 0.5)
    assert half.value(0.2, 3.0, 9.0) == pytest.approx(0.5 * force.value(0.2, 3.0, 9.0))


def test_force_grows_with_the_arc_but_not_with_its_place() -> None:
    """C = cos φ_st − cos φ_ex is all that counts."""
    low = Engagement(entry_angle=0.0, exit_angle=pi / 2.0)
    high = Engagement(entry_angle=pi / 3.0, exit_angle=2.0 * pi / 3.0)
    assert cos(pi / 3.0) - cos(2.0 * pi / 3.0) == pytest.approx(1.0)
    forces = [loads.cutting_force(milled(arc), CONSTANT, 1.0) for arc in (low, high)]
    assert forces[0].coefficient == pytest.approx(forces[1].coefficient)


def test_milling_cut_needs_its_engagement() -> None:
    with pytest.raises(ValueError, match="engagement"):
        loads.cutting_force(cut_of(CutKind.MILLING, MILL), STEEL, 1.0)


def test_a_deeper_place_loads_in_proportion() -> None:
    cut = milled(full_immersion())
    deeper = replace(cut, depth_share=1.5)
    one, other = (loads.cutting_force(each, STEEL, 1.0) for each in (cut, deeper))
    assert other.value(0.1, 2.0, 20.0) == pytest.approx(1.5 * one.value(0.1, 2.0, 20.0))


def test_turning_a_deeper_place_loads_in_proportion() -> None:
    cut = cut_of(CutKind.TURNING, INSERT)
    deeper = replace(cut, depth_share=1.5)
    one, other = (loads.cutting_force(each, STEEL, 1.0) for each in (cut, deeper))
    assert other.value(0.1, 2.0, 20.0) == pytest.approx(1.5 * one.value(0.1, 2.0, 20.0))


def test_the_shank_bends_where_it_is_bent_most() -> None:
    narrow = Place(engagement=unidirectional(2.0, 20.0), depth_share=3.0)
    cut = replace(milled(full_immersion()), bending=narrow)
    asked = milling.MillingCut(
        feed_per_tooth=0.1, teeth=4, axial_depth=6.0, engagement=narrow.engagement
    )
    expected = milling.peak_force(STEEL, asked)
    assert loads.bending_force(cut, STEEL, 1.0).value(0.1, 2.0, 1.0) == pytest.approx(expected)
