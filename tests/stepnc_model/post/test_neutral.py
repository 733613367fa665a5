"""Tool paths as neutral blocks, on paths made by hand."""

from dataclasses import replace
from math import pi

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    DrillingCycle,
    Linear,
    MachineType,
    Message,
    OptionalStopBlock,
    PathControl,
    Pause,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.canonical import commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.path import (
    Arc,
    CannedCycle,
    CycleKind,
    Dwell,
    Feed,
    Function,
    Move,
    MoveType,
    SpindleCommand,
    Step,
    ToolPath,
)
from tests.stepnc_model.post.trace import difference

PART = """ISO-10303-21;
HEADER;
FILE_SCHEMA(('MACHINING_SCHEMA'));
ENDSEC;
DATA;
#1=PROJECT('P',#2,(),$,$,$);
#2=WORKPLAN('W',(),$,$,$);
#10=MILLING_CUTTING_TOOL('MILL 10MM',#11,(),80.,$,$);
#11=ENDMILL(#12,4,.RIGHT.,.F.,$);
#12=MILLING_TOOL_DIMENSION(10.,$,$,22.,0.,$,$);
#13=MILLING_CUTTING_TOOL('DRILL 8MM',#14,(),80.,$,$);
#14=TWIST_DRILL(#15,2,.RIGHT.,.F.,$);
#15=MILLING_TOOL_DIMENSION(8.,$,$,$,$,$,$);
#16=GENERAL_TURNING_TOOL('TURN',150.,32.,$,$,$,#17,.RIGHT.);
#17=CUTTING_EDGE_PROPERTIES($,$,12.,95.,$,80.,(),6.,$);
#30=MILLING_TECHNOLOGY(0.04,.TCP.,$,-20.,$,.F.,.F.,.F.,$);
#31=MILLING_TECHNOLOGY(0.0125,.TCP.,$,-10.,$,.T.,.F.,.F.,$);
#32=MILLING_TECHNOLOGY(0.03,.TCP.,$,0.0,$,.F.,.F.,.F.,$);
#33=TURNING_TECHNOLOGY($,.TCP.,#34,2.,.T.,.F.,.F.,$);
#34=CONST_CUTTING_SPEED(1.5,50.);
#35=MILLING_TECHNOLOGY($,.TCP.,$,-20.,$,.F.,.F.,.F.,$);
#40=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());
ENDSEC;
END-ISO-10303-21;
"""
MILL: Ref[Entity] = Ref(10)
DRILL: Ref[Entity] = Ref(13)
TURN: Ref[Entity] = Ref(16)
CUT: Ref[Entity] = Ref(30)
TAPPING: Ref[Entity] = Ref(31)
STANDING: Ref[Entity] = Ref(32)
TURNING: Ref[Entity] = Ref(33)
FEED = Feed(technology=CUT)


@pytest.fixture(scope="module")
def part() -> Program:
    return Program(Part21File.from_bytes(PART.encode()))


def line(x: float, y: float, z: float, feed: Feed | None = FEED) -> Move:
    return Move(end=(x, y, z), type=MoveType.CONTACT, feed=feed)


def path(*steps: Step, cycles: tuple[CannedCycle, ...] = ()) -> ToolPath:
    """With the mill, from 30 mm above."""
    return ToolPath(
        workingstep=Ref(2),
        id="WS",
        operation_ref=Ref(2),
        tool_ref=MILL,
        technology_ref=CUT,
        functions_ref=Ref(40),
        is_turning=False,
        start=(5.0, 5.0, 30.0),
        steps=steps,
        cycles=cycles,
    )


def blocks(part: Program, *paths: ToolPath | Function) -> list[Block]:
    return list(blocks_of(part, paths, name="PART"))


FLOOD = Coolant(kinds=frozenset({CoolantKind.FLOOD}))
RATE = Rate(value=40.0)


def test_a_whole_program(part: Program) -> None:
    found = blocks(part, path(line(5.0, 5.0, 2.0, None), line(9.0, 5.0, 2.0)))
    assert found == [
        ProgramStart(name="PART"),
        Comment(text="T1 MILL 10MM D10"),
        Comment(text="WS", workingstep="WS"),
        PathControl(tolerance=0.01),
        SpindleOff(),
        ToolChange(number=1, id="MILL 10MM"),
        SpindleOn(speed=20.0),
        FLOOD,
        Retract(z=30.0, is_way=True),
        Rapid(end=(5.0, 5.0, 30.0), is_way=True),
        Rapid(end=(5.0, 5.0, 2.0)),
        Linear(end=(9.0, 5.0, 2.0), rate=RATE),
        Retract(z=30.0, is_way=True),
        SpindleOff(),
        Coolant(),
        ProgramEnd(),
    ]


