"""Inserts and paths in the form of the kernels."""

from math import inf, pi, radians

import numpy as np
import pytest

from simulator.errors import SimulationError
from simulator.motion.segments import Segments, lines
from simulator.removal.cutter import Insert
from simulator.removal.lathe import body_of, ways_of
from simulator.removal.lathe_windows import Windows

WHOLE = Windows(segment=np.array([0]), start=np.zeros(1), end=np.array([0.5 * pi * 10.0]))


def quarter(normal: int = 1) -> Segments:
    """Quarter circle of 10 mm about (x, z) = (20, 50), from above it towards +z."""
    return Segments(
        start=np.array([[30.0, 0.0, 50.0]]),
        end=np.array([[20.0, 0.0, 60.0]]),
        speed=np.ones(1),
        is_rapid=np.zeros(1, dtype=np.bool_),
        centre=np.array([[20.0, 0.0, 50.0]]),
        turn=np.array([-0.5 * pi]),
        normal=np.array([normal]),
        block=np.array([7]),
    )


def test_edges_beyond_upright_are_upright() -> None:
    body = body_of(Insert(nose_radius=0.8, cutting_edge_angle=radians(95.0)))
    assert (body.back_slope, body.back_foot) == (inf, 0.8)
    assert body.front_slope == pytest.approx(0.0874887)
    assert body.front_foot == pytest.approx(0.8 * 0.0871557)
    assert body_of(Insert(nose_radius=0.2, width=3.0)).flat == pytest.approx(2.6)


def test_a_path_is_moved_to_the_centre_of_the_nose() -> None:
    line = lines([(20.0, 0.0, 50.0), (20.0, 0.0, 40.0)], speed=1.0)
    windows = Windows(segment=np.zeros(1, np.int64), start=np.zeros(1), end=np.array([5.0]))
    (way,) = ways_of(line, windows, Insert(nose_radius=0.8))
    np.testing.assert_allclose(way[:4], [50.8, 20.8, 45.8, 20.8])
    assert way[6] == 0.0


def test_an_arc_keeps_its_angles() -> None:
    (way,) = ways_of(quarter(), WHOLE, Insert())
    np.testing.assert_allclose(way, [50, 30, 60, 20, 50, 20, 10, 0.0, 0.5 * pi], atol=1e-12)


def test_a_bore_is_mirrored() -> None:
    (way,) = ways_of(quarter(), WHOLE, Insert(is_inside=True))
    expected = [50, -30, 60, -20, 50, -20, 10, -0.5 * pi, 0.5 * pi]
    np.testing.assert_allclose(way, expected, atol=1e-12)


def test_an_arc_in_another_plane_is_refused() -> None:
    with pytest.raises(SimulationError, match="block 7"):
        ways_of(quarter(normal=2), WHOLE, Insert())
