"""Taylor's constants from measured pairs."""

from math import exp, inf, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from extras.calibration.model.tool_life import LifePair, fitted_taylor
from simulator.physics.tool_life import tool_life
from simulator.spec import Taylor
from stepnc_model.errors import StepNcError
from tests.every_case import every_case


def pair(speed: float, life: float) -> LifePair:
    return LifePair(cutting_speed=speed, life=life)


@given(
    exponent=st.floats(0.05, 0.9),
    constant=st.floats(1000.0, 20_000.0),
    count=st.integers(2, 6),
)
def test_lives_of_a_law_give_the_law(exponent: float, constant: float, count: int) -> None:
    law = Taylor(exponent=exponent, constant=constant)
    speeds = np.geomspace(0.5 * constant, 0.9 * constant, count).tolist()
    found = fitted_taylor([pair(speed, tool_life(law, speed)) for speed in speeds])
    assert found.taylor.exponent == pytest.approx(exponent, rel=1e-6)
    assert found.taylor.constant == pytest.approx(constant, rel=1e-6)
    assert found.has_interval == (count > 2)
    if found.has_interval:
        assert found.low <= found.taylor.exponent * (1.0 + 1e-6)
        assert found.high >= found.taylor.exponent * (1.0 - 1e-6)


def test_interval_holds_the_truth_as_often_as_it_says() -> None:
    random = np.random.default_rng(3)
    law, inside = Taylor(exponent=0.25, constant=5000.0), 0
    speeds = np.geomspace(1500.0, 4000.0, 6)
    for _ in range(400):
        lives = [tool_life(law, v) * exp(random.normal(0.0, 0.2)) for v in speeds.tolist()]
        found = fitted_taylor([pair(v, t) for v, t in zip(speeds, lives, strict=True)])
        inside += found.low <= 0.25 <= found.high
    assert inside / 400 == pytest.approx(0.95, abs=0.03)


def test_pairs_that_hardly_tell_a_slope_have_no_upper_end() -> None:
    found = fitted_taylor([
        pair(3000.0, 600.0),
        pair(3030.0, 400.0),
        pair(3060.0, 560.0),
    ])
    assert found.high == inf
    assert 0.0 < found.low < found.taylor.exponent
    assert found.scatter == pytest.approx(0.24, abs=0.15)


@every_case(
    ("pairs", "message"),
    [
        ([], "0 pair"),
        ([pair(100.0, 60.0)], "at least 2"),
        ([pair(100.0, 60.0), pair(100.0, 90.0)], "two different speeds"),
        ([pair(100.0, 60.0), pair(-1.0, 90.0)], "pair 2"),
        ([pair(100.0, 0.0), pair(90.0, 90.0)], "pair 1"),
        ([pair(100.0, float("nan")), pair(90.0, 90.0)], "pair 1"),
        ([pair(100.0, 60.0), pair(200.0, 90.0)], "does not fall"),
        ([pair(100.0, 60.0), pair(200.0, 50.0)], "must be less than 1"),
    ],
)
def test_pairs_that_no_law_goes_through_are_refused(
    pairs: list[LifePair], message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        fitted_taylor(pairs)


def test_life_of_one_minute_is_at_the_constant() -> None:
    found = fitted_taylor([pair(2000.0, 60.0), pair(1000.0, 960.0)]).taylor
    assert found.constant == pytest.approx(2000.0)
    assert found.exponent == pytest.approx(log(2.0) / log(16.0))
