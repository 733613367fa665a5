"""Rapids keep clear of what is left, and feeds take it off."""

from collections.abc import Callable

import pytest

from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.path import Feed, MoveType
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask
from stepnc_model.toolpath.turning.path_builder import Feeds, TurningPathBuilder, split
from stepnc_model.toolpath.turning.profile import (
    HalfPlane,
    ProfilePiece,
    RadiusProfile,
    level_line,
)

FEED = Feed(technology=Ref(1))
BAR = RadiusProfile(pieces=(level_line(30.0, -100.0, 0.0),))


def walk(job: Callable[..., ToolPathTask]) -> tuple[TurningPathBuilder, PathBuilder]:
    course = PathBuilder(job("ROUGH CONTOUR"), (40.0, 0.0, 20.0), is_turning=True)
    feeds = Feeds(cutting=FEED, lift=FEED, stepover=FEED, entering=FEED)
    return TurningPathBuilder(course, HalfPlane(), BAR, nose=0.8, feeds=feeds), course


def test_a_place_in_front_of_the_bar_is_reached_in_rapid(
    job: Callable[..., ToolPathTask],
) -> None:
    tool, course = walk(job)
    tool.travel((5.0, 20.0))
    assert all(m.feed is None and m.type is MoveType.APPROACH for m in course.finished().moves)
    assert tool.at == (5.0, 20.0)


def test_the_last_millimetre_to_the_bar_is_fed(job: Callable[..., ToolPathTask]) -> None:
    tool, course = walk(job)
    tool.travel((0.9, 20.0))
    *rapids, last = course.finished().moves
    assert rapids[-1].end[2] == pytest.approx(1.8, abs=1e-5)
    assert (last.feed, last.type) == (FEED, MoveType.NO_CONTACT)


def test_a_feed_cuts_where_it_meets_the_bar_and_takes_it_off(
    job: Callable[..., ToolPathTask],
) -> None:
    tool, course = walk(job)
    tool.travel((5.0, 28.8))
    tool.feed([ProfilePiece(start=(5.0, 28.8), end=(-50.0, 28.8))])
    kinds = [m.type for m in course.finished().moves if m.feed]
    assert kinds == [MoveType.NO_CONTACT, MoveType.CONTACT]
    assert tool.stock.at(-20.0) == pytest.approx(28.0)
    assert tool.stock.at(-60.0) == 30.0


def test_a_rapid_behind_the_bar_goes_over_it(job: Callable[..., ToolPathTask]) -> None:
    tool, course = walk(job)
    tool.travel((5.0, 20.0))
    before = course.count
    tool.travel((-110.0, 20.0))
    moves = course.finished().moves[before:]
    assert max(m.end[0] for m in moves) == pytest.approx(31.8)


def test_a_line_is_split_where_it_touches(job: Callable[..., ToolPathTask]) -> None:
    tool, _ = walk(job)
    line = ProfilePiece(start=(5.0, 20.0), end=(-5.0, 20.0))
    assert [(p.end[0], c) for p, c in split(line, tool.rim)] == [
        (pytest.approx(0.8), False),
        (-5.0, True),
    ]
