"""Neutral blocks as acts of the machine."""

from collections.abc import Iterable
from dataclasses import replace
from math import dist, pi
from pathlib import Path

import numpy as np
import pytest

from simulator.errors import ProgramFault
from simulator.machine import interpreter
from simulator.machine.acts import (
    CoolantTo,
    EndOfProgram,
    MoveStretch,
    PathControlTo,
    ProgramAct,
    SpindleReached,
    SpindleTo,
    Stop,
    ToolTo,
    Wait,
    WorkingstepTo,
)
from simulator.machine.interpreter import interpret
from simulator.spec import Machine
from stepnc_model.post import blocks as nc
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import Arc, ArcPlane, CycleKind, ToolPath
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"

FEED = nc.Rate(value=20.0)
PER_REVOLUTION = nc.Rate(value=0.2, mode=nc.RateMode.PER_REVOLUTION)
SURFACE = nc.SurfaceSpeed(speed=3000.0)
HOME = nc.Rapid(end=(0.0, 0.0, 50.0))
Blocks = list[nc.Block]


def steps(machine: Machine, *blocks: nc.Block) -> list[ProgramAct]:
    return list(interpret(enumerate(blocks, 1), machine))


def stretches(found: Iterable[ProgramAct]) -> list[MoveStretch]:
    return [step.act for step in found if isinstance(step.act, MoveStretch)]


def kinds(found: Iterable[ProgramAct]) -> list[type]:
    return [type(step.act) for step in found]


def seconds(parts: Iterable[MoveStretch]) -> float:
    """Time of the feeds at commanded speed."""
    feeds = [part.segments[~part.segments.is_rapid] for part in parts]
    return sum(float((feed.length / feed.speed).sum()) for feed in feeds)