def test_between_tools_everything_stops_and_the_tool_rises_first(part: Program) -> None:
    one = path(line(9.0, 5.0, 2.0))
    higher = replace(one, tool_ref=DRILL, start=(50.0, 60.0, 80.0))
    found = blocks(part, one, higher)
    at = found.index(ToolChange(number=2, id="DRILL 8MM"))
    assert found[at - 5 : at + 5] == [
        Comment(text="WS", workingstep="WS"),
        PathControl(tolerance=0.01),
        SpindleOff(),
        Coolant(),
        Retract(z=80.0, is_way=True),
        ToolChange(number=2, id="DRILL 8MM"),
        SpindleOn(speed=20.0),
        FLOOD,
        Retract(z=80.0, is_way=True),
        Rapid(end=(50.0, 60.0, 80.0), is_way=True),
    ]


def test_tools_keep_their_numbers(part: Program) -> None:
    one = path()
    other = replace(one, tool_ref=DRILL)
    found = blocks(part, other, one, other)
    numbers = [block.number for block in found if isinstance(block, ToolChange)]
    assert numbers == [1, 2, 1]


def test_the_same_tool_goes_up_across_and_down(part: Program) -> None:
    one = path(line(9.0, 5.0, -2.0))
    low = replace(one, start=(50.0, 60.0, 10.0))
    found = blocks(part, one, low)
    at = len(found) - 1 - found[::-1].index(found[2])
    assert found[at + 2 : at + 5] == [
        Retract(z=30.0, is_way=True),
        Rapid(end=(50.0, 60.0, 30.0), is_way=True),
        Rapid(end=(50.0, 60.0, 10.0), is_way=True),
    ]


def test_a_rapid_movement_takes_whatever_tool_there_is(part: Program) -> None:
    rapid = replace(path(line(0.0, 0.0, 40.0, None)), tool_ref=None, technology_ref=None)
    found = blocks(part, path(), replace(rapid, functions_ref=None))
    assert len([block for block in found if isinstance(block, ToolChange)]) == 1
    assert found[-5] == Rapid(end=(0.0, 0.0, 40.0))


def test_arcs_and_dwells(part: Program) -> None:
    arc = Arc(centre=(5.0, 0.0, 0.0), turn=pi)
    bend = Move(end=(5.0, -5.0, 30.0), type=MoveType.CONTACT, feed=FEED, arc=arc)
    found = blocks(part, path(bend, Dwell(seconds=0.5), Dwell(revolutions=5.0)))
    assert found[10:13] == [
        Circular(end=(5.0, -5.0, 30.0), arc=Arc(centre=(5.0, 0.0, 0.0), turn=pi), rate=RATE),
        Pause(seconds=0.5),
        Pause(seconds=0.25),
    ]


def test_the_spindle_does_what_the_path_says(part: Program) -> None:
    reverse = SpindleOn(speed=20.0, sense=SpindleDirection.COUNTERCLOCKWISE)
    found = blocks(
        part,
        path(
            SpindleCommand.REVERSE,
            line(9.0, 5.0, 2.0),
            SpindleCommand.STOP,
            SpindleCommand.ORIENT,
            line(9.0, 5.0, 1.0),
            SpindleCommand.START,
        ),
    )
    assert found[10:16] == [
        reverse,
        Linear(end=(9.0, 5.0, 2.0), rate=RATE),
        SpindleOff(),
        SpindleOrient(),
        Linear(end=(9.0, 5.0, 1.0), rate=RATE),
        SpindleOn(speed=20.0),
    ]


def test_a_speed_of_zero_stops_the_spindle_and_says_so(part: Program) -> None:
    found = blocks(part, path(line(9.0, 5.0, 2.0, Feed(technology=STANDING))))
    at = found.index(Linear(end=(9.0, 5.0, 2.0), rate=Rate(value=30.0)))
    text = "#32 MILLING_TECHNOLOGY: spindle speed 0: the spindle is stopped"
    assert found[at - 2 : at] == [Comment(text=text), SpindleOff()]


def test_a_cut_without_feed_is_refused_with_its_workingstep(part: Program) -> None:
    with pytest.raises(PostError, match=r"'WS': a cut has no feed: .*#35 MILLING_TECHNOLOGY"):
        blocks(part, path(line(9.0, 5.0, 2.0, Feed(technology=Ref(35)))))


