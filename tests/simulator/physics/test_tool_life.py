from dataclasses import replace

import pytest

from simulator.physics import tool_life
from simulator.spec import CuttingMaterial, CuttingWindow, Taylor
from tests.every_case import every_case

CARBIDE = Taylor(exponent=0.25, constant=8000.0)


def test_constant_is_the_speed_for_one_minute() -> None:
    assert tool_life.tool_life(CARBIDE, 8000.0) == pytest.approx(60.0)


def test_speed_for_a_life_is_the_inverse() -> None:
    speed = tool_life.speed_for_life(CARBIDE, 900.0)
    assert tool_life.tool_life(CARBIDE, speed) == pytest.approx(900.0)


def test_wear_rate_is_one_over_life() -> None:
    assert tool_life.wear_rate(CARBIDE, 4000.0) == pytest.approx(
        1.0 / tool_life.tool_life(CARBIDE, 4000.0)
    )


@every_case("exponent", [0.0, 1.0, -0.2])
def test_exponent_outside_its_range_is_refused(exponent: float) -> None:
    with pytest.raises(ValueError, match="Taylor exponent"):
        tool_life.tool_life(Taylor(exponent=exponent, constant=8000.0), 4000.0)


def test_life_is_assumed_15_min_in_the_middle_of_the_catalogue_speeds() -> None:
    window = CuttingWindow(
        cutting_material=CuttingMaterial.CARBIDE, min_cutting_speed=2000.0,
        max_cutting_speed=4500.0, taylor=None,
    )  # fmt: skip
    law = tool_life.assumed_life(window)
    assert law is not None
    assert tool_life.tool_life(law, 3000.0) == pytest.approx(15.0 * 60.0)
    assert tool_life.assumed_life(replace(window, min_cutting_speed=None)) is None
