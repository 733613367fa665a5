"""Loads as monomials equal the physics they are taken from."""

from dataclasses import replace
from math import cos, pi, radians, sin

import pytest

from optimiser.bounds import loads
from optimiser.cuts.cut import CriticalPlace, Cut, CutKind
from optimiser.solver.problem import Setting
from simulator.physics import drilling, milling, turning
from simulator.physics.engagement import Engagement, full_immersion, unidirectional
from simulator.spec import Kienzle, ToolKind
from simulator.tool_windows import DrillPoint
from stepnc_model.programs.tool import Tool
from tests.every_case import every_case
from tests.oracles.cutting import drilling_thrust
from tests.simulator.physics.discs import Mill

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
CONSTANT = Kienzle(k_c11=1000.0, m_c=0.0)
FEEDS = (0.004, 0.05, 0.1, 0.37, 1.2)
MILL = Tool(id="end mill", keyword="TAPERED_ENDMILL", diameter=20.0, teeth=4)
TWO = replace(MILL, teeth=2)
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


@every_case("feed", FEEDS)
@every_case("depth", [0.2, 3.0])
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


def discs(arc: Engagement, *, depth: float, helix: float) -> Mill:
    return Mill(
        teeth=4,
        diameter=20.0,
        helix=helix,
        entry=arc.entry_angle,
        exit=arc.exit_angle,
        depth=depth,
        exponent=0.78,
    )


@every_case("feed", FEEDS)
@every_case("depth", [0.4, 5.0, 20.0])
def test_shank_and_wall_force_are_those_of_thin_discs(feed: float, depth: float) -> None:
    arc = unidirectional(2.0, 20.0)
    cut = replace(milled(arc), helix_angle=radians(30.0))
    mill = discs(arc, depth=depth, helix=radians(30.0))
    scale = 1.2 * 1500.0 * feed**0.78
    shank, wall = loads.shank_force(cut, STEEL, 1.2), loads.wall_force(cut, STEEL, 1.2)
    assert wall is not None
    assert shank.value(feed, depth, 1.0) == pytest.approx(scale * mill.peak(), rel=0.01)
    assert wall.value(feed, depth, 1.0) == pytest.approx(scale * mill.wall(pi), rel=0.01)


def test_a_straight_edge_has_a_force_in_proportion_to_its_depth() -> None:
    """One tooth at its thickest chip: k·a·f^q·√(1 + 0.3²)."""
    load = loads.shank_force(milled(unidirectional(10.0, 20.0), TWO), STEEL, 1.0)
    for depth in (0.5, 2.0, 9.0):
        expected = 1500.0 * depth * 0.1**0.78 * (1.0 + 0.3**2) ** 0.5
        assert load.value(0.1, depth, 1.0) == pytest.approx(expected, rel=2e-3)


def test_where_no_wall_is_reached_nothing_bends_by_it() -> None:
    within = Engagement(entry_angle=0.5, exit_angle=2.5)
    assert loads.wall_force(milled(within), STEEL, 1.0) is None
    assert loads.wall_force(milled(full_immersion()), STEEL, 1.0) is not None


def test_a_force_over_the_mean_is_that_of_both_by_themselves() -> None:
    arc = unidirectional(2.0, 20.0)
    cut = replace(milled(arc), helix_angle=radians(30.0))
    shank, mean = loads.shank_force(cut, STEEL, 1.0), loads.cutting_force(cut, STEEL, 1.0)
    assert isinstance(shank.curve, loads.DepthCurve)
    expected = shank.value(0.1, 7.0, 1.0) / mean.value(0.1, 7.0, 1.0)
    assert loads.over_mean(shank.curve, 7.0) == pytest.approx(expected)


@every_case("feed", FEEDS)
@every_case("previous", [0.0, 6.0])
@every_case("chisel", [0.0, 0.2])
def test_drilling_force_and_thrust_are_those_of_the_physics(
    feed: float, previous: float, chisel: float
) -> None:
    point = DrillPoint(thrust_share=0.6, chisel_ratio=chisel)
    cut = replace(cut_of(CutKind.DRILLING, DRILL), previous_diameter=previous)
    asked = drilling.DrillingCut(
        feed_per_revolution=2.0 * feed,
        tool_diameter=10.0,
        previous_diameter=previous,
        teeth=2,
        cutting_edge_angle=radians(59.0),
        point=point,
    )
    force = loads.cutting_force(cut, STEEL, 1.1, point)
    torque = loads.torque(cut, force)
    thrust = loads.thrust(cut, STEEL, 1.1, point)
    expected = drilling.drilling_torque(STEEL, asked, factor=1.1)
    assert torque.value(feed, 40.0, 1.0) == pytest.approx(expected)
    # All lips in their middle, a quarter of both diameters from the axis.
    assert force.value(feed, 40.0, 1.0) == pytest.approx(expected / (0.25 * (10.0 + previous)))
    expected = drilling_thrust(STEEL, asked, factor=1.1)
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
    narrow = CriticalPlace(engagement=unidirectional(2.0, 20.0), depth_share=3.0)
    cut = replace(milled(full_immersion()), shank=narrow, helix_angle=0.5)
    mill = discs(narrow.engagement, depth=6.0, helix=0.5)
    expected = 1500.0 * 0.1**0.78 * mill.peak()
    found = loads.shank_force(cut, STEEL, 1.0).value(0.1, 2.0, 1.0)
    assert found == pytest.approx(expected, rel=0.01)


def test_the_wall_is_spoilt_where_it_is_made() -> None:
    narrow = CriticalPlace(engagement=unidirectional(2.0, 20.0), depth_share=3.0)
    cut = replace(milled(full_immersion()), wall=narrow, helix_angle=0.5)
    mill = discs(narrow.engagement, depth=6.0, helix=0.5)
    expected = 1500.0 * 0.1**0.78 * mill.wall(pi)
    load = loads.wall_force(cut, STEEL, 1.0)
    assert load is not None
    assert load.value(0.1, 2.0, 1.0) == pytest.approx(expected, rel=0.01)


def test_a_cut_that_is_filled_more_loads_in_proportion() -> None:
    cut = milled(full_immersion())
    plain = loads.cutting_force(cut, STEEL, 1.0)
    fuller = loads.cutting_force(replace(cut, fill=1.5), STEEL, 1.0)
    assert fuller.coefficient == pytest.approx(1.5 * plain.coefficient)


def test_the_mean_chip_that_was_met_holds_the_resistance() -> None:
    """``h^(−m)``: half the mean chip of a slot, 2/π."""
    cut = milled(full_immersion())
    plain = loads.cutting_force(cut, STEEL, 1.0)
    thinner = loads.cutting_force(replace(cut, chip_ratio=1.0 / pi), STEEL, 1.0)
    assert thinner.coefficient == pytest.approx(2.0**STEEL.m_c * plain.coefficient)
