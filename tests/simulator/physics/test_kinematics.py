import pytest

from simulator.physics import kinematics


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