def test_the_usual_line_is_collected_as_any_other(
    mill: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = [(1.0, 2.0, 3.0), (4.0, 2.0, 3.0), (4.0, 2.0, 3.0), (4.0, 0.0, -1.0)]
    rates = (FEED, PER_REVOLUTION, FEED, FEED)
    program: list[nc.Block] = [
        nc.SpindleOn(speed=10.0, sense=nc.SpindleDirection.CLOCKWISE),
        HOME,
        *(nc.Linear(end=end, rate=rate) for end, rate in zip(ends, rates, strict=True)),
    ]
    short = steps(mill, *program)
    monkeypatch.setattr(interpreter._Interpreter, "_goes_on", lambda _self, _block: False)
    long = steps(mill, *program)
    assert kinds(short) == kinds(long)
    for one, other in zip(stretches(short), stretches(long), strict=True):
        assert one.segments.start.tolist() == other.segments.start.tolist()
        assert one.segments.end.tolist() == other.segments.end.tolist()
        assert one.segments.speed.tolist() == other.segments.speed.tolist()
        assert one.segments.block.tolist() == other.segments.block.tolist()
        assert np.array_equal(one.per_revolution, other.per_revolution, equal_nan=True)
    assert [len(each.segments) for each in stretches(short)] == [3]


@every_case(
    ("block", "acts"),
    [
        (nc.ProgramStart(name="a"), []),
        (nc.Comment(text="x"), []),
        (nc.Comment(text="x", workingstep="face"), [WorkingstepTo(id="face")]),
        (nc.Message(text="x"), []),
        (nc.ToolChange(number=3), [ToolTo(number=3)]),
        (nc.SpindleOn(speed=10.0), [SpindleTo(speed=10.0)]),
        (
            nc.SpindleOn(speed=10.0, sense=nc.SpindleDirection.COUNTERCLOCKWISE),
            [SpindleTo(speed=-10.0)],
        ),
        (SURFACE, []),
        (nc.SpindleOff(), []),
        (nc.SpindleOrient(), []),
        (nc.Coolant(), [CoolantTo()]),
        (nc.Retract(z=10.0), []),
        (HOME, []),
        (nc.Linear(end=(0.0, 0.0, 0.0), rate=FEED), []),
        (nc.Pause(seconds=2.5), [Wait(seconds=2.5)]),
        (nc.ProgramStopBlock(), [Stop()]),
        (nc.OptionalStopBlock(), []),
        (nc.ProgramEnd(), [EndOfProgram()]),
    ],
)
def test_first_block_of_a_program(mill: Machine, block: nc.Block, acts: list[object]) -> None:
    assert [step.act for step in steps(mill, block)] == acts


def test_moves_that_follow_each_other_are_one_stretch(mill: Machine) -> None:
    found = steps(
        mill,
        nc.SpindleOn(speed=10.0),
        HOME,
        nc.Rapid(end=(0.0, 0.0, 1.0)),
        nc.Linear(end=(0.0, 0.0, -1.0), rate=FEED),
        nc.Linear(end=(30.0, 40.0, -1.0), rate=FEED),
        nc.Pause(seconds=1.0),
        nc.Rapid(end=(30.0, 40.0, 50.0)),
    )
    assert kinds(found) == [
        SpindleTo,
        MoveStretch,
        SpindleReached,
        MoveStretch,
        Wait,
        MoveStretch,
    ]
    rapid, feed, up = (part.segments for part in stretches(found))
    assert rapid.is_rapid.all()
    assert rapid.block.tolist() == [3]
    assert feed.block.tolist() == [4, 5]
    assert feed.speed.tolist() == [20.0, 20.0]
    assert feed.length.tolist() == [2.0, 50.0]
    assert up.start[0].tolist() == [30.0, 40.0, -1.0]


def test_only_a_feed_waits_for_the_spindle_and_only_once(mill: Machine) -> None:
    turn: Blocks = [nc.SpindleOn(speed=10.0), nc.SpindleOn(speed=10.0), HOME]
    feeds: Blocks = [nc.Linear(end=(x, 0.0, 50.0), rate=FEED) for x in (1.0, 2.0)]
    found = steps(mill, *turn, nc.Rapid(end=(0.0, 0.0, 60.0)), HOME, *feeds)
    assert kinds(found) == [SpindleTo, MoveStretch, SpindleReached, MoveStretch]
    stopped = steps(mill, *turn, nc.SpindleOff(), *feeds)
    assert kinds(stopped) == [SpindleTo, SpindleTo, SpindleReached, MoveStretch]


def test_feed_per_revolution_is_times_the_speed_that_the_spindle_has(mill: Machine) -> None:
    end = (30.0, 0.0, 50.0)
    for told, has in ((10.0, 10.0), (1000.0, 200.0)):
        found = steps(
            mill, HOME, nc.SpindleOn(speed=told), nc.Linear(end=end, rate=PER_REVOLUTION)
        )
        assert stretches(found)[0].segments.speed.tolist() == [0.2 * has]


def test_retract_rises_where_the_tool_is(mill: Machine) -> None:
    at = nc.Rapid(end=(7.0, 8.0, 5.0))
    (found,) = stretches(steps(mill, at, nc.Retract(z=60.0)))
    assert found.segments.start.tolist() == [[7.0, 8.0, 5.0]]
    assert found.segments.end.tolist() == [[7.0, 8.0, 60.0]]
    assert found.segments.is_rapid.all()


def test_retract_from_nobody_knows_where_sets_the_height(mill: Machine) -> None:
    (found,) = stretches(steps(mill, nc.Retract(z=60.0), nc.Rapid(end=(7.0, 8.0, 5.0))))
    assert found.segments.start.tolist() == [[7.0, 8.0, 60.0]]


def test_arc_in_every_plane_keeps_centre_turn_and_rise(mill: Machine) -> None:
    for plane, normal in ((ArcPlane.XY, 2), (ArcPlane.ZX, 1), (ArcPlane.YZ, 0)):
        first, second, _ = plane.axes
        start, end = [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]
        start[first] += 5.0
        end[second] += 5.0
        end[normal] += 3.0
        arc = nc.Circular(
            end=(end[0], end[1], end[2]),
            arc=Arc(centre=(1.0, 1.0, 1.0), turn=2.5 * pi, plane=plane),
            rate=FEED,
        )
        begin = nc.Rapid(end=(start[0], start[1], start[2]))
        (found,) = stretches(steps(mill, begin, arc))
        assert found.segments.normal.tolist() == [normal]
        assert found.segments.length[0] == pytest.approx(np.hypot(12.5 * pi, 3.0))
        there = found.segments.position(np.array([0]), found.segments.length)
        np.testing.assert_allclose(there, [end], atol=1e-12)


def test_cycle_is_its_expansion(mill: Machine) -> None:
    down = nc.Linear(end=(0.0, 0.0, -10.0), rate=FEED)
    pause, up = nc.Pause(seconds=0.5), nc.Rapid(end=(0.0, 0.0, 50.0))
    cycle = nc.DrillingCycle(
        kind=CycleKind.DWELL,
        at=(0.0, 0.0),
        retract_z=50.0,
        bottom_z=-10.0,
        rate=FEED,
        dwell=0.5,
        expansion=(down, pause, up),
    )
    found = steps(mill, HOME, cycle)
    assert kinds(found) == [MoveStretch, Wait, MoveStretch]
    assert {int(part.segments.block[0]) for part in stretches(found)} == {2}


def test_rigid_tap_goes_down_and_up_with_the_spindle(mill: Machine) -> None:
    tap = nc.RigidTap(start=(5.0, 5.0, 2.0), bottom_z=-10.0, lead=1.25, speed=8.0)
    found = steps(mill, HOME, nc.SpindleOn(speed=8.0), tap)
    assert kinds(found) == [
        SpindleTo,
        MoveStretch,
        SpindleReached,
        MoveStretch,
        SpindleTo,
        SpindleReached,
        MoveStretch,
        SpindleTo,
    ]
    turns = [step.act.speed for step in found if isinstance(step.act, SpindleTo)]
    assert turns == [8.0, -8.0, 8.0]
    _, down, up = (part.segments for part in stretches(found))
    assert down.speed.tolist() == up.speed.tolist() == [10.0]
    assert down.end.tolist() == up.start.tolist() == [[5.0, 5.0, -10.0]]
    assert up.end.tolist() == [[5.0, 5.0, 2.0]]


def test_thread_moves_a_lead_a_turn_along_the_axis_that_moves_most(lathe: Machine) -> None:
    found = steps(
        lathe,
        nc.Rapid(end=(10.0, 0.0, 0.0)),
        nc.SpindleOn(speed=5.0),
        nc.ThreadingMove(end=(13.0, 0.0, -30.0), lead=1.5),
        nc.ThreadingMove(end=(13.0, 0.0, -30.0), lead=1.5),
    )
    (thread,) = stretches(found)
    assert thread.segments.speed[0] == pytest.approx(7.5 * dist((0, 0), (3, 30)) / 30)


def test_stretches_are_bounded(mill: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpreter, "LONGEST", 10)
    feeds = [nc.Linear(end=(float(x), 0.0, 50.0), rate=FEED) for x in range(1, 36)]
    found = stretches(steps(mill, HOME, *feeds))
    assert [len(part.segments) for part in found] == [10, 10, 10, 5]


def test_nothing_is_read_after_the_end(mill: Machine) -> None:
    found = steps(mill, HOME, nc.ProgramEnd(), nc.Pause(seconds=1.0))
    assert kinds(found) == [EndOfProgram]


def test_blocks_are_read_as_they_are_needed(mill: Machine) -> None:
    def endless() -> Iterable[interpreter.Numbered]:
        line = 0
        while True:
            line += 1
            yield line, nc.Pause(seconds=1.0)

    found = interpret(endless(), mill)
    assert next(iter(found)).act == Wait(seconds=1.0)


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        (
            [HOME, nc.Linear(end=(1.0, 0.0, 0.0), rate=PER_REVOLUTION)],
            r"line 2: feed 0.2 mm/rev: the spindle is stopped",
        ),
        (
            [HOME, nc.Linear(end=(1.0, 0.0, 0.0), rate=nc.Rate(value=0.0))],
            r"line 2: feed 0 mm/s: it must be positive",
        ),
        (
            [HOME, nc.ThreadingMove(end=(1.0, 0.0, 50.0), lead=1.0)],
            r"line 2: feed 1 mm/rev: the spindle is stopped",
        ),
    ],
)
def test_impossible_feed_names_the_line(
    mill: Machine, blocks: list[nc.Block], message: str
) -> None:
    with pytest.raises(ProgramFault, match=message) as caught:
        steps(mill, *blocks)
    assert caught.value.line == 2


