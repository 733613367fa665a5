from math import cos, sin

import numpy as np
import pytest

from simulator.motion.fir import FixedTimeFilter
from simulator.motion.moving_average import averaged, states_at_ends
from simulator.motion.segments import AxisLimits, Floats, arc, lines

FIRST, SECOND = 0.08, 0.03
DELAY = 0.5 * (FIRST + SECOND)
FREE = AxisLimits(acceleration=np.full(3, 1e12), rapid=np.full(3, 1e6), feed=np.full(3, 1e6))
CONTROL = FixedTimeFilter(first=FIRST, second=SECOND)


def _gain(rate: float) -> float:
    """What two moving averages leave of a wave: the product of two cardinal sines."""
    first, second = 0.5 * rate * FIRST, 0.5 * rate * SECOND
    return sin(first) / first * sin(second) / second


@pytest.mark.parametrize("radius", [0.5, 30.0, 1e3, 1e5])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_circle_shrinks_by_the_gain_and_lags_by_half_the_window(
    radius: float, sense: float
) -> None:
    speed = 200.0
    circle = arc([radius, 0, 0], [0, 0, 0], sense * 400.0 / radius, rise=8.0, speed=speed)
    motion = CONTROL.plan(circle, FREE)
    rate = sense * speed / circle.length[0] * 400.0 / radius
    times = np.linspace(0.2, motion.duration - 0.2, 50)
    state = motion.at(times)
    angle, size = rate * (times - DELAY), radius * _gain(rate)
    ring = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    assert state.position[:, :2] == pytest.approx(size * ring, abs=1e-9)
    assert state.acceleration[:, :2] == pytest.approx(-(rate**2) * size * ring, abs=1e-6)
    turned = np.stack((-ring[:, 1], ring[:, 0]), axis=1)
    assert state.velocity[:, :2] == pytest.approx(rate * size * turned, abs=1e-8)
    rise = 8.0 * speed / circle.length[0]
    assert state.position[:, 2] == pytest.approx(rise * (times - DELAY), abs=1e-9)


def test_start_from_rest_ramps_acceleration_up_holds_it_and_ramps_it_down() -> None:
    speed = 40.0
    motion = CONTROL.plan(lines([(0, 0, 0), (40, 0, 0)], speed=speed), FREE)
    times = np.array([0.0, 0.5 * SECOND, SECOND, FIRST, FIRST + 0.5 * SECOND, FIRST + SECOND])
    state = motion.at(times)
    top = speed / FIRST
    assert state.acceleration[:, 0] == pytest.approx(
        [0.0, 0.5 * top, top, top, 0.5 * top, 0.0], abs=1e-9
    )
    middle = 0.5 * top * SECOND
    assert state.velocity[[2, 3, 5], 0] == pytest.approx([
        middle,
        middle + top * (FIRST - SECOND),
        speed,
    ])
    assert state.position[2, 0] == pytest.approx(top * SECOND**2 / 6.0)
    assert state.position[5, 0] == pytest.approx(speed * DELAY)


def test_cutting_an_arc_into_pieces_changes_nothing() -> None:
    """Pieces much shorter than the window, about as many as a control meets."""
    radius, speed, rate = 12.0, 100.0, 100.0 / 12.0
    count = 400
    step = 6.0 / count
    angle = step * np.arange(count)
    start = np.stack((radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle), axis=1)
    velocity = np.zeros((count, 3, 3))
    velocity[:, 1, 0], velocity[:, 1, 1] = -speed * np.sin(angle), speed * np.cos(angle)
    velocity[:, 2, 0], velocity[:, 2, 1] = -speed * np.cos(angle), -speed * np.sin(angle)
    time: Floats = (np.arange(count + 1) * step / rate).astype(np.float64)
    begin = np.linspace(0.0, time[-1] - FIRST - SECOND, 60)
    piece = np.searchsorted(time[1:-1], begin, side="right")
    rates = np.full(count, rate)
    columns = (time, start, velocity, rates, states_at_ends(time, velocity, rates))
    _, _, position = averaged(begin, piece, columns, FIRST, SECOND)
    turned = rate * (begin + DELAY)
    assert position[:, 0] == pytest.approx(radius * _gain(rate) * np.cos(turned), abs=1e-12)
    assert position[:, 1] == pytest.approx(radius * _gain(rate) * np.sin(turned), abs=1e-12)


def test_series_meets_the_closed_form() -> None:
    """An arc whose window turns it from just below to just above the change-over."""
    for angle in (0.4999, 0.5001):
        rate = angle / (FIRST + SECOND)
        velocity = np.array([[[0.0] * 3, [0.0, 90.0, 0.0], [-90.0, 0.0, 0.0]]])
        time, rates = np.array([0.0, 1.0]), np.array([rate])
        ends = states_at_ends(time, velocity, rates)
        columns = (time, np.array([[90.0 / rate, 0.0, 0.0]]), velocity, rates, ends)
        _, _, position = averaged(np.zeros(1), np.zeros(1, np.int64), columns, FIRST, SECOND)
        expected = 90.0 / rate * _gain(rate) * np.array([cos(rate * DELAY), sin(rate * DELAY)])
        assert position[0, :2] == pytest.approx(expected, abs=1e-12)
