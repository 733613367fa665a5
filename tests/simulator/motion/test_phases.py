import numpy as np
import pytest

from simulator.motion.segments import arc, lines
from simulator.motion.sweep import Phases


def _ramp_on_arc() -> Phases:
    """From rest to 10 mm/s within 2 s, then 1 s of running, on a circle of radius 4 mm."""
    return Phases(
        segments=arc([4, 0, 0], [0, 0, 0], 5.0, speed=10.0),
        ends=np.array([3.0]),
        segment=np.array([0, 0]),
        start=np.array([0.0, 2.0]),
        time=np.array([2.0, 1.0]),
        station=np.array([0.0, 10.0]),
        speed=np.array([0.0, 10.0]),
        acceleration=np.array([5.0, 0.0]),
    )


def test_station_is_a_parabola_in_time() -> None:
    state = _ramp_on_arc().at(np.array([0.0, 1.0, 2.0, 2.5, 3.0]))
    assert state.station == pytest.approx([0.0, 2.5, 10.0, 15.0, 20.0])
    assert np.linalg.norm(state.velocity, axis=1) == pytest.approx([0.0, 5.0, 10.0, 10.0, 10.0])
    angle = state.station / 4.0
    assert state.position[:, 0] == pytest.approx(4.0 * np.cos(angle))
    assert state.position[:, 1] == pytest.approx(4.0 * np.sin(angle))


def test_acceleration_is_tangential_and_centripetal() -> None:
    state = _ramp_on_arc().at(np.array([1.0, 2.5]))
    unit = state.velocity / np.linalg.norm(state.velocity, axis=1)[:, None]
    along = (state.acceleration * unit).sum(axis=1)
    across = np.linalg.norm(state.acceleration - along[:, None] * unit, axis=1)
    assert along == pytest.approx([5.0, 0.0])
    assert across == pytest.approx([5.0**2 / 4.0, 10.0**2 / 4.0])


def test_knots_are_where_phases_begin_and_end() -> None:
    motion = _ramp_on_arc()
    assert motion.knots.tolist() == [0.0, 2.0, 3.0]
    assert motion.duration == 3.0


def test_times_beyond_either_end_stay_there() -> None:
    state = _ramp_on_arc().at(np.array([-1e-12, 3.0 + 1e-12]))
    assert state.station == pytest.approx([0.0, 20.0])


def test_line_has_no_acceleration_across() -> None:
    motion = Phases(
        segments=lines([(0, 0, 0), (0, 0, 8)], speed=2.0),
        ends=np.array([4.0]),
        segment=np.array([0]),
        start=np.array([0.0]),
        time=np.array([4.0]),
        station=np.array([0.0]),
        speed=np.array([2.0]),
        acceleration=np.array([0.0]),
    )
    state = motion.at(np.linspace(0.0, 4.0, 9))
    assert state.position[:, 2] == pytest.approx(np.linspace(0.0, 8.0, 9))
    assert not state.acceleration.any()
