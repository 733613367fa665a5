"""The factor is stated, and may be another."""

import pytest

from service.simulation.facts import WORLD, CarbonFactor, stated
from stepnc_model.errors import StepNcError
from tests.every_case import every_case


def test_a_kilowatt_hour_is_3_6_megajoules() -> None:
    assert WORLD.grams(3.6e6) == 480.0


@every_case("grams", [-1.0, float("inf"), float("nan")])
def test_a_factor_that_cannot_be_is_refused(grams: float) -> None:
    with pytest.raises(ValueError, match=r"carbon factor .* g/kWh must be at least 0"):
        CarbonFactor(grams_per_kwh=grams, source="nobody")


def test_a_stated_factor_counts_and_says_whose_it_is() -> None:
    assert stated(36.0).grams(7.2e6) == 72.0
    assert stated(0.0).source == "as requested"


@every_case("grams", [-1.0, float("inf"), float("nan")])
def test_a_stated_factor_that_cannot_be_is_the_users_mistake(grams: float) -> None:
    with pytest.raises(StepNcError, match=r"carbon factor .* g/kWh must be at least 0"):
        stated(grams)
