"""Klartext."""

from math import pi

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    Cycles,
    DrillingCycle,
    Linear,
    MachineType,
    Pause,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOn,
    SpindleOrient,
    ThreadingMove,
    ToolChange,
    expanded,
)
from stepnc_model.post.heidenhain import Heidenhain
from stepnc_model.toolpath.path import Arc, ArcPlane, CycleKind

RATE = Rate(value=5.0)


def lines(*blocks: Block, cycles: Cycles = Cycles.EXPANDED) -> list[str]:
    """Lines after the first, without their numbers."""
    program = [ProgramStart(name="P"), *blocks]
    found = list(Heidenhain().lines(program, cycles))[1:]
    return [line.split(" ", 1)[1] for line in found]


def test_a_program_is_numbered_from_zero_in_its_frame() -> None:
    program: list[Block] = [ProgramStart(name="My part, (1)"), ProgramEnd()]
    assert list(Heidenhain().lines(program, Cycles.EXPANDED)) == [
        "0 BEGIN PGM MY_PART_1 MM",
        "1 M30",
        "2 END PGM MY_PART_1 MM",
    ]


def test_the_speed_stands_in_the_call_of_the_tool() -> None:
    found = lines(
        ToolChange(number=3),
        Comment(text="POCKET"),
        SpindleOn(speed=50.0),
        SpindleOn(speed=20.0, sense=SpindleDirection.COUNTERCLOCKWISE),
    )
    assert found == [
        "; POCKET",
        "TOOL CALL 3 Z S3000",
        "M3",
        "TOOL CALL S1200",
        "M4",
    ]


def test_a_tool_without_speed_is_called_before_it_moves() -> None:
    found = lines(ToolChange(number=3), Retract(z=50.0))
    assert found == ["TOOL CALL 3 Z", "L Z+50 R0 FMAX"]


def test_numbers_are_signed_and_rapid_is_said_in_each_block() -> None:
    found = lines(
        Rapid(end=(1.5, -2.0, 0.0)),
        Linear(end=(1.5, 3.0, 0.0), rate=RATE),
        Linear(end=(2.0, 3.0, 0.0), rate=RATE),
        Rapid(end=(2.0, 3.0, 9.0)),
    )
    assert found == [
        "L X+1.5 Y-2 Z+0 R0 FMAX",
        "L Y+3 F300",
        "L X+2",
        "L Z+9 FMAX",
    ]


def test_feed_per_revolution_is_fu() -> None:
    rate = Rate(value=0.15, mode=RateMode.PER_REVOLUTION)
    assert lines(Linear(end=(1.0, 0.0, 0.0), rate=rate)) == ["L X+1 Y+0 Z+0 R0 FU0.15"]


def test_an_arc_has_its_centre_before_it() -> None:
    arc = Circular(end=(20.0, 0.0, 0.0), arc=Arc(centre=(10.0, 0.0, 0.0), turn=-pi), rate=RATE)
    assert lines(Rapid(end=(0.0, 0.0, 0.0)), arc)[1:] == [
        "CC X+10 Y+0",
        "C X+20 Y+0 DR- F300",
    ]


def test_a_helix_is_polar_with_all_its_turns() -> None:
    helix = Circular(
        end=(20.0, 0.0, -6.0), arc=Arc(centre=(10.0, 0.0, 0.0), turn=7 * pi), rate=RATE
    )
    assert lines(Rapid(end=(0.0, 0.0, 0.0)), helix)[1:] == [
        "CC X+10 Y+0",
        "CP IPA+1260 IZ-6 DR+ F300",
    ]


