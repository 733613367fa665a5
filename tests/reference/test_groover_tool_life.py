"""M. P. Groover, "Fundamentals of Modern Manufacturing", example of Taylor's equation.

A life of 5 min at 160 m/min and of 41 min at 100 m/min: n = 0.223, C = 229.
"""

import pytest

from extras.calibration.model.tool_life import LifePair, fitted_taylor
from stepnc_model.units import m_min_from_speed, speed_from_m_min


def test_two_lives_give_exponent_0_223_and_constant_229() -> None:
    found = fitted_taylor([
        LifePair(cutting_speed=speed_from_m_min(160.0), life=5.0 * 60.0),
        LifePair(cutting_speed=speed_from_m_min(100.0), life=41.0 * 60.0),
    ])
    assert found.taylor.exponent == pytest.approx(0.223, abs=5e-4)
    assert m_min_from_speed(found.taylor.constant) == pytest.approx(229.0, abs=0.5)
    assert not found.has_interval
