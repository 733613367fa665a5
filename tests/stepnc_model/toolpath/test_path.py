"""Tool paths: their moves, starts and ends."""

from math import inf, nan

import pytest
from hypothesis import strategies as st

from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.path import (
    ArcPlane,
    Dwell,
    Move,
    MoveType,
    Point,
    SpindleCommand,
    Step,
    ToolPath,
)
from tests.every_case import every_case

ORIGIN = (0.0, 0.0, 0.0)
ANGLES = st.floats(-20.0, 20.0).filter(lambda angle: abs(angle) > 1e-3)


def line(x: float, y: float, z: float) -> Move:
    return Move(end=(x, y, z), type=MoveType.CONTACT)


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


class TestToolPath:
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
