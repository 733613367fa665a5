from math import hypot, pi, tau

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import Segments, arc, chained, distinct, lines
from stepnc_model.toolpath.arc_columns import FIRST, SECOND
from tests.every_case import every_case


def _sampled(path: Segments, count: int = 7) -> tuple[np.ndarray, np.ndarray]:
    rows = np.repeat(np.arange(len(path)), count)
    return rows, np.tile(np.linspace(0.0, 1.0, count), len(path)) * path.length[rows]


@pytest.mark.parametrize("normal", [0, 1, 2])
def test_quarter_turn_goes_from_the_first_axis_of_the_plane_to_the_second(normal: int) -> None:
    start, end = np.zeros(3), np.zeros(3)
    start[FIRST[normal]], end[SECOND[normal]], end[normal] = 2.0, 2.0, 5.0
    helix = arc(list(start), [0.0, 0.0, 0.0], pi / 2, normal=normal, rise=5.0)
    assert helix.end[0] == pytest.approx(end, abs=1e-15)
    there = helix.position(np.array([0]), helix.length)
    assert there[0] == pytest.approx(end, abs=1e-14)


@pytest.mark.parametrize("turn", [tau, -3.5 * tau])
def test_helix_of_several_turns_is_as_long_as_its_unrolled_strip(turn: float) -> None:
    helix = arc([4.0, 0.0, 1.0], [0.0, 0.0, 9.0], turn, rise=-6.0)
    assert helix.length[0] == pytest.approx(hypot(4.0 * turn, 6.0))
    assert helix.radius[0] == pytest.approx(4.0)


def test_full_turns_come_back_over_the_start() -> None:
    helix = arc([4.0, 0.0, 0.0], [0.0, 0.0, 0.0], 3.0 * tau, rise=9.0)
    thirds = helix.position(np.zeros(4, np.int64), helix.length[0] * np.arange(4) / 3.0)
    assert thirds == pytest.approx(np.array([[4.0, 0.0, 3.0 * k] for k in range(4)]), abs=1e-12)


@given(
    normal=st.integers(0, 2),
    turn=st.floats(-20.0, 20.0).filter(lambda turn: abs(turn) > 1e-3),
    rise=st.floats(-30.0, 30.0),
    radius=st.floats(0.5, 80.0),
)
def test_direction_and_curvature_are_the_derivatives(
    normal: int, turn: float, rise: float, radius: float
) -> None:
    start = [0.0, 0.0, 0.0]
    start[SECOND[normal]] = radius
    helix = arc(start, [0.0, 0.0, 0.0], turn, normal=normal, rise=rise)
    rows, station = _sampled(helix)
    step = 1e-4 * radius
    ahead, behind = (helix.position(rows, station + by) for by in (step, -step))
    here = helix.position(rows, station)
    direction = helix.direction(rows, station)
    assert direction == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-7)
    assert np.linalg.norm(direction, axis=1) == pytest.approx(1.0)
    bend = (ahead - 2.0 * here + behind) / step**2
    assert helix.curvature(rows, station) == pytest.approx(bend, abs=1e-5 / radius)


def test_line_is_straight_and_its_direction_a_unit_vector() -> None:
    path = lines([(0, 0, 0), (3, 4, 0), (3, 4, 12)], speed=10.0)
    rows, station = _sampled(path)
    assert path.length == pytest.approx([5.0, 12.0])
    assert path.position(np.array([0]), np.array([2.5]))[0] == pytest.approx([1.5, 2.0, 0.0])
    assert path.direction(np.array([0]), np.array([1.0]))[0] == pytest.approx([0.6, 0.8, 0.0])
    assert not path.curvature(rows, station).any()
    assert not path.is_rapid.any()


def test_segment_without_length_has_a_place_but_no_direction() -> None:
    path = lines([(1, 2, 3), (1, 2, 3)])
    row, station = np.array([0]), np.array([0.0])
    assert path.position(row, station)[0] == pytest.approx([1.0, 2.0, 3.0])
    assert not path.direction(row, station).any()


def test_rows_are_taken_with_all_their_columns() -> None:
    path = chained([lines([(0, 0, 0), (1, 0, 0)]), arc([1, 0, 0], [0, 0, 0], 1.0, speed=5.0)])
    assert path.block.tolist() == [0, 1]
    last = path[1:]
    assert len(last) == 1
    assert last.turn[0] == 1.0
    assert last.speed[0] == 5.0


@every_case(
    ("column", "value", "message"),
    [
        ("start", np.zeros((1, 2)), r"start must be finite and of shape \(1, 3\)"),
        ("end", np.full((1, 3), np.nan), "end must be finite"),
        ("turn", np.array([np.inf]), "turn must be finite"),
        ("block", np.zeros(2), r"block must have shape \(1,\)"),
        ("speed", np.zeros(1), "speed must be positive"),
        ("speed", np.full(1, np.nan), "speed must be positive"),
        ("normal", np.array([3]), "normal must be 0, 1 or 2"),
    ],
)
def test_column_that_does_not_fit_is_refused(
    column: str, value: np.ndarray, message: str
) -> None:
    columns = {
        name: getattr(lines([(0, 0, 0), (1, 0, 0)]), name)
        for name in ("start", "end", "speed", "is_rapid", "centre", "turn", "normal", "block")
    }
    with pytest.raises(ValueError, match=message):
        Segments(**(columns | {column: value}))


@given(st.lists(st.integers(-5, 5)))
def test_distinct_values_are_those_of_a_set_in_order(values: list[int]) -> None:
    assert distinct(np.array(values, dtype=np.int64)).tolist() == sorted(set(values))
