import pytest

from simulator.physics import power


def test_ten_newtons_at_a_metre_a_second_are_ten_watts() -> None:
    assert power.cutting_power(10.0, 1000.0) == pytest.approx(10.0)


def test_motor_draws_what_the_drive_loses() -> None:
    assert power.motor_power(900.0, 0.75) == pytest.approx(1200.0)


def test_motor_without_load_draws_nothing_for_the_cut() -> None:
    assert power.motor_power(0.0, 0.9) == 0.0


@pytest.mark.parametrize("efficiency", [0.0, 1.01, -0.5])
def test_efficiency_outside_its_range_is_refused(efficiency: float) -> None:
    with pytest.raises(ValueError, match="efficiency"):
        power.motor_power(100.0, efficiency)


def test_torque_and_its_power_are_inverse() -> None:
    assert power.torque_power(power.torque(500.0, 25.0), 25.0) == pytest.approx(500.0)


def test_one_newton_metre_at_one_revolution_a_second() -> None:
    assert power.torque_power(1000.0, 1.0) == pytest.approx(6.283185, rel=1e-6)


def test_power_at_standstill_has_no_torque() -> None:
    with pytest.raises(ValueError, match="spindle speed 0 rev/s"):
        power.torque(100.0, 0.0)


def test_removal_power_is_specific_energy_times_rate() -> None:
    assert power.removal_power(2000.0, 500.0) == pytest.approx(1000.0)
