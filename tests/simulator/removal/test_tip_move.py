"""Places, boxes and distances of lines, arcs and helices against closed forms."""

from math import cos, hypot, inf, isinf, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import Floats
from simulator.removal.tip_move import TipMove, arc_distance, bounds, helix_height, place
from tests.every_case import every_case

RADIUS = 20.0
CENTRE = (3.0, -4.0, 7.0)

angles = st.floats(-pi, pi)
turns = st.one_of(st.floats(0.1, pi), st.floats(-pi, -0.1))


def row(normal: int, angle: float, turn: float, *, rise: float = 0.0) -> Floats:
    """An arc about the centre, from an angle, with a rise along its normal."""

    def point(at: float, up: float) -> Floats:
        spot = np.array(CENTRE)
        spot[(normal + 1) % 3] += RADIUS * cos(at)
        spot[(normal + 2) % 3] += RADIUS * sin(at)
        spot[normal] += up
        return spot

    ends = (point(angle, 0.0), point(angle + turn, rise))
    return np.array([*ends[0], *ends[1], *CENTRE, RADIUS, angle, turn, float(normal)])


def arc(angle: float, turn: float, *, rise: float = 0.0) -> TipMove:
    """An arc in XY about the origin."""
    return TipMove(
        x=RADIUS * cos(angle), y=RADIUS * sin(angle), z=0.0,
        end_x=RADIUS * cos(angle + turn), end_y=RADIUS * sin(angle + turn), end_z=rise,
        centre_x=0.0, centre_y=0.0, radius=RADIUS, angle=angle, turn=turn,
    )  # fmt: skip


def points_of(way: TipMove, count: int = 2001) -> Floats:
    """(count, 2) points along an arc."""
    angle = way.angle + way.turn * np.linspace(0.0, 1.0, count)
    return RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_a_place_on_a_line_divides_it() -> None:
    line = np.array([1.0, 2.0, 3.0, 5.0, -2.0, 11.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0])
    assert place(line, 0.25) == pytest.approx((2.0, 1.0, 5.0))


@every_case("normal", [0, 1, 2])
@every_case("turn", [1.2, -2.5])
def test_a_place_on_a_helix_keeps_its_radius_and_rises_evenly(normal: int, turn: float) -> None:
    whole = row(normal, 0.4, turn, rise=6.0)
    for part in (0.0, 0.3, 1.0):
        arm = np.array(place(whole, part)) - CENTRE
        assert arm[normal] == pytest.approx(6.0 * part)
        assert arm[(normal + 1) % 3] == pytest.approx(RADIUS * cos(0.4 + part * turn))
        assert arm[(normal + 2) % 3] == pytest.approx(RADIUS * sin(0.4 + part * turn))


@given(angle=angles, turn=turns)
def test_the_box_is_that_of_its_points(angle: float, turn: float) -> None:
    way = arc(angle, turn)
    low_x, high_x, low_y, high_y = bounds(way, 0.0)
    points = points_of(way)
    # 2000 chords of half a turn miss the bulge by 20·(1 − cos(π/4000)).
    assert (low_x, low_y) == pytest.approx(tuple(points.min(axis=0)), abs=1e-5)
    assert (high_x, high_y) == pytest.approx(tuple(points.max(axis=0)), abs=1e-5)


@given(angle=angles, turn=turns, x=st.floats(-40.0, 40.0), y=st.floats(-40.0, 40.0))
def test_the_distance_is_that_of_the_nearest_point(
    angle: float, turn: float, x: float, y: float
) -> None:
    way = arc(angle, turn)
    nearest = float(np.hypot(*(points_of(way) - (x, y)).T).min())
    found = arc_distance(way, x, y)
    assert nearest - 0.02 < found <= nearest + 1e-9


@pytest.mark.parametrize(
    ("x", "y", "distance"),
    [(0.0, 25.0, 5.0), (0.0, 12.0, 8.0), (20.0, -3.0, 3.0), (-23.0, -4.0, 5.0)],
)
def test_distances_from_half_a_turn(x: float, y: float, distance: float) -> None:
    assert arc_distance(arc(0.0, pi), x, y) == pytest.approx(distance)


@given(angle=angles, turn=turns, rise=st.floats(-8.0, 8.0), at=angles, away=st.floats(8, 32))
def test_the_least_height_is_that_of_the_lowest_tool_that_covers(
    angle: float, turn: float, rise: float, at: float, away: float
) -> None:
    reach = 6.0
    way = arc(angle, turn, rise=rise)
    x, y = away * cos(at), away * sin(at)
    points = points_of(way)
    heights = rise * np.linspace(0.0, 1.0, len(points))
    gap = np.hypot(*(points - (x, y)).T)
    found = helix_height(way, x, y, reach)
    surely, perhaps = heights[gap < reach - 0.02], heights[gap < reach + 0.02]
    assert (perhaps.min() if len(perhaps) else inf) <= found + 0.02
    assert found <= (surely.min() if len(surely) else inf) + 0.02


def test_a_point_beside_the_sweep_stays_untouched() -> None:
    assert isinf(helix_height(arc(0.0, 1.0, rise=-2.0), hypot(27.0, 0.0), 0.0, 6.0))