def test_an_arc_after_a_helix_starts_from_an_exact_point() -> None:
    """The angle of a helix has four decimals; a full circle must meet its start exactly."""
    helix = Circular(
        end=(20.0, 0.0, -6.0), arc=Arc(centre=(10.0, 0.0, 0.0), turn=pi), rate=RATE
    )
    circle = Circular(
        end=(20.0, 0.0, -6.0), arc=Arc(centre=(10.0, 0.0, 0.0), turn=2 * pi), rate=RATE
    )
    assert lines(Rapid(end=(0.0, 0.0, 0.0)), helix, circle)[2:] == [
        "CP IPA+180 IZ-6 DR+ F300",
        "L X+20 Y+0",
        "CC X+10 Y+0",
        "C X+20 Y+0 DR+",
    ]


def test_a_helix_in_another_plane_is_refused() -> None:
    helix = Circular(
        end=(0.0, 5.0, 0.0),
        arc=Arc(centre=(10.0, 0.0, 0.0), turn=2 * pi, plane=ArcPlane.ZX),
        rate=RATE,
    )
    with pytest.raises(PostError, match="in XY only"):
        lines(Rapid(end=(0.0, 0.0, 0.0)), helix)


def test_every_kind_of_coolant_is_m8() -> None:
    mist = Coolant(kinds=frozenset({CoolantKind.MIST}))
    assert lines(mist, Coolant(kinds=frozenset({CoolantKind.FLOOD})), Coolant()) == ["M8", "M9"]


def test_dwell_and_orientation_are_cycles() -> None:
    assert lines(Pause(seconds=1.5), SpindleOrient()) == [
        "CYCL DEF 9.0 DWELL TIME",
        "CYCL DEF 9.1 DWELL 1.5",
        "CYCL DEF 13.0 ORIENTATION",
        "CYCL DEF 13.1 ANGLE 0",
        "M19",
    ]


def test_a_cycle_is_defined_once_and_called_at_each_hole() -> None:
    holes: list[Block] = []
    for x in (1.0, 2.0):
        cycle = DrillingCycle(
            kind=CycleKind.DRILL, at=(x, 0.0), retract_z=2.0, bottom_z=-8.0, rate=RATE
        )
        holes += [Rapid(end=(x, 0.0, 2.0)), expanded(cycle)]
    program = [ProgramStart(name="P"), *holes]
    assert list(Heidenhain().lines(program, Cycles.OWN))[1:] == [
        "1 L X+1 Y+0 Z+2 R0 FMAX",
        "2 CYCL DEF 200 DRILLING ~",
        "  Q200=+0 ;SET-UP CLEARANCE ~",
        "  Q201=-10 ;DEPTH ~",
        "  Q206=+300 ;FEED RATE FOR PLNGNG ~",
        "  Q202=+10 ;PLUNGING DEPTH ~",
        "  Q210=+0 ;DWELL TIME AT TOP ~",
        "  Q203=+2 ;SURFACE COORDINATE ~",
        "  Q204=+0 ;2ND SET-UP CLEARANCE ~",
        "  Q211=+0 ;DWELL TIME AT DEPTH",
        "3 CYCL CALL",
        "4 L X+2 FMAX",
        "5 CYCL CALL",
    ]


def test_a_left_hand_tap_has_a_negative_pitch() -> None:
    tap = RigidTap(
        start=(0.0, 0.0, 5.0),
        bottom_z=-9.0,
        lead=1.5,
        speed=5.0,
        sense=SpindleDirection.COUNTERCLOCKWISE,
    )
    found = lines(tap)
    assert "CYCL DEF 207 RIGID TAPPING NEW ~" in found
    assert " Q239=-1.5 ;PITCH ~" in found


def test_what_a_mill_with_klartext_lacks_is_refused() -> None:
    with pytest.raises(PostError, match="Threading"):
        lines(ThreadingMove(end=(0.0, 0.0, -5.0), lead=1.0))
    lathe = [ProgramStart(name="L", machine=MachineType.LATHE)]
    with pytest.raises(PostError, match="mills only"):
        list(Heidenhain().lines(lathe, Cycles.EXPANDED))


def test_a_comment_never_carries_a_block_on() -> None:
    assert lines(Comment(text="a ~")) == ["; a -"]
