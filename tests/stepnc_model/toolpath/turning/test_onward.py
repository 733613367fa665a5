"""Lift, back path and step over of the shaft's roughing, each as its own move."""

from collections.abc import Callable
from math import isclose

import pytest

from stepnc_model.errors import Severity
from stepnc_model.toolpath.path import Move, MoveType, Point, ToolPath
from stepnc_model.toolpath.turning.passes import meeting
from tests.every_case import every_case

PathOf = Callable[..., ToolPath]

OLD = "#352=UNIDIRECTIONAL_TURNING(1.,.T.,(2.),$,#504,#501,#502,#506,1.,$,$);"
FEEDS = "FEED_PER_REV_TYPE(0.5),FEED_PER_REV_TYPE(0.4)"
NEW = """
#911=DIRECTION('BACK, RISING',(0.1,0.,1.));
#912=DIRECTION('OUT AND BACK',(1.,0.,1.));
#913=DIRECTION('IN AND TO THE CHUCK',(-1.,0.,-1.));
#914=DIRECTION('BACK, FALLING',(-0.03,0.,1.));
#915=DIRECTION('IN AND BACK',(-1.,0.,9.));
#916=DIRECTION('NOWHERE',(0.,0.,0.));
"""


def strategy(ways: str) -> tuple[str, str]:
    """Roughing with other ways: back, lift, step over, height, feeds."""
    return OLD, f"#352=UNIDIRECTIONAL_TURNING(1.,.T.,(2.),$,#504,{ways});{NEW}"


def after_first_pass(path: ToolPath) -> list[tuple[Point, Move]]:
    """The moves from the end of the first pass to the second one."""
    moves = list(path.segments())
    cuts = [i for i, (_, m) in enumerate(moves) if m.type is MoveType.CONTACT]
    return moves[cuts[0] + 1 : cuts[1]]


def test_lift_back_and_step_over_are_a_box(path_of: PathOf) -> None:
    """From (28, −109.5): 2 mm out, back over the front, in to the next level of 26 mm."""
    between = after_first_pass(path_of("ROUGH CONTOUR", strategy(f"#501,#502,#506,2.,{FEEDS}")))
    spots = [(round(m.end[0], 6), round(m.end[2], 6)) for _, m in between]
    assert spots[0] == (30.0, -109.5)
    assert spots[-3:-1] == [(30.0, 1.0), (26.0, 1.0)]
    lift, *_, back, step, _ = [m for _, m in between]
    assert lift.feed is not None
    assert lift.feed.per_revolution == 0.5
    assert (back.feed, back.type) == (None, MoveType.RAPID)
    assert step.feed is not None
    assert step.feed.per_revolution == 0.4


def test_without_a_feed_the_step_over_is_a_rapid_where_it_is_clear(path_of: PathOf) -> None:
    between = after_first_pass(path_of("ROUGH CONTOUR", strategy("#501,#502,#506,2.,$,$")))
    back, step = [m for _, m in between if m.type is MoveType.RAPID]
    assert back.end[2] == step.end[2] == pytest.approx(1.0)


def test_oblique_directions_are_followed(path_of: PathOf) -> None:
    between = after_first_pass(path_of("ROUGH CONTOUR", strategy(f"#911,#912,#913,3.,{FEEDS}")))
    along = [(m.end[0] - a[0], m.end[2] - a[2]) for a, m in between if m.end != a]
    assert along[0][0] == pytest.approx(along[0][1]) == pytest.approx(3.0 / 2.0**0.5)
    assert all(isclose(x, 0.1 * z) for x, z in along[1:-2])
    assert along[-2][0] == pytest.approx(along[-2][1])
    assert along[-2][0] < 0.0
    assert path_of("ROUGH CONTOUR", strategy("#911,#912,#913,3.,$,$")).findings == ()


@every_case(
    ("ways", "text"),
    [
        ("#914,#502,#506,2.", "return path"),
        ("#501,#502,#915,2.", "stepover would hit"),
        ("#501,#506,#506,2.", "the lift points into the part"),
        ("#501,#501,#506,2.", "lift does not leave"),
        ("#501,#502,#504,2.", "along the feed"),
        ("#501,#502,#502,2.", "away from the part"),
        ("#504,#502,#506,2.", "does not point back"),
        ("#501,#916,#506,2.", "not in the lathe's x-z plane"),
        ("#501,#502,#506,0.", "too little for a rapid"),
    ],
)
def test_what_makes_no_sense_is_said_and_a_sane_path_made(
    path_of: PathOf, ways: str, text: str
) -> None:
    path = path_of("ROUGH CONTOUR", strategy(f"{ways},$,$"))
    warnings = [f for f in path.findings if f.severity is Severity.WARNING]
    assert text in str(warnings)
    assert path.end == path.start
    assert min(m.end[0] for m in path.moves) > 13.0


def test_the_last_pass_is_left_by_a_lift_too(path_of: PathOf) -> None:
    moves = list(path_of("FINISH FACE").segments())
    last = max(i for i, (_, m) in enumerate(moves) if m.type is MoveType.CONTACT)
    start, lift = moves[last + 1]
    assert lift.end[2] - start[2] == pytest.approx(2.0)
    assert lift.type is MoveType.NO_CONTACT


def test_the_ratio_of_the_step_over_counts_where_it_cuts(path_of: PathOf) -> None:
    text = f"#352=CONTOUR_TURNING(0.,.T.,(2.),$,#504,#501,#502,#506,1.,{FEEDS},0.5);"
    moves = path_of("ROUGH CONTOUR", (OLD, text)).moves
    feeds = {m.feed.per_revolution: m.type for m in moves if m.feed}
    assert feeds.get(0.4, MoveType.NO_CONTACT) is MoveType.NO_CONTACT
    assert feeds.get(0.2, MoveType.CONTACT) is MoveType.CONTACT


def test_a_turn_between_two_ways_is_where_they_meet() -> None:
    assert meeting(((0.0, 1.0), (1.0, 0.0)), ((5.0, 0.0), (-1.0, -1.0))) == (6.0, 1.0)
    assert meeting(((0.0, 1.0), (1.0, 0.0)), ((5.0, 0.0), (1.0, 0.0))) is None
    assert meeting(((0.0, 1.0), (1.0, 0.0)), ((-5.0, 0.0), (0.0, -1.0))) is None