def test_surface_speed_at_the_axis_needs_a_limit(lathe: Machine) -> None:
    endless = replace(lathe, spindle=replace(lathe.spindle, max_speed=None))
    blocks: Blocks = [nc.Rapid(end=(10.0, 0.0, 0.0)), SURFACE]
    cut = nc.Linear(end=(5.0, 0.0, 0.0), rate=PER_REVOLUTION)
    assert stretches(steps(endless, *blocks, cut))
    with pytest.raises(ProgramFault, match="line 3: surface speed at x = 0"):
        steps(endless, *blocks, replace(cut, end=(0.0, 0.0, 0.0)))


@pytest.mark.parametrize("name", sorted(path.stem for path in PARTS.glob("*.stpnc")))
def test_feeds_of_a_program_are_as_long_as_its_tool_paths(
    name: str, mill: Machine, lathe: Machine
) -> None:
    program = Program.load(PARTS / f"{name}.stpnc")
    paths = [path for path in generate(program) if isinstance(path, ToolPath)]
    machine = lathe if any(path.is_turning for path in paths) else mill
    blocks = enumerate(blocks_of(program, paths, name=name), 1)
    found = stretches(interpret(blocks, machine))
    fed = sum(float(part.segments.length[~part.segments.is_rapid].sum()) for part in found)
    wanted = sum(
        length(start, move)
        for path in paths
        for start, move in path.segments()
        if move.feed is not None
    )
    assert fed == pytest.approx(wanted, rel=1e-9)


def test_stretches_know_what_waits_for_their_end(mill: Machine) -> None:
    """A tool change, a dwell and the end do; more moves and the spindle do not."""
    found = steps(
        mill,
        HOME,
        nc.Rapid(end=(9.0, 0.0, 50.0)),
        nc.ToolChange(number=1),
        nc.SpindleOn(speed=20.0),
        nc.Rapid(end=(0.0, 0.0, 50.0)),
        nc.Linear(end=(0.0, 0.0, 0.0), rate=FEED),
        nc.Comment(text="WS", workingstep="WS"),
        nc.Rapid(end=(0.0, 0.0, 50.0)),
        nc.Pause(seconds=1.0),
        nc.Rapid(end=(9.0, 0.0, 50.0)),
    )
    ends = [each.is_drained for each in stretches(found)]
    assert ends == [True, False, False, True, True]


def test_path_control_changes_where_it_differs(mill: Machine) -> None:
    fine, coarse = nc.PathControl(tolerance=0.01), nc.PathControl(tolerance=0.05)
    found = steps(mill, fine, HOME, fine, coarse)
    told = [step.act.control for step in found if isinstance(step.act, PathControlTo)]
    assert told == [fine, coarse]
