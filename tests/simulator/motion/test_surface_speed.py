"""A spindle that follows the radius, and how far it comes behind."""

from math import inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import Segments
from simulator.motion.tool_path import PIECE, behind, in_pieces


def facing(outer: float, inner: float) -> Segments:
    """A line in X from one radius to another."""
    return Segments(
        start=np.array([[outer, 0.0, 0.0]]),
        end=np.array([[inner, 0.0, 0.0]]),
        speed=np.array([1.0]),
        is_rapid=np.array([False]),
        centre=np.zeros((1, 3)),
        turn=np.zeros(1),
        normal=np.array([2]),
        block=np.array([0]),
    )


def test_radii_change_by_little_from_piece_to_piece() -> None:
    pieces = in_pieces(facing(50.0, 10.0), 5.0)
    radii = pieces.start[:, 0]
    assert len(pieces) >= np.log(5.0) / PIECE
    assert pieces.length.sum() == pytest.approx(40.0)
    assert radii[0] == 50.0
    assert pieces.end[-1, 0] == 10.0


def test_without_inertia_it_is_never_late() -> None:
    wanted = np.array([10.0, 20.0, 40.0])
    found = behind(wanted, np.ones(3), np.full(3, 0.1), ramp=inf)
    assert found == pytest.approx(wanted)


def test_a_late_spindle_has_the_mean_of_its_ramp() -> None:
    """From 10 rev/s at 5 rev/s²: 100 revolutions last until sqrt(10² + 2·5·100) rev/s."""
    found = behind(np.array([10.0, 500.0]), np.full(2, 10.0), np.full(2, 0.1), ramp=5.0)
    last = sqrt(10.0**2 + 2.0 * 5.0 * 100.0)
    assert found[0] == 10.0
    assert found[1] == pytest.approx(0.5 * (10.0 + last))


def test_after_a_rapid_it_has_caught_up() -> None:
    wanted, length = np.array([10.0, 50.0, 60.0]), np.full(3, 1.0)
    found = behind(wanted, length, np.array([0.1, 0.0, 0.1]), ramp=1.0)
    assert found[2] == 60.0


@given(
    goals=st.lists(st.floats(1.0, 100.0), min_size=1, max_size=20),
    ramp=st.floats(0.1, 1000.0),
)
def test_it_stays_within_what_is_wanted(goals: list[float], ramp: float) -> None:
    wanted = np.array(goals)
    found = behind(wanted, np.full(len(goals), pi), np.full(len(goals), 0.2), ramp=ramp)
    assert (found >= wanted.min() * (1.0 - 1e-9)).all()
    assert (found <= wanted.max() * (1.0 + 1e-9)).all()
