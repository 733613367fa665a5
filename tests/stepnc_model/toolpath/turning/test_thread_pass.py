"""One pass of a thread: what it calls contact, and how it leaves."""

from collections.abc import Callable

import pytest

from stepnc_model.toolpath.path import Move, MoveType
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask
from stepnc_model.toolpath.turning.profile import RadiusProfile, level_line
from stepnc_model.toolpath.turning.thread import ThreadPass, cut_thread

RELIEVED = RadiusProfile(pieces=(level_line(12.0, -30.0, -25.0), level_line(15.0, -25.0, 0.0)))
AIR, CONTACT, RAPID = MoveType.NO_CONTACT, MoveType.CONTACT, MoveType.RAPID


def moves(
    job: Callable[..., ToolPathTask], *, end: float, angle: float | None, has_relief: bool
) -> list[Move]:
    at = job("THREAD M30 X 2")
    course = PathBuilder(at, (35.0, 0.0, 4.0), is_turning=True)
    one = ThreadPass(
        start=4.0, end=end, bottom=14.0, clear=17.0, angle=angle, has_relief=has_relief
    )
    cut_thread(at, course, one, stock=RELIEVED, pitch=2.0, kind=RAPID)
    return list(course.finished().moves)


def test_run_in_and_run_out_are_air_and_the_thread_is_contact(
    job: Callable[..., ToolPathTask],
) -> None:
    found = moves(job, end=-27.0, angle=None, has_relief=True)
    assert [m.type for m in found] == [RAPID, AIR, AIR, CONTACT, AIR, RAPID]
    assert [m.end[2] for m in found[2:5]] == pytest.approx([0.0, -25.0, -27.0])


def test_without_relief_it_leaves_at_the_feed(job: Callable[..., ToolPathTask]) -> None:
    *_, cut, out, over = moves(job, end=-20.0, angle=None, has_relief=False)
    assert [m.type for m in (cut, out, over)] == [CONTACT, CONTACT, AIR]
    assert out.end == pytest.approx((15.0, 0.0, -20.0))
    assert out.feed is not None
    assert not out.feed.is_synchronised


def test_at_an_angle_it_leaves_bound_to_the_spindle(job: Callable[..., ToolPathTask]) -> None:
    """3 mm out at 45 degrees: 1 mm of it in the material."""
    *_, cut, out, over = moves(job, end=-20.0, angle=45.0, has_relief=False)
    assert [m.end for m in (cut, out, over)] == [
        pytest.approx((14.0, 0.0, -17.0)),
        pytest.approx((15.0, 0.0, -18.0)),
        pytest.approx((17.0, 0.0, -20.0)),
    ]
    assert len({m.feed for m in (cut, out, over)}) == 1
