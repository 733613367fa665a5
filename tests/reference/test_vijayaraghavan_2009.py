"""Vijayaraghavan, Huet and Dornfeld, process planning and verification with MTConnect, 2009.

The calibration line: greatest feed in in/min = 14847 · spacing of the points in inches.
"""

import pytest

from stepnc_model.units import mm_min_from_speed
from tests.oracles import motion as moves

SLOPE = 14_847.0  # 1/min
BLOCK_TIME = 60.0 / SLOPE  # s
MM_PER_INCH = 25.4


def test_calibration_line_is_a_block_time_of_4_04_ms() -> None:
    assert pytest.approx(4.0412e-3, rel=1e-4) == BLOCK_TIME


def test_a_thousandth_of_an_inch_allows_14_8_inches_a_minute() -> None:
    speed = moves.speed_of_blocks(0.001 * MM_PER_INCH, BLOCK_TIME)
    assert mm_min_from_speed(speed) / MM_PER_INCH == pytest.approx(14.847, rel=1e-4)
