import pytest

from simulator.physics import kinematics


def test_spindle_without_diameter_is_refused() -> None:
    with pytest.raises(ValueError, match="diameter 0 mm"):
        kinematics.spindle_speed(0.0, 1000.0)


def test_zero_feed_is_refused_with_value_bound_and_unit() -> None:
    with pytest.raises(ValueError, match="feed 0 mm/s must be greater than 0 mm/s"):
        kinematics.feed_per_tooth(0.0, 10.0)
