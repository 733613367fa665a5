import pytest

from simulator.physics import motion


def test_long_move_runs_at_the_speed_asked() -> None:
    assert motion.peak_speed(1000.0, speed=100.0, acceleration=1000.0) == 100.0
    assert motion.move_time(1000.0, speed=100.0, acceleration=1000.0) == pytest.approx(10.1)


def test_triangle_meets_trapezoid_without_a_jump() -> None:
    length = 100.0**2 / 1000.0
    just_below = motion.move_time(length * (1 - 1e-12), speed=100.0, acceleration=1000.0)
    assert just_below == pytest.approx(
        motion.move_time(length, speed=100.0, acceleration=1000.0)
    )


def test_move_of_no_length_takes_no_time() -> None:
    assert motion.move_time(0.0, speed=100.0, acceleration=1000.0) == 0.0


def test_points_twice_as_far_apart_run_twice_as_fast() -> None:
    near = motion.speed_of_blocks(0.05, 0.004)
    assert motion.speed_of_blocks(0.1, 0.004) == pytest.approx(2.0 * near)


def test_standing_still_needs_no_ramp() -> None:
    assert motion.ramp_time(0.0, 10.0) == 0.0


def test_move_without_acceleration_is_refused() -> None:
    with pytest.raises(ValueError, match="acceleration 0 mm/s²"):
        motion.move_time(10.0, speed=100.0, acceleration=0.0)
