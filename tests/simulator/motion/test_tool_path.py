"""Tool paths run as their feeds, spindle and waits say."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.library import load_machine
from simulator.motion.control import ExactStop
from simulator.motion.fir import FilterWithinLimits
from simulator.motion.passing import motion_of
from simulator.motion.segments import AxisLimits, axis_limits
from simulator.motion.tool_path import (
    LookUp,
    PathGeometry,
    SpeedRatios,
    ToolPathRun,
    follows,
    paced,
    run_of,
    usual_motion,
)
from simulator.spec import Spindle
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PostError
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import Rate, RateMode, SpindleDirection, SpindleOn, SurfaceSpeed
from stepnc_model.post.modal_state import ModalState
from stepnc_model.toolpath.path import (
    Arc,
    ArcPlane,
    Dwell,
    Feed,
    Move,
    MoveType,
    Point,
    SpindleCommand,
    Step,
    ToolPath,
)
from tests.oracles.motion import move_time

HERE, OTHER = Ref[Entity](7), Ref[Entity](8)
FEED = Feed(technology=HERE)
STIFF = AxisLimits(acceleration=np.full(3, inf), rapid=np.full(3, 1e9), feed=np.full(3, inf))
SPINDLE = Spindle(curve=(), efficiency=1.0, min_speed=None, max_speed=100.0, acceleration=40.0)


def by_time(feed: Feed) -> ModalState:
    """10 mm/s at 20 rev/s, by the ratios of the move."""
    speed = 20.0 * feed.speed_ratio
    value = feed.velocity or (
        feed.per_revolution * speed if feed.per_revolution else 10.0 * feed.ratio
    )
    return ModalState(spindle=SpindleOn(speed=speed), rate=Rate(value=value))


def on_lathe(_feed: Feed) -> ModalState:
    """0.2 mm/rev at 2000 mm/s of the surface, 50 rev/s at most."""
    return ModalState(
        spindle=SurfaceSpeed(speed=2000.0, limit=50.0),
        rate=Rate(value=0.2, mode=RateMode.PER_REVOLUTION),
    )


def cut(*end: float, feed: Feed | None = FEED, arc: Arc | None = None) -> Move:
    return Move(end=(end[0], end[1], end[2]), type=MoveType.CONTACT, feed=feed, arc=arc)


def path_of(steps: Sequence[Step], start: Point = (0.0, 0.0, 0.0)) -> ToolPath:
    return ToolPath(
        workingstep=Ref[Entity](1),
        id="STEP",
        operation_ref=Ref[Entity](2),
        tool_ref=None,
        technology_ref=HERE,
        functions_ref=None,
        is_turning=False,
        start=start,
        steps=tuple(steps),
    )


def run(*steps: Step, look_up: LookUp = by_time, start: Point = (0.0, 0.0, 0.0)) -> ToolPathRun:
    return run_of(PathGeometry(path_of(steps, start)), look_up, SPINDLE)


def time(ran: ToolPathRun) -> float:
    return motion_of(ran, ExactStop(), STIFF).duration


def test_moves_run_at_their_feed_and_rapids_in_no_time() -> None:
    assert time(run(cut(30, 40, 0), cut(0, 0, 90, feed=None))) == pytest.approx(5.0)


def test_ramps_count() -> None:
    limits = replace(STIFF, acceleration=np.full(3, 50.0))
    ran = run(cut(30, 0, 0), cut(30, 5, 0))
    expected = sum(move_time(way, speed=10.0, acceleration=50.0) for way in (30.0, 5.0))
    assert motion_of(ran, ExactStop(), limits).duration == pytest.approx(expected)


def test_a_move_that_only_changes_what_it_touches_is_one() -> None:
    first = replace(cut(3, 0, 0), type=MoveType.NO_CONTACT)
    assert len(run(first, cut(9, 0, 0)).segments) == 1


def test_dwells_wait_for_seconds_or_revolutions() -> None:
    ran = run(cut(10, 0, 0), Dwell(seconds=0.5), cut(20, 0, 0), Dwell(revolutions=4.0))
    assert time(ran) == pytest.approx(2.0 + 0.5 + 4.0 / 20.0)


def test_the_feed_waits_for_another_speed_of_the_spindle() -> None:
    slow = replace(FEED, speed_ratio=0.5)
    assert time(run(cut(10, 0, 0), cut(20, 0, 0, feed=slow))) == pytest.approx(2.0 + 0.25)


def test_reversing_takes_twice_the_ramp() -> None:
    ran = run(cut(0, 0, -10), SpindleCommand.REVERSE, cut(0, 0, 0))
    assert time(ran) == pytest.approx(2.0 + 2.0 * 20.0 / 40.0)


def test_the_spindle_is_as_fast_as_the_machine_allows() -> None:
    ran = run(cut(10, 0, 0), look_up=lambda _: ModalState(
        spindle=SpindleOn(speed=400.0), rate=Rate(value=5.0)
    ))  # fmt: skip
    assert ran.spindle.tolist() == [100.0]


def test_a_spindle_that_turns_the_other_way_is_told() -> None:
    assert run(cut(10, 0, 0)).is_clockwise
    left = ModalState(
        spindle=SpindleOn(speed=5.0, sense=SpindleDirection.COUNTERCLOCKWISE),
        rate=Rate(value=5.0),
    )
    assert not run(cut(10, 0, 0), look_up=lambda _: left).is_clockwise


def test_facing_at_constant_surface_speed_takes_the_time_of_the_integral() -> None:
    """dt = 2πr·dr/(f·v): π·(r₁² − r₂²)/(f·v); the middle of a piece is exact for it."""
    ran = run(cut(10, 0, 0), look_up=on_lathe, start=(40.0, 0.0, 0.0))
    assert time(ran) == pytest.approx(pi * (40.0**2 - 10.0**2) / (0.2 * 2000.0), rel=1e-9)
    assert len(ran.segments) > 50


def test_near_the_axis_the_spindle_has_its_greatest_speed() -> None:
    ran = run(cut(0, 0, 0), look_up=on_lathe, start=(5.0, 0.0, 0.0))
    assert len(ran.segments) == 1
    assert time(ran) == pytest.approx(5.0 / (0.2 * 50.0))


def test_longitudinal_turning_has_one_speed() -> None:
    ran = run(cut(20, 0, -50), look_up=on_lathe, start=(20.0, 0.0, 0.0))
    assert time(ran) == pytest.approx(50.0 / (0.2 * 2000.0 / (2.0 * pi * 20.0)))


@given(st.floats(-6.0, 6.0).filter(lambda turn: abs(turn) > 0.01), st.floats(1.0, 60.0))
def test_pieces_of_an_arc_are_the_arc(turn: float, size: float) -> None:
    """Split because the spindle follows the radius: same length, same turn, no gaps."""
    centre = (70.0, 0.0, 0.0)
    angle = complex(np.cos(turn), np.sin(turn)) * size
    # In ZX the first axis is z.
    end = (70.0 + angle.imag, 0.0, angle.real)
    move = cut(*end, arc=Arc(centre=centre, turn=turn, plane=ArcPlane.ZX))
    segments = run(move, look_up=on_lathe, start=(70.0, 0.0, size)).segments
    assert segments.length.sum() == pytest.approx(abs(turn) * size)
    assert segments.turn.sum() == pytest.approx(turn)
    assert segments.start[1:] == pytest.approx(segments.end[:-1])
    assert segments.end[-1].tolist() == list(end)


def test_a_faster_pace_leaves_feeds_of_their_own() -> None:
    own = replace(FEED, velocity=4.0)
    look_up = paced(by_time, SpeedRatios(technology=HERE, feed=2.0, speed=1.5))
    ran = run(cut(30, 0, 0), cut(38, 0, 0, feed=own), look_up=look_up)
    assert ran.segments.speed.tolist() == pytest.approx([30.0, 4.0])
    assert ran.spindle.tolist() == pytest.approx([30.0, 30.0])
    assert follows(ran, HERE).tolist() == [True, False]


def test_feeds_per_revolution_follow_the_spindle_alone() -> None:
    own = replace(FEED, per_revolution=0.1)
    look_up = paced(by_time, SpeedRatios(technology=HERE, feed=2.0, speed=1.5))
    ran = run(cut(30, 0, 0, feed=own), look_up=look_up)
    assert ran.segments.speed.tolist() == pytest.approx([3.0])
    assert not follows(ran, HERE).any()


def test_another_technology_keeps_its_pace() -> None:
    look_up = paced(by_time, SpeedRatios(technology=OTHER, feed=2.0, speed=1.5))
    ran = run(cut(30, 0, 0), look_up=look_up)
    assert ran.segments.speed.tolist() == pytest.approx([10.0])
    assert not follows(ran, OTHER).any()


@pytest.mark.parametrize(
    "found",
    [
        ModalState(spindle=None, rate=None, note="feedrate is 0"),
        ModalState(spindle=None, rate=Rate(value=0.2, mode=RateMode.PER_REVOLUTION)),
    ],
)
def test_a_cut_without_feed_is_refused(found: ModalState) -> None:
    with pytest.raises(PostError, match="'STEP': a cut without feed"):
        run(cut(30, 0, 0), look_up=lambda _: found)


def test_revolutions_of_a_standing_spindle_are_refused() -> None:
    with pytest.raises(PostError, match="with a stopped spindle"):
        run(SpindleCommand.STOP, Dwell(revolutions=2.0))


def test_the_spindle_turns_when_the_path_begins() -> None:
    assert time(run(Dwell(revolutions=2.0), cut(10, 0, 0))) == pytest.approx(0.1 + 1.0)


def test_usual_motion_is_a_filter_where_axes_are_known() -> None:
    machine = load_machine("vmc15")
    control, limits = usual_motion(machine)
    assert isinstance(control, FilterWithinLimits)
    assert limits.rapid.tolist() == axis_limits(machine).rapid.tolist()


def test_a_machine_without_axes_runs_at_commanded_speed() -> None:
    control, limits = usual_motion(load_machine("paper002"))
    ran = run(cut(30, 0, 0), cut(30, 40, 0), cut(0, 0, 0, feed=None))
    assert motion_of(ran, control, limits).duration == pytest.approx(7.0, rel=1e-6)


def test_runs_at_other_feeds_share_the_lines_of_a_path() -> None:
    def twice(feed: Feed) -> ModalState:
        found = by_time(feed)
        rate = found.rate
        assert rate is not None
        return replace(found, rate=replace(rate, value=2.0 * rate.value))

    shape = PathGeometry(path_of([cut(30, 40, 0), cut(0, 0, 90, feed=None), cut(0, 10, 90)]))
    once, faster = run_of(shape, by_time, SPINDLE), run_of(shape, twice, SPINDLE)
    assert faster.segments.end.tolist() == once.segments.end.tolist()
    fed = ~once.segments.is_rapid
    assert faster.segments.speed[fed] == pytest.approx(2.0 * once.segments.speed[fed])
    alone = run_of(PathGeometry(shape.path), twice, SPINDLE)
    assert faster.segments.speed.tolist() == alone.segments.speed.tolist()
    assert faster.segments.block.tolist() == alone.segments.block.tolist() == [0, 1, 2]
