"""From mechanical to electrical power."""

import pytest

from simulator.physics.drive import electrical_power, positive_part


def test_a_positive_part_is_zero_below_zero() -> None:
    assert [positive_part(value) for value in (-2.0, 0.0, 3.0)] == [0.0, 0.0, 3.0]


def test_driving_costs_more_than_the_shaft_has() -> None:
    assert electrical_power(900.0, efficiency=0.9, regeneration=0.5) == pytest.approx(1000.0)


def test_braking_returns_no_more_than_its_share() -> None:
    assert electrical_power(-900.0, efficiency=0.9, regeneration=0.7) == pytest.approx(-630.0)
    assert electrical_power(-900.0, efficiency=0.9, regeneration=0.0) == 0.0
