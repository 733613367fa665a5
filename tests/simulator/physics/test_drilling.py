from math import pi

import pytest

from simulator.physics import drilling, kinematics, power
from simulator.physics.drilling import DrillingCut
from simulator.spec import Kienzle

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
SOLID = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0)


def test_chip_of_a_lip_is_half_the_feed_seen_across_the_edge() -> None:
    flat = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, cutting_edge_angle=pi / 2.0)
    assert flat.chip_thickness == pytest.approx(0.1)
    assert flat.chip_width == pytest.approx(5.0)
    assert SOLID.chip_thickness < flat.chip_thickness


@pytest.mark.parametrize("previous_diameter", [0.0, 4.0, 9.8])
def test_torque_times_speed_is_specific_force_times_removal_rate(
    previous_diameter: float,
) -> None:
    hole = DrillingCut(
        feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=previous_diameter
    )
    spindle_speed = 20.0
    rate = kinematics.drilling_removal_rate(
        kinematics.feed(0.2, spindle_speed),
        tool_diameter=10.0,
        previous_diameter=previous_diameter,
    )
    by_torque = power.torque_power(drilling.drilling_torque(STEEL, hole), spindle_speed)
    k_c = drilling.drilling_specific_force(STEEL, hole)
    assert by_torque == pytest.approx(power.removal_power(k_c, rate))


def test_pilot_hole_relieves_torque_and_thrust() -> None:
    piloted = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=5.0)
    assert drilling.drilling_torque(STEEL, piloted) < drilling.drilling_torque(STEEL, SOLID)
    assert drilling.drilling_thrust(STEEL, piloted) == pytest.approx(
        0.5 * drilling.drilling_thrust(STEEL, SOLID)
    )


def test_thrust_share_is_the_caller_s() -> None:
    assert drilling.drilling_thrust(STEEL, SOLID, thrust_share=0.7) == pytest.approx(
        1.4 * drilling.drilling_thrust(STEEL, SOLID)
    )


def test_blunt_drill_needs_more_of_both() -> None:
    for load in (drilling.drilling_torque, drilling.drilling_thrust):
        assert load(STEEL, SOLID, factor=1.3) == pytest.approx(1.3 * load(STEEL, SOLID))


def test_hole_as_large_as_the_tool_is_refused() -> None:
    with pytest.raises(ValueError, match="less than the tool diameter"):
        DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0, previous_diameter=10.0)
