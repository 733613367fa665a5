import pytest

from simulator.physics import cutting as power
from tests.every_case import every_case


def test_ten_newtons_at_a_metre_a_second_are_ten_watts() -> None:
    assert power.cutting_power(10.0, 1000.0) == pytest.approx(10.0)


def test_motor_draws_what_the_drive_loses() -> None:
    assert power.motor_power(900.0, 0.75) == pytest.approx(1200.0)


def test_motor_without_load_draws_nothing_for_the_cut() -> None:
    assert power.motor_power(0.0, 0.9) == 0.0


@every_case("efficiency", [0.0, 1.01, -0.5])
def test_efficiency_outside_its_range_is_refused(efficiency: float) -> None:
    with pytest.raises(ValueError, match="efficiency"):
        power.motor_power(100.0, efficiency)
