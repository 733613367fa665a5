"""Arcs and helices against geometry."""

from itertools import pairwise
from math import cos, dist, hypot, isnan, nan, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.toolpath.arc import (
    angle_between,
    begun_turns,
    centre_of_radius,
    chord_angle,
    circles_meet,
    full_turns,
    inner_points,
    length,
    line_meets_circle,
    point_at,
    points_along,
    radius,
    swept,
    turn_of,
)
from stepnc_model.toolpath.path import Arc, ArcPlane, Move, MoveType, Point

ORIGIN = (0.0, 0.0, 0.0)
ANGLES = st.floats(-20.0, 20.0).filter(lambda angle: abs(angle) > 1e-3)
PLACES = st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
RADII = st.floats(0.1, 80.0)


def line(x: float, y: float, z: float) -> Move:
    return Move(end=(x, y, z), type=MoveType.CONTACT)


def arc_about_origin(
    size: float, turn: float, rise: float, plane: ArcPlane
) -> tuple[Point, Move]:
    """An arc that starts on the first axis of its plane."""
    first, second, normal = plane.axes
    start, end = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    start[first] = size
    end[first], end[second], end[normal] = size * cos(turn), size * sin(turn), rise
    arc = Arc(centre=ORIGIN, turn=turn, plane=plane)
    move = Move(end=(end[0], end[1], end[2]), type=MoveType.CONTACT, arc=arc)
    return (start[0], start[1], start[2]), move


def test_length_of_a_line_is_the_distance() -> None:
    assert length((1.0, 2.0, 3.0), line(3.0, 5.0, 9.0)) == 7.0


@pytest.mark.parametrize("plane", ArcPlane)
def test_length_of_three_turns_is_three_circumferences(plane: ArcPlane) -> None:
    start, move = arc_about_origin(5.0, 6.0 * pi, 0.0, plane)
    assert length(start, move) == pytest.approx(30.0 * pi)


def test_length_of_a_helix_adds_its_rise_at_a_right_angle() -> None:
    start, move = arc_about_origin(3.0, -2.0, -8.0, ArcPlane.XY)
    assert length(start, move) == pytest.approx(hypot(6.0, 8.0))


def test_radius_leaves_out_the_normal() -> None:
    arc = Arc(centre=(1.0, 1.0, 100.0), turn=1.0)
    assert radius((4.0, 5.0, 0.0), arc) == 5.0


@given(
    size=st.floats(0.1, 100.0),
    turn=ANGLES,
    rise=st.floats(-50.0, 50.0),
    plane=st.sampled_from(ArcPlane),
    step=st.floats(0.05, 2.0),
)
def test_points_of_an_arc_lie_on_it_and_end_at_its_end(
    size: float, turn: float, rise: float, plane: ArcPlane, step: float
) -> None:
    start, move = arc_about_origin(size, turn, rise, plane)
    points = list(points_along(start, move, step=step))
    first, second, normal = plane.axes
    assert points[-1] == move.end
    assert abs(turn) / len(points) <= step
    for index, point in enumerate(points, 1):
        part = index / len(points)
        assert point[first] == pytest.approx(size * cos(part * turn), abs=1e-9)
        assert point[second] == pytest.approx(size * sin(part * turn), abs=1e-9)
        assert point[normal] == pytest.approx(part * rise, abs=1e-9)


def test_points_of_a_line_are_its_end() -> None:
    assert list(points_along(ORIGIN, line(9.0, 0.0, 0.0), step=0.1)) == [(9.0, 0.0, 0.0)]


def test_chords_of_a_fine_step_are_as_long_as_the_arc() -> None:
    start, move = arc_about_origin(10.0, 1.5 * pi, 4.0, ArcPlane.YZ)
    points = [start, *points_along(start, move, step=0.001)]
    chords = sum(dist(a, b) for a, b in pairwise(points))
    assert chords == pytest.approx(length(start, move), rel=1e-6)


@pytest.mark.parametrize(
    ("end", "plane", "sense", "angle"),
    [
        ((0.0, 1.0, 0.0), ArcPlane.XY, 1.0, 0.5 * pi),
        ((0.0, 1.0, 0.0), ArcPlane.XY, -1.0, 1.5 * pi),
        ((1.0, 0.0, 0.0), ArcPlane.XY, 1.0, 2.0 * pi),
        ((0.0, 0.0, 1.0), ArcPlane.ZX, -1.0, 0.5 * pi),
    ],
)
def test_a_sweep_is_counted_from_the_first_axis_to_the_second(
    end: Point, plane: ArcPlane, sense: float, angle: float
) -> None:
    found = swept((1.0, 0.0, 0.0), end, ORIGIN, plane, sense=sense)
    assert found == pytest.approx(angle)


@pytest.mark.parametrize("plane", ArcPlane)
def test_a_point_of_a_helix_has_turned_and_risen_by_its_part(plane: ArcPlane) -> None:
    """A third of three quarters of a turn is a quarter turn, onto the second axis."""
    start, move = arc_about_origin(2.0, 1.5 * pi, 6.0, plane)
    first, second, normal = plane.axes
    point = point_at(start, move, 1.0 / 3.0)
    assert (point[first], point[second]) == pytest.approx((0.0, 2.0))
    assert point[normal] == pytest.approx(2.0)
    assert next(inner_points(start, move, 3)) == point


