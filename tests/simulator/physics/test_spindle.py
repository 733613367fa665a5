from itertools import pairwise
from math import inf

import pytest

from simulator.physics.spindle import available_power, curve_segments
from simulator.spec import Spindle, SpindlePoint

LOW = SpindlePoint(speed=5.0, power=3000.0, torque=95_493.0)
BASE = SpindlePoint(speed=25.0, power=15_000.0, torque=95_493.0)
TOP = SpindlePoint(speed=200.0, power=15_000.0, torque=11_937.0)


def available_torque(machine: Spindle, speed: float) -> float | None:
    """Torque of the stretch that holds a speed."""
    return next(part for part in curve_segments(machine) if speed <= part.max_speed).torque(
        speed
    )


def spindle(
    *curve: SpindlePoint, min_speed: float | None = None, max_speed: float | None = None
) -> Spindle:
    return Spindle(
        curve=curve,
        efficiency=0.9,
        min_speed=min_speed,
        max_speed=max_speed,
        acceleration=None,
    )


def test_constant_torque_and_constant_power_are_straight_in_logarithms() -> None:
    _, rising, level, _ = curve_segments(spindle(LOW, BASE, TOP))
    assert (rising.power_exponent, rising.torque_exponent) == pytest.approx((1.0, 0.0))
    assert (level.power_exponent, level.torque_exponent) == pytest.approx((0.0, -1.0), abs=1e-4)


def test_power_at_the_points_is_the_points() -> None:
    for point in (LOW, BASE, TOP):
        assert available_power(spindle(LOW, BASE, TOP), point.speed) == pytest.approx(
            point.power
        )
        assert available_torque(spindle(LOW, BASE, TOP), point.speed) == pytest.approx(
            point.torque
        )


def test_below_the_first_point_the_torque_stays() -> None:
    machine = spindle(BASE)
    assert available_torque(machine, 10.0) == pytest.approx(95_493.0)
    assert available_power(machine, 10.0) == pytest.approx(15_000.0 * 10.0 / 25.0)


def test_below_the_first_point_without_torque_the_power_stays() -> None:
    machine = spindle(SpindlePoint(speed=10.0, power=290.0))
    assert available_power(machine, 0.1) == 290.0
    assert available_torque(machine, 0.1) is None


def test_above_the_last_point_the_power_stays_and_the_torque_falls() -> None:
    machine = spindle(LOW, BASE)
    assert available_power(machine, 100.0) == pytest.approx(15_000.0)
    assert available_torque(machine, 100.0) == pytest.approx(95_493.0 / 4.0)


def test_torque_is_unknown_where_one_end_has_none() -> None:
    machine = spindle(LOW, SpindlePoint(speed=25.0, power=15_000.0))
    assert available_torque(machine, 15.0) is None
    assert available_torque(machine, 4.0) == pytest.approx(95_493.0)


def test_stretches_join_and_span_the_spindle_s_range() -> None:
    parts = curve_segments(spindle(LOW, BASE, TOP, min_speed=1.0, max_speed=150.0))
    assert parts[0].min_speed == 1.0
    assert parts[-1].max_speed == 150.0
    assert [a.max_speed for a in parts[:-1]] == [b.min_speed for b in parts[1:]]


def test_stretches_join_in_power() -> None:
    parts = curve_segments(spindle(LOW, BASE, TOP))
    for before, after in pairwise(parts):
        speed = before.max_speed
        assert before.power(speed) == pytest.approx(after.power(speed))


def test_stretches_outside_the_range_are_left_out() -> None:
    parts = curve_segments(spindle(LOW, BASE, TOP, min_speed=30.0, max_speed=200.0))
    assert len(parts) == 1
    assert parts[0].power_exponent == pytest.approx(0.0)


def test_curve_without_range_reaches_from_zero_to_infinity() -> None:
    parts = curve_segments(spindle(BASE))
    assert (parts[0].min_speed, parts[-1].max_speed) == (0.0, inf)


def test_descending_curve_is_refused() -> None:
    with pytest.raises(ValueError, match=r"5 rev/s must be greater .* 25 rev/s"):
        curve_segments(spindle(BASE, LOW))


def test_curve_that_jumps_is_refused() -> None:
    """Its coefficient at 1 rev/s would overflow."""
    step = SpindlePoint(speed=25.001, power=12_000.0)
    with pytest.raises(ValueError, match="move the two points apart"):
        curve_segments(spindle(SpindlePoint(speed=25.0, power=15_000.0), step))


def test_empty_curve_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 1"):
        available_power(spindle(), 10.0)


def test_crossed_speed_range_is_refused() -> None:
    with pytest.raises(ValueError, match="lowest spindle speed 50 rev/s"):
        curve_segments(spindle(BASE, min_speed=50.0, max_speed=20.0))


def test_curve_with_a_negative_value_is_refused() -> None:
    with pytest.raises(ValueError, match="torque -1 N·mm"):
        curve_segments(spindle(SpindlePoint(speed=10.0, power=100.0, torque=-1.0)))
