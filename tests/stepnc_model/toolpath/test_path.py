"""Moves by station: lengths, points and ends, against geometry."""

from itertools import pairwise
from math import cos, dist, hypot, inf, nan, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.path import (
    Arc,
    ArcPlane,
    Dwell,
    Move,
    MoveType,
    Point,
    SpindleCommand,
    Step,
    ToolPath,
    length,
    points_along,
    radius,
)
from tests.every_case import every_case

ORIGIN = (0.0, 0.0, 0.0)
ANGLES = st.floats(-20.0, 20.0).filter(lambda angle: abs(angle) > 1e-3)


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


def path(*steps: Step, start: Point = ORIGIN) -> ToolPath:
    return ToolPath(
        workingstep=Ref(1),
        id="WS",
        operation_ref=Ref(2),
        tool_ref=Ref(3),
        technology_ref=Ref(4),
        functions_ref=None,
        is_turning=False,
        start=start,
        steps=steps,
    )


@pytest.mark.parametrize("plane", ArcPlane)
def test_axes_of_a_plane_are_right_handed(plane: ArcPlane) -> None:
    assert plane.axes in {(0, 1, 2), (1, 2, 0), (2, 0, 1)}


def test_axes_of_each_plane_differ_in_their_normal() -> None:
    assert [plane.axes[2] for plane in (ArcPlane.XY, ArcPlane.ZX, ArcPlane.YZ)] == [2, 1, 0]


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


class TestToolPath:
    def test_stations_add_up_along_the_moves(self) -> None:
        steps = (line(3.0, 4.0, 0.0), Dwell(seconds=1.0), line(3.0, 4.0, 2.0))
        assert path(*steps).stations() == (5.0, 7.0)

    def test_segments_tell_where_each_move_starts(self) -> None:
        one, other = line(1.0, 0.0, 0.0), line(1.0, 1.0, 0.0)
        segments = list(path(one, SpindleCommand.STOP, other).segments())
        assert segments == [(ORIGIN, one), (one.end, other)]

    def test_it_ends_where_its_last_move_ends(self) -> None:
        steps = (line(1.0, 0.0, 0.0), line(2.0, 0.0, 0.0), Dwell(seconds=1.0))
        assert path(*steps).end == (2.0, 0.0, 0.0)

    def test_without_moves_it_ends_where_it_starts(self) -> None:
        assert path(Dwell(seconds=1.0), start=(1.0, 2.0, 3.0)).end == (1.0, 2.0, 3.0)

    @every_case("wrong", [nan, inf, -inf])
    def test_a_position_that_is_no_number_is_refused(self, wrong: float) -> None:
        with pytest.raises(ValueError, match="'WS': position"):
            path(line(0.0, wrong, 0.0))
        with pytest.raises(ValueError, match="not finite"):
            path(start=(wrong, 0.0, 0.0))
