"""Vijayaraghavan, Huet and Dornfeld, process planning and verification with MTConnect, 2009.

Table 2, greatest feed by spacing of the points, and the line that is printed beside it:
greatest feed in in/min = 14847 · spacing in inches.
"""

from dataclasses import replace
from math import asin

import numpy as np
import pytest

from simulator.library import load_machine
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import AxisLimits, axis_limits, lines
from stepnc_model.units import mm_min_from_speed, speed_from_mm_min
from tests.oracles import motion as moves

SLOPE = 14_847.0  # 1/min
BLOCK_TIME = 60.0 / SLOPE  # s
MM_PER_INCH = 25.4
COMMANDED = 200.0  # in/min
COUNT = 400

TABLE_2 = {
    0.0001: 0.7,
    0.00025: 3.6,
    0.0005: 7.2,
    0.00075: 10.5,
    0.001: 14.6,
    0.0025: 35.6,
    0.005: 71.2,
    0.0075: 106.7,
    0.01: 147.68,
}
"""in, in/min, at a radius of 1 in"""
SPACINGS, FEEDS = (np.array(each) for each in zip(*TABLE_2.items(), strict=True))


@pytest.fixture
def mill() -> AxisLimits:
    """The library's machining centre with the block time of print."""
    return replace(axis_limits(load_machine("vmc15")), block_time=BLOCK_TIME)


def feed_on_circle(
    limits: AxisLimits,
    spacing: float,
    *,
    radius: float = 1.0,
    commanded: float = COMMANDED,
    control: ControlModelName = ControlModelName.FIR,
) -> float:
    """in/min in the middle of chords of a circle, inches and in/min."""
    angles = 2.0 * asin(0.5 * spacing / radius) * np.arange(COUNT + 1)
    circle = np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
    speed = speed_from_mm_min(commanded * MM_PER_INCH)
    path = lines(list(radius * MM_PER_INCH * circle), speed=speed)
    ends = control_model(control, limits).plan(path, limits).ends
    first, last = COUNT // 2, 3 * COUNT // 4
    return float((last - first) * spacing * 60.0 / (ends[last] - ends[first]))


def test_calibration_line_is_a_block_time_of_4_04_ms() -> None:
    assert pytest.approx(4.0412e-3, rel=1e-4) == BLOCK_TIME


def test_a_thousandth_of_an_inch_allows_14_8_inches_a_minute() -> None:
    speed = moves.speed_of_blocks(0.001 * MM_PER_INCH, BLOCK_TIME)
    assert mm_min_from_speed(speed) / MM_PER_INCH == pytest.approx(14.847, rel=1e-4)


@pytest.mark.parametrize("control", [ControlModelName.FIR, ControlModelName.JUNCTION])
@pytest.mark.parametrize(("spacing", "printed"), list(TABLE_2.items())[1:])
def test_feed_of_every_spacing_is_print_s_to_what_its_line_errs(
    mill: AxisLimits, spacing: float, printed: float, control: ControlModelName
) -> None:
    """Its line lies 0.5 to 6.1 % above its table; the motion is the line."""
    feed = feed_on_circle(mill, spacing, control=control)
    assert feed == pytest.approx(SLOPE * spacing, rel=1e-3)
    assert 1.005 < feed / printed < 1.061


def test_first_row_of_table_2_lies_off_every_line(mill: AxisLimits) -> None:
    """8.6 ms a block where all others have 4.1 to 4.3."""
    blocks = 60e3 * SPACINGS / FEEDS
    assert blocks[0] == pytest.approx(8.571, abs=5e-4)
    assert (blocks[1:] > 4.06).all()
    assert (blocks[1:] < 4.29).all()
    assert feed_on_circle(mill, 0.0001) == pytest.approx(1.4847, rel=1e-3)


def test_printed_slope_is_that_of_the_first_and_the_last_row_not_a_fit() -> None:
    assert np.ptp(FEEDS) / np.ptp(SPACINGS) == pytest.approx(SLOPE, rel=5e-5)
    through_zero = SPACINGS[1:] @ FEEDS[1:] / (SPACINGS[1:] @ SPACINGS[1:])
    assert through_zero == pytest.approx(14_516.0, abs=0.5)
    assert np.polyfit(SPACINGS, FEEDS, 1)[0] == pytest.approx(14_600.0, abs=0.5)


@pytest.mark.parametrize("radius", [0.5, 1.0, 2.0])
def test_radius_of_the_circle_has_no_effect(mill: AxisLimits, radius: float) -> None:
    """Print, "Results"."""
    feed = feed_on_circle(mill, 0.01, radius=radius)
    assert feed == pytest.approx(SLOPE * 0.01, rel=1e-3)


def test_commanded_feed_has_no_effect_above_the_greatest(mill: AxisLimits) -> None:
    """Print, "Results"; below it the command is run."""
    for commanded in (100.0, 150.0, 300.0):
        assert feed_on_circle(mill, 0.0025, commanded=commanded) == pytest.approx(
            SLOPE * 0.0025, rel=1e-3
        )
    assert feed_on_circle(mill, 0.01, commanded=100.0) == pytest.approx(100.0, rel=1e-3)
