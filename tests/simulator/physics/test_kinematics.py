import pytest

from simulator.physics import kinematics


def test_bored_hole_removes_the_ring_only() -> None:
    whole = kinematics.drilling_removal_rate(2.0, tool_diameter=20.0)
    core = kinematics.drilling_removal_rate(2.0, tool_diameter=15.0)
    ring = kinematics.drilling_removal_rate(2.0, tool_diameter=20.0, previous_diameter=15.0)
    assert ring == pytest.approx(whole - core)


def test_turning_removal_rate_is_exact_on_the_mean_diameter() -> None:
    spindle_speed, feed, outer, inner = 10.0, 0.2, 50.0, 46.0
    speed = kinematics.cutting_speed(0.5 * (outer + inner), spindle_speed)
    rate = kinematics.turning_removal_rate(feed, depth=2.0, cutting_speed=speed)
    ring = kinematics.drilling_removal_rate(
        kinematics.feed(feed, spindle_speed), tool_diameter=outer, previous_diameter=inner
    )
    assert rate == pytest.approx(ring)


def test_approach_and_overrun_take_time() -> None:
    bare = kinematics.machining_time(100.0, 5.0)
    whole = kinematics.machining_time(100.0, 5.0, approach=10.0, overrun=15.0)
    assert whole - bare == pytest.approx(5.0)


def test_zero_feed_is_refused_with_value_bound_and_unit() -> None:
    with pytest.raises(ValueError, match="feed 0 mm/s must be greater than 0 mm/s"):
        kinematics.machining_time(100.0, 0.0)


def test_negative_approach_is_refused() -> None:
    with pytest.raises(ValueError, match="approach -1 mm"):
        kinematics.machining_time(100.0, 5.0, approach=-1.0)


def test_spindle_without_diameter_is_refused() -> None:
    with pytest.raises(ValueError, match="diameter 0 mm"):
        kinematics.spindle_speed(0.0, 1000.0)
