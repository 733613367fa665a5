from dataclasses import replace
from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.physics import drilling, kinematics
from simulator.physics.drilling import LIPS_ONLY, DrillingCut, chisel_factors
from simulator.spec import Kienzle
from simulator.tool_windows import DrillPoint
from tests.oracles import cutting as oracle

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
SOLID = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0)


def test_chip_of_a_lip_is_half_the_feed_seen_across_the_edge() -> None:
    flat = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, cutting_edge_angle=pi / 2.0)
    assert flat.chip_thickness == pytest.approx(0.1)
    assert SOLID.chip_thickness < flat.chip_thickness


@pytest.mark.parametrize("previous_diameter", [0.0, 4.0, 9.8])
def test_torque_times_speed_is_specific_force_times_removal_rate(
    previous_diameter: float,
) -> None:
    hole = DrillingCut(
        feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=previous_diameter
    )
    spindle_speed = 20.0
    rate = oracle.drilling_removal_rate(
        kinematics.feed(0.2, spindle_speed),
        tool_diameter=10.0,
        previous_diameter=previous_diameter,
    )
    by_torque = oracle.torque_power(drilling.drilling_torque(STEEL, hole), spindle_speed)
    k_c = drilling.drilling_specific_force(STEEL, hole)
    assert by_torque == pytest.approx(oracle.removal_power(k_c, rate))


def test_pilot_hole_relieves_torque_and_thrust() -> None:
    piloted = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=5.0)
    assert drilling.drilling_torque(STEEL, piloted) < drilling.drilling_torque(STEEL, SOLID)
    assert oracle.drilling_thrust(STEEL, piloted) == pytest.approx(
        0.5 * oracle.drilling_thrust(STEEL, SOLID)
    )


def test_thrust_share_is_that_of_the_tool() -> None:
    point = DrillPoint(thrust_share=0.7, chisel_ratio=0.0)
    other = replace(SOLID, point=point)
    ratio = 0.7 / LIPS_ONLY.thrust_share
    assert oracle.drilling_thrust(STEEL, other) == pytest.approx(
        ratio * oracle.drilling_thrust(STEEL, SOLID)
    )


@pytest.mark.parametrize("ratio", [0.03, 0.1, 0.18, 0.4])
def test_hole_that_was_there_leaves_the_chisel_edge_nothing(ratio: float) -> None:
    point = DrillPoint(thrust_share=LIPS_ONLY.thrust_share, chisel_ratio=ratio)
    for load in (drilling.drilling_torque, oracle.drilling_thrust):
        wide = replace(SOLID, previous_diameter=10.0 * ratio + 0.1)
        assert load(STEEL, replace(wide, point=point)) == load(STEEL, wide)
        narrow = replace(SOLID, previous_diameter=10.0 * ratio - 0.1)
        assert load(STEEL, replace(narrow, point=point)) >= load(STEEL, narrow)


@given(st.floats(0.0, 0.4), st.floats(0.0, 0.4))
def test_longer_chisel_edge_takes_no_less(one: float, other: float) -> None:
    short, long = (chisel_factors(ratio) for ratio in sorted((one, other)))
    assert short.torque <= long.torque
    assert short.thrust <= long.thrust
    assert short.constant <= long.constant


@pytest.mark.parametrize("ratio", [-0.01, 0.41])
def test_chisel_ratio_outside_of_the_table_is_refused(ratio: float) -> None:
    with pytest.raises(ValueError, match=f"chisel ratio {ratio:g}"):
        chisel_factors(ratio)


def test_only_the_thrust_of_the_lips_rises_with_the_feed() -> None:
    point = DrillPoint(thrust_share=LIPS_ONLY.thrust_share, chisel_ratio=0.18)
    slow = replace(SOLID, point=point)
    fast = replace(slow, feed_per_revolution=0.4)
    assert drilling.chisel_thrust(STEEL, fast) == drilling.chisel_thrust(STEEL, slow)
    assert drilling.lip_thrust(STEEL, fast) == pytest.approx(
        2.0**0.78 * drilling.lip_thrust(STEEL, slow)
    )


def test_blunt_drill_needs_more_of_both() -> None:
    for load in (drilling.drilling_torque, oracle.drilling_thrust):
        assert load(STEEL, SOLID, factor=1.3) == pytest.approx(1.3 * load(STEEL, SOLID))


def test_hole_as_large_as_the_tool_is_refused() -> None:
    with pytest.raises(ValueError, match="less than the tool diameter"):
        DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=10.0)
