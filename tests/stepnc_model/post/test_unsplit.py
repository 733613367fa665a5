"""Cuts between contact and air vanish; every other corner of a path stays."""

from math import pi

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.post.neutral import unsplit
from stepnc_model.toolpath.path import Arc, Dwell, Feed, Move, MoveType, Point, Step

FEED = Feed(technology=Ref[Entity](1))
START: Point = (0.0, 0.0, 0.0)
AIR, CUT = MoveType.NO_CONTACT, MoveType.CONTACT


def line(x: float, type: MoveType, *, y: float = 0.0, feed: Feed = FEED) -> Move:
    return Move(end=(x, y, 0.0), type=type, feed=feed)


def test_a_stroke_from_air_through_material_to_air_is_one_line() -> None:
    steps = [line(5.0, AIR), line(95.0, CUT), line(100.0, AIR)]
    assert [step.end for step in unsplit(START, steps) if isinstance(step, Move)] == [
        (100.0, 0.0, 0.0)
    ]


def test_corners_and_ways_back_stay() -> None:
    for steps in (
        [line(5.0, AIR), line(5.0, CUT, y=1.0)],
        [line(5.0, AIR), line(3.0, CUT)],
    ):
        assert list(unsplit(START, steps)) == steps


def test_points_between_cuts_of_one_type_stay_as_they_are_given() -> None:
    steps = [line(5.0, CUT), line(95.0, CUT)]
    assert list(unsplit(START, steps)) == steps


def test_another_feed_or_a_pause_keeps_moves_apart() -> None:
    other = Feed(technology=Ref[Entity](1), ratio=0.5)
    steps = [line(5.0, AIR), line(95.0, CUT, feed=other)]
    assert list(unsplit(START, steps)) == steps
    paused: list[Step] = [line(5.0, AIR), Dwell(seconds=1.0), line(95.0, CUT)]
    assert list(unsplit(START, paused)) == paused


def test_parts_of_one_arc_turn_together() -> None:
    """A quarter in air and a quarter in material about the same centre make a half."""
    centre = (10.0, 0.0, 0.0)
    steps = [
        Move(
            end=(10.0, 10.0, 0.0), type=AIR, feed=FEED, arc=Arc(centre=centre, turn=-0.5 * pi)
        ),
        Move(end=(20.0, 0.0, 0.0), type=CUT, feed=FEED, arc=Arc(centre=centre, turn=-0.5 * pi)),
    ]
    (made,) = unsplit(START, steps)
    assert isinstance(made, Move)
    assert made.end == (20.0, 0.0, 0.0)
    assert made.arc == Arc(centre=centre, turn=-pi)


def test_arcs_about_different_centres_stay_two() -> None:
    steps = [
        Move(
            end=(2.0, 0.0, 0.0), type=AIR, feed=FEED, arc=Arc(centre=(1.0, 0.0, 0.0), turn=pi)
        ),
        Move(
            end=(4.0, 0.0, 0.0), type=CUT, feed=FEED, arc=Arc(centre=(3.0, 0.0, 0.0), turn=pi)
        ),
    ]
    assert list(unsplit(START, steps)) == steps