def test_a_rapid_needs_no_feed(part: Program) -> None:
    found = blocks(part, replace(path(line(0.0, 0.0, 9.0, None)), technology_ref=Ref(35)))
    assert SpindleOn(speed=20.0) in found


def drilled(kind: CycleKind, *, feed: Feed = FEED) -> ToolPath:
    steps = (line(5.0, 5.0, 2.0, None), line(5.0, 5.0, -9.0, feed), line(5.0, 5.0, 2.0, None))
    cycle = CannedCycle(kind=kind, first=1, last=2, retract_z=2.0, bottom_z=-9.0, feed=feed)
    return path(*steps, line(7.0, 5.0, 2.0), cycles=(cycle,))


def test_a_cycle_carries_what_it_stands_for(part: Program) -> None:
    cycle = blocks(part, drilled(CycleKind.DRILL))[11]
    assert isinstance(cycle, DrillingCycle)
    assert (cycle.at, cycle.retract_z, cycle.bottom_z) == ((5.0, 5.0), 2.0, -9.0)
    assert cycle.expansion == (
        Linear(end=(5.0, 5.0, -9.0), rate=RATE),
        Rapid(end=(5.0, 5.0, 2.0)),
    )


def test_a_tap_is_one_block_and_the_spindle_starts_anew(part: Program) -> None:
    """12.5 mm/s at 10 rev/s."""
    found = blocks(
        part, drilled(CycleKind.TAP, feed=Feed(technology=TAPPING, is_synchronised=True))
    )
    tap = RigidTap(start=(5.0, 5.0, 2.0), bottom_z=-9.0, lead=1.25, speed=10.0)
    at = found.index(tap)
    assert found[at - 1] == SpindleOn(speed=10.0)
    assert found[at + 1] == SpindleOn(speed=20.0)


def test_functions_stand_between_workingsteps(part: Program) -> None:
    def function(keyword: str, text: str = "") -> Function:
        return Function(ref=Ref(2), keyword=keyword, id="F", text=text)

    found = blocks(
        part,
        path(),
        function("OPTIONAL_STOP"),
        path(),
        function("DISPLAY_MESSAGE", "turn it"),
        function("EXCHANGE_PALLET"),
    )
    at = found.index(OptionalStopBlock())
    assert found[at - 3 : at + 5] == [
        Comment(text="F"),
        SpindleOff(),
        Coolant(),
        OptionalStopBlock(),
        Comment(text="WS", workingstep="WS"),
        PathControl(tolerance=0.01),
        SpindleOn(speed=20.0),
        FLOOD,
    ]
    assert Message(text="turn it") in found
    assert Comment(text="EXCHANGE_PALLET is not supported") in found


def test_threads_of_a_lathe_keep_their_speed(part: Program) -> None:
    """1500 mm/s on a radius of 15 mm: 15.915 rev/s; the second pass keeps it."""
    feed = Feed(technology=TURNING, is_synchronised=True)
    steps = [
        line(x, 0.0, z, feed if z < 0.0 else None) for x in (15.0, 14.5) for z in (2.0, -20.0)
    ]
    turned = replace(
        path(*steps),
        is_turning=True,
        tool_ref=TURN,
        technology_ref=TURNING,
        functions_ref=None,
        start=(35.0, 0.0, 10.0),
    )
    found = blocks(part, turned)
    assert found[0] == ProgramStart(name="PART", machine=MachineType.LATHE)
    assert SurfaceSpeed(speed=1500.0, limit=50.0) in found
    speeds = [block.speed for block in found if isinstance(block, SpindleOn)]
    assert speeds == [pytest.approx(1500.0 / (30.0 * pi))]
    assert [b.lead for b in found if isinstance(b, ThreadingMove)] == [2.0, 2.0]


@pytest.mark.parametrize("control", Dialect)
def test_every_control_means_the_same(part: Program, control: Dialect) -> None:
    tap = Feed(technology=TAPPING, is_synchronised=True)
    paths = [
        path(line(9.0, 5.0, 2.0)),
        drilled(CycleKind.DRILL),
        drilled(CycleKind.TAP, feed=tap),
    ]
    found = blocks(part, *paths, replace(paths[0], tool_ref=DRILL))
    back = read(write(found, control), control)
    assert difference(commands(found), back) == ""


def test_no_paths_make_an_empty_program(part: Program) -> None:
    assert blocks(part) == [ProgramStart(name="PART"), SpindleOff(), ProgramEnd()]
