"""Canonical commands, in the words of NISTIR 6556 and the layout of NIST's own output."""

from math import pi

import pytest

from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    Linear,
    OptionalStopBlock,
    Pause,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
    ToolChange,
)
from stepnc_model.post.canonical import Canonical, commands, synchronised, write
from stepnc_model.toolpath.path import Arc, ArcPlane

RATE = Rate(value=40.0)


def texts(*blocks: Block) -> list[str]:
    return [str(command) for command in commands(blocks)]


def test_lines_are_numbered_in_five_columns() -> None:
    lines = list(write([Rapid(end=(91.9, -13.5, 200.0)), ProgramEnd()]))
    assert lines == [
        "    1 STRAIGHT_TRAVERSE(91.9000, -13.5000, 200.0000)",
        "    2 PROGRAM_END()",
    ]


def test_an_arc_has_its_end_its_centre_its_turns_and_its_height() -> None:
    """As in line 90 of NIST's file: from (77.2, 55) to (70, 55) about (73.6, 55)."""
    found = texts(
        Rapid(end=(77.2, 55.0, -5.9)),
        Circular(
            end=(70.0, 55.0, -5.9), arc=Arc(centre=(73.6, 55.0, 0.0), turn=-pi), rate=RATE
        ),
    )
    assert found[1:] == [
        "SET_FEED_RATE(2400.0000)",
        "SELECT_PLANE(CANON_PLANE_XY)",
        "ARC_FEED(70.0000, 55.0000, 73.6000, 55.0000, -1, -5.9000)",
    ]


def test_an_arc_in_zx_says_z_first() -> None:
    found = texts(
        Rapid(end=(20.0, 0.0, -10.0)),
        Circular(
            end=(30.0, 0.0, -20.0),
            arc=Arc(centre=(20.0, 0.0, -20.0), turn=0.5 * pi, plane=ArcPlane.ZX),
            rate=RATE,
        ),
    )
    assert found[2:] == [
        "SELECT_PLANE(CANON_PLANE_XZ)",
        "ARC_FEED(-20.0000, 30.0000, -20.0000, 20.0000, 1, 0.0000)",
    ]


def test_several_turns_are_counted() -> None:
    end = (0.0, 0.0, -3.0)
    helix = Circular(end=end, arc=Arc(centre=(5.0, 0.0, 0.0), turn=6.0 * pi), rate=RATE)
    assert texts(helix)[-1] == "ARC_FEED(0.0000, 0.0000, 5.0000, 0.0000, 3, -3.0000)"


def test_what_holds_is_said_once() -> None:
    found = texts(
        Linear(end=(1.0, 0.0, 0.0), rate=RATE),
        Linear(end=(2.0, 0.0, 0.0), rate=RATE),
        Linear(end=(3.0, 0.0, 0.0), rate=Rate(value=0.2, mode=RateMode.PER_REVOLUTION)),
    )
    assert [text for text in found if text.startswith("SET")] == [
        "SET_FEED_RATE(2400.0000)",
        "SET_FEED_MODE(1)",
        "SET_FEED_RATE(0.2000)",
    ]


def test_the_spindle_turns_in_rpm() -> None:
    assert texts(SpindleOn(speed=12.0), SpindleOff()) == [
        "SET_SPINDLE_SPEED(720.0000)",
        "START_SPINDLE_CLOCKWISE()",
        "STOP_SPINDLE_TURNING()",
    ]


def test_surface_speed_is_in_metres_per_minute_under_a_limit_in_rpm() -> None:
    block = SurfaceSpeed(speed=2500.0, limit=50.0, sense=SpindleDirection.COUNTERCLOCKWISE)
    assert texts(block, SpindleOn(speed=10.0))[:4] == [
        "SET_SPINDLE_MODE(3000.0000)",
        "SET_SPINDLE_SPEED(150.0000)",
        "START_SPINDLE_COUNTERCLOCKWISE()",
        "SET_SPINDLE_MODE(0.0000)",
    ]


def test_coolant_through_the_tool_counts_as_flood() -> None:
    through, mist = frozenset({CoolantKind.THROUGH}), frozenset({CoolantKind.MIST})
    found = texts(Coolant(kinds=through), Coolant(kinds=mist), Coolant())
    assert found == ["FLOOD_ON()", "FLOOD_OFF()", "MIST_ON()", "MIST_OFF()"]


def test_a_retract_keeps_x_and_y() -> None:
    found = texts(Rapid(end=(1.0, 2.0, 3.0)), Retract(z=50.0))
    assert found[1] == "STRAIGHT_TRAVERSE(1.0000, 2.0000, 50.0000)"


def test_a_tap_is_bound_to_the_spindle() -> None:
    tap = RigidTap(start=(1.0, 2.0, 5.0), bottom_z=-10.0, lead=1.5, speed=5.0)
    assert texts(tap)[2:] == [
        "START_SPEED_FEED_SYNC(1.5000)",
        "RIGID_TAP(1.0000, 2.0000, -10.0000)",
        "STOP_SPEED_FEED_SYNCH()",
    ]


@pytest.mark.parametrize(
    ("block", "text"),
    [
        (Comment(text="a"), "COMMENT(a)"),
        (ToolChange(number=3), "CHANGE_TOOL(3)"),
        (Pause(seconds=0.5), "DWELL(0.5000)"),
        (OptionalStopBlock(), "OPTIONAL_PROGRAM_STOP()"),
        (ProgramStart(name="P"), "COMMENT(P)"),
    ],
)
def test_other_blocks_have_a_command_of_their_own(block: Block, text: str) -> None:
    assert texts(block)[0] == text


def test_the_lead_along_a_taper_is_longer() -> None:
    """3-4-5: 4 mm along z while 3 mm along x are 5 mm of path."""
    assert synchronised((0.0, 0.0, 0.0), (3.0, 0.0, 4.0), 2.0) == pytest.approx(2.5)


def test_a_command_is_a_value() -> None:
    assert Canonical("DWELL", (1.0,)) == Canonical("DWELL", (1.0,))
