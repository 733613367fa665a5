"""Reading G-code, by LinuxCNC's and Fanuc's readers: strict, with line and word."""

from math import pi

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Coolant,
    CoolantKind,
    DrillingCycle,
    Linear,
    MachineType,
    Pause,
    ProgramEnd,
    Rapid,
    Rate,
    RateMode,
    Retract,
    SpindleOff,
    SpindleOn,
    ToolChange,
)
from stepnc_model.post.fanuc import FanucReader
from stepnc_model.post.linuxcnc import LinuxCncReader, along_path
from stepnc_model.toolpath.path import ArcPlane, CycleKind
from tests.every_case import every_case


def read(*lines: str) -> list[Block]:
    return list(LinuxCncReader(MachineType.MILL).blocks(lines))


@every_case(
    ("line", "message"),
    [
        ("G123", "G123: unknown"),
        ("G91", "G91: unknown"),
        ("G20", "G20: unknown"),
        ("M98 P1", "P1: not used"),
        ("M99", "M99: unknown"),
        ("X1", "no motion"),
        ("G1 X1", "without F"),
        ("G0 G1 X1 F1", "two motions"),
        ("G2 X1 Y0 I5 J0 F1", r"invalid arc: the radii to its ends are 5.0000 and 4.0000 mm"),
        ("G2 X1 Y0 F1", "invalid arc"),
        ("G2 X0 Y0 R5 F1", "invalid arc"),
        ("G0 X1 E5", "E5: not used"),
        ("G0 X1 X2", "X appears twice"),
        ("G4", "P is missing"),
        ("M3", "without a speed"),
        ("M6", "T is missing"),
        ("T1.5 M6", "whole number"),
        ("G81 X0 Y0 F1", "without Z or R"),
        ("G83 Z-1 R1 F1", "without Q"),
        ("G81 Z1 R0 F1", "below"),
        ("G18 G81 Z-1 R1 F1", "plane ZX"),
        ("G33.1 Z-1 K1", "is stopped"),
        ("#1=5", "not a word"),
        ("IF [1 EQ 1] GOTO 5", "not a word"),
        ("(open", "not a word"),
    ],
)
def test_nothing_is_skipped_in_silence(line: str, message: str) -> None:
    with pytest.raises(PostError, match=message) as caught:
        read("G21 (fine)", line)
    assert caught.value.line == 2


def test_a_refusal_names_line_word_and_machine() -> None:
    with pytest.raises(PostError) as caught:
        read("G21 (fine)", "G123")
    assert str(caught.value) == "line 2: word G123: unknown G code on this mill"


def test_frames_numbers_and_comments_are_no_words() -> None:
    found = read("%", "(NAME)", "N10 G0 Z5 (up)", "", "%")
    assert [type(block).__name__ for block in found] == ["Comment", "Comment", "Retract"]
    assert found[2] == Retract(z=5.0)


def test_motion_and_feed_hold() -> None:
    found = read("G0 X1 Y2 Z3", "G1 Z-1 F60", "X5")
    rate = Rate(value=1.0)
    assert found == [
        Rapid(end=(1.0, 2.0, 3.0)),
        Linear(end=(1.0, 2.0, -1.0), rate=rate),
        Linear(end=(5.0, 2.0, -1.0), rate=rate),
    ]


def test_a_new_mode_needs_a_new_feed() -> None:
    with pytest.raises(PostError, match="without F"):
        read("G1 X1 F60", "G95 X2")
    (_, line) = read("G1 X1 F60", "G95 X2 F.1")
    assert isinstance(line, Linear)
    assert line.rate == Rate(value=0.1, mode=RateMode.PER_REVOLUTION)


def test_a_quarter_from_zero() -> None:
    (arc,) = read("G2 X10 Y10 I10 J0 F60")
    assert isinstance(arc, Circular)
    assert (arc.centre, arc.plane) == ((10.0, 0.0, 0.0), ArcPlane.XY)
    assert arc.turn == pytest.approx(-0.5 * pi)


def test_p_counts_the_turns() -> None:
    (arc,) = read("G3 X0 Y0 Z-3 I5 J0 P3 F60")
    assert isinstance(arc, Circular)
    assert arc.turn == pytest.approx(6.0 * pi)


def test_switches() -> None:
    found = read("T3 M6", "S600 M3", "M8", "M9", "G4 P.5", "M5", "M2")
    assert found == [
        ToolChange(number=3),
        SpindleOn(speed=10.0),
        Coolant(kinds=frozenset({CoolantKind.FLOOD})),
        Coolant(),
        Pause(seconds=0.5),
        SpindleOff(),
        ProgramEnd(),
    ]


def test_a_cycle_repeats_at_new_positions() -> None:
    found = read("G0 Z5", "G99 G81 X1 Y1 Z-5 R2 F60", "X3", "G80", "G0 X9")
    cycles = [block for block in found if isinstance(block, DrillingCycle)]
    assert [cycle.at for cycle in cycles] == [(1.0, 1.0), (3.0, 1.0)]
    assert {(c.kind, c.retract_z, c.bottom_z) for c in cycles} == {(CycleKind.DRILL, 2.0, -5.0)}
    assert found[-1] == Rapid(end=(9.0, 1.0, 2.0))


def test_g98_returns_to_where_the_cycle_began() -> None:
    assert read("G0 Z5", "G98 G81 X1 Y1 Z-5 R2 F60")[-1] == Retract(z=5.0)


def test_a_repeated_cycle_keeps_its_pecks() -> None:
    found = read("G0 Z5", "G99 G83 X1 Y1 Z-5 R2 Q3 F60", "X3")
    assert [b.step_depth for b in found if isinstance(b, DrillingCycle)] == [3.0, 3.0]


def test_the_same_code_means_other_things_on_a_lathe() -> None:
    """G99 is the mode per revolution there, and X a diameter."""
    found = list(FanucReader(MachineType.LATHE).blocks(["G99", "G1 X20. Z-5. F0.2"]))
    rate = Rate(value=0.2, mode=RateMode.PER_REVOLUTION)
    assert found == [Linear(end=(10.0, 0.0, -5.0), rate=rate)]
    with pytest.raises(PostError, match="G95: unknown G code on this lathe"):
        list(FanucReader(MachineType.LATHE).blocks(["G95"]))


def test_a_lathe_has_no_y() -> None:
    with pytest.raises(PostError, match="Y1: not used"):
        list(FanucReader(MachineType.LATHE).blocks(["G0 X1. Y1."]))


def test_a_lead_along_the_path_is_shorter_along_an_axis() -> None:
    """3-4-5: 5 mm of path while z moves 4 mm."""
    assert along_path((0.0, 0.0, 0.0), (3.0, 0.0, 4.0), 2.5) == pytest.approx(2.0)