def test_a_chord_lies_beside_its_arc_by_the_sagitta() -> None:
    """Sagitta r (1 - cos a/2) of the chord's angle a; less than a quarter turn is allowed."""
    angle = chord_angle(50.0, 1e-3)
    assert 50.0 * (1.0 - cos(0.5 * angle)) == pytest.approx(1e-3, rel=1e-5)
    assert chord_angle(1e-9, 1e-3) == 2.0


@pytest.mark.parametrize(
    ("turn", "begun", "full", "rest"),
    [
        (0.5 * pi, 1, 0, 0.5 * pi),
        (-2.0 * pi, 1, 1, 0.0),
        (4.0 * pi, 2, 2, 0.0),
        (-5.0 * pi, 3, 2, pi),
        (2.0 * pi - 1e-9, 1, 1, 0.0),
    ],
)
def test_turns_are_counted(turn: float, begun: int, full: int, rest: float) -> None:
    assert begun_turns(turn) == begun
    assert full_turns(turn) == pytest.approx((full, rest), abs=1e-8)


@given(size=RADII, turn=ANGLES, plane=st.sampled_from(ArcPlane))
def test_an_arc_is_found_again_from_its_ends(size: float, turn: float, plane: ArcPlane) -> None:
    """Less than a turn, as ends say no more, and with a chord that determines the centre."""
    sense, turn = (1.0 if turn > 0.0 else -1.0), abs(turn) % (2.0 * pi)
    if min(turn, abs(turn - pi), 2.0 * pi - turn) < 0.1:
        return
    start, move = arc_about_origin(size, sense * turn, 3.0, plane)
    assert turn_of(start, move.end, ORIGIN, plane, sense=sense) == pytest.approx(sense * turn)
    signed = size if turn < pi else -size
    centre = centre_of_radius(start, move.end, radius=signed, plane=plane, sense=sense)
    for axis in plane.axes[:2]:
        assert centre[axis] == pytest.approx(0.0, abs=1e-6 * size)


def test_ends_that_coincide_are_a_full_turn() -> None:
    start = (5.0, 0.0, 0.0)
    assert turn_of(start, start, ORIGIN, ArcPlane.XY, sense=-1.0) == -2.0 * pi


def test_radii_that_differ_make_no_arc() -> None:
    assert isnan(turn_of((5.0, 0.0, 0.0), (0.0, 6.0, 0.0), ORIGIN, ArcPlane.XY, sense=1.0))
    assert isnan(turn_of((nan, 0.0, 0.0), (0.0, 5.0, 0.0), ORIGIN, ArcPlane.XY, sense=1.0))


def test_an_end_beyond_the_diameter_has_no_centre() -> None:
    far = centre_of_radius(ORIGIN, (9.0, 0.0, 0.0), radius=4.0, plane=ArcPlane.XY, sense=1.0)
    assert isnan(far[0])


def test_a_turn_to_the_left_is_positive() -> None:
    assert angle_between((1.0, 1.0), (2.0, 1.0), (1.0, 3.0)) == pytest.approx(0.5 * pi)
    assert angle_between((1.0, 1.0), (2.0, 1.0), (1.0, 0.0)) == pytest.approx(-0.5 * pi)


@given(point=PLACES, angle=st.floats(-pi, pi), centre=PLACES, size=RADII)
def test_a_line_meets_a_circle_on_both(
    point: tuple[float, float], angle: float, centre: tuple[float, float], size: float
) -> None:
    way = cos(angle), sin(angle)
    beside = way[0] * (point[1] - centre[1]) - way[1] * (point[0] - centre[0])
    found = line_meets_circle(point, way, centre, size)
    assert (len(found) == 2) is (abs(beside) <= size)
    for x, y in found:
        assert dist((x, y), centre) == pytest.approx(size)
        off = way[0] * (y - point[1]) - way[1] * (x - point[0])
        assert off == pytest.approx(0.0, abs=1e-9)


@given(one=PLACES, other=PLACES, first=RADII, second=RADII)
def test_circles_meet_on_both(
    one: tuple[float, float], other: tuple[float, float], first: float, second: float
) -> None:
    apart = dist(one, other)
    found = circles_meet(one, first, other, second)
    if min(abs(apart - first - second), abs(apart - abs(first - second))) < 1e-6:
        return
    assert (len(found) == 2) is (abs(first - second) < apart < first + second)
    for point in found:
        assert dist(point, one) == pytest.approx(first, rel=1e-6)
        assert dist(point, other) == pytest.approx(second, rel=1e-6)


def test_circles_of_three_and_four_about_centres_five_apart_meet_at_right_angles() -> None:
    left, right = list(circles_meet((0.0, 0.0), 3.0, (5.0, 0.0), 4.0))
    assert left == pytest.approx((1.8, 2.4))
    assert right == pytest.approx((1.8, -2.4))
    assert circles_meet((1.0, 1.0), 3.0, (1.0, 1.0), 3.0) == ()
