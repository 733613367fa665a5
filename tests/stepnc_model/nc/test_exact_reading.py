"""Exact reading: a word that is not understood ends it, with its line."""

from math import pi

import pytest

from stepnc_model.errors import PostError
from stepnc_model.nc.exact_reading import read, read_blocks, read_exactly
from stepnc_model.nc.neutral_blocks import UNKNOWN, stream_blocks
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    Linear,
    MachineType,
    Message,
    OptionalStopBlock,
    Pause,
    ProgramEnd,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    ToolChange,
)
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import ArcPlane
from tests.every_case import every_case

MILL, LATHE = MachineType.MILL, MachineType.LATHE


def blocks(
    *lines: str, control: Dialect = Dialect.LINUXCNC, machine: MachineType = MILL
) -> list[Block]:
    return list(read_blocks(lines, control, machine=machine))


@every_case(
    ("line", "message"),
    [
        ("G123", "G123 is not known"),
        ("X1", "which motion is in force is not known"),
        ("G1 X1", "no feed in force"),
        ("G0 G1 X1 F1", "two motions"),
        ("G2 X1 Y0 I5 J0 F1", "the arc does not fit its ends"),
        ("G2 X1 Y0 F1", "the arc does not fit its ends"),
        ("G2 X0 Y0 R5 F1", "the arc does not fit its ends"),
        ("G0 X1 E5", "E: not used"),
        ("G0 X1 I5", "I: not used"),
        ("G2 X0 Y0 I5 K1 F1", "K: not used"),
        ("G0 X1 X2", "'X2' is no word"),
        ("G4", "a dwell without its time"),
        ("M3", "without a speed S"),
        ("M6", "without a tool number T"),
        ("T1.5 M6", "whole numbers"),
        ("G81 X0 Y0 F1", "without Z and R"),
        ("G83 Z-1 R1 F1", "without Q"),
        ("G18 G81 Z-1 R1 F1", "outside the XY plane"),
        ("G33.1 Z-1 K1", "a thread whose lead is not known"),
        ("G1 X#<none> F1", "not known"),
        ("M60", "M60 is not known"),
        ("G41 D1 G1 X9 F1", "cutter radius compensation"),
        ("G53 G0 X9", "coordinates of the machine"),
        ("/G0 X9", "the operator may skip"),
        ("G0 X9 A5", "another axis"),
        ("G55 G0 X9", "another frame than G54"),
        ("G92 X5", "another frame than G54"),
        ("o1 if [#<none> gt 0]", "not evaluated"),
        ("(open", "a comment without its end"),
    ],
)
def test_nothing_is_skipped_in_silence(line: str, message: str) -> None:
    with pytest.raises(PostError, match=message) as caught:
        blocks("G21 (fine)", line, "G0 X20")
    assert caught.value.line in {2, 3}


def test_units_distances_and_subprograms_are_understood() -> None:
    found = blocks("G20 G91", "G0 X1", "X1", "o1 sub", "G1 X-1 F10", "o1 endsub", "o1 call")
    assert [each.end[0] for each in found if isinstance(each, (Rapid, Linear))] == [
        pytest.approx(25.4),
        pytest.approx(50.8),
        pytest.approx(25.4),
    ]


def test_switches_stand_in_the_order_of_the_program() -> None:
    found = blocks("(MSG,go)", "T3 M6 (tool)", "S600 M3", "M7", "M8", "G4 P.5", "M0", "M1",
                   "M9", "M19", "M5", "M2")  # fmt: skip
    assert found == [
        Message(text="go"),
        Comment(text="tool"),
        ToolChange(number=3),
        SpindleOn(speed=10.0),
        Coolant(kinds=frozenset({CoolantKind.MIST})),
        Coolant(kinds=frozenset({CoolantKind.MIST, CoolantKind.FLOOD})),
        Pause(seconds=0.5),
        ProgramStopBlock(),
        OptionalStopBlock(),
        Coolant(),
        SpindleOrient(),
        SpindleOff(),
        ProgramEnd(),
    ]


def test_a_change_of_tools_stops_the_spindle_until_it_is_started() -> None:
    found = blocks("T1 M6", "S600 M3", "T2 M6", "S900", "M3")
    assert [each.speed for each in found if isinstance(each, SpindleOn)] == [10.0, 15.0]


def test_the_place_is_kept_through_changes_of_the_tool() -> None:
    found = blocks("G0 X1 Y2 Z3", "T1 M6", "G43 H1", "X5")
    assert found[-1] == Rapid(end=(5.0, 2.0, 3.0))


def test_an_unknown_place_is_reached_by_the_first_rapids() -> None:
    code = b"G21 G90\nG0 Z50\nX1 Y2\nG1 Z0 F60\n"
    program = read_exactly(code, Dialect.LINUXCNC, machine=MILL, start=UNKNOWN)
    rate = Rate(value=1.0)
    assert [block for _, block in stream_blocks(program)] == [
        Retract(z=50.0),
        Rapid(end=(1.0, 2.0, 50.0)),
        Linear(end=(1.0, 2.0, 0.0), rate=rate),
    ]
    with pytest.raises(PostError, match="line 2: a move whose start or end is not known"):
        read_exactly(b"G21 G90\nG1 X5 F60\n", Dialect.LINUXCNC, machine=MILL, start=UNKNOWN)


def test_p_counts_the_turns() -> None:
    (arc,) = blocks("G3 X0 Y0 Z-3 I5 J0 P3 F60")
    assert isinstance(arc, Circular)
    assert arc.arc.turn == pytest.approx(6.0 * pi)


def test_a_cycle_dwells_and_stops_the_spindle() -> None:
    found = blocks("S600 M3", "G0 Z5", "G98 G86 X1 Y1 Z-5 R2 P.5 F60")
    assert found[-5:] == [
        Pause(seconds=0.5),
        SpindleOff(),
        Rapid(end=(1.0, 1.0, 2.0)),
        SpindleOn(speed=10.0),
        Rapid(end=(1.0, 1.0, 5.0)),
    ]


@every_case(
    ("control", "word", "seconds"),
    [
        (Dialect.HAAS, "P2.", 2.0),
        (Dialect.HAAS, "P500", 0.5),
        (Dialect.FANUC, "P500", 0.5),
        (Dialect.SINUMERIK, "F.5", 0.5),
    ],
)
def test_a_dwell_is_as_the_control_counts(control: Dialect, word: str, seconds: float) -> None:
    assert blocks(f"G4 {word}", control=control) == [Pause(seconds=seconds)]


@every_case(
    ("code", "sense"),
    [("G84", SpindleDirection.CLOCKWISE), ("G74", SpindleDirection.COUNTERCLOCKWISE)],
)
def test_a_tap_turns_as_its_code_says(code: str, sense: SpindleDirection) -> None:
    found = blocks("M29 S300", f"G95 {code} X1. Y2. Z-9. R2. F1.5", control=Dialect.FANUC)
    assert found[-1] == RigidTap(
        start=(1.0, 2.0, 2.0), bottom_z=-9.0, lead=1.5, speed=5.0, sense=sense
    )


def test_the_same_code_means_other_things_on_a_lathe() -> None:
    """G99 is the mode per revolution there, and X a diameter."""
    turned = blocks(
        "T0303", "G97 S600 M3", "G99", "G1 X20. Z-5. F0.2", control=Dialect.FANUC, machine=LATHE
    )
    rate = Rate(value=0.2, mode=RateMode.PER_REVOLUTION)
    assert turned == [
        ToolChange(number=3),
        SpindleOn(speed=10.0),
        Linear(end=(10.0, 0.0, -5.0), rate=rate),
    ]
    with pytest.raises(PostError, match="Y: not used"):
        blocks("G0 X1. Y1.", control=Dialect.FANUC, machine=LATHE)


def test_diameters_are_halved_whatever_the_machine_was_taken_for() -> None:
    found = blocks("G7 G18", "G0 X20 Z0", "G1 X30.0 Z-5.0 F60")
    assert [each.end[0] for each in found if isinstance(each, (Rapid, Linear))] == [10.0, 15.0]


@every_case(
    ("lines", "message"),
    [
        (["CYCLE81(5,5,0,-10,,3)"], "argument 6, 3, is not read"),
        (["CYCLE83(5,5,0,-10,,-4,3,0,0,0,1,1)"], "argument 6, -4, is not read"),
        (["CYCLE83(5,5,0,-10,,,3,0,0,0,0.5,1)"], "argument 11, 0.5, is not read"),
        (["CYCLE85(5,5,0,-10,,0,90,90)"], "feeds other than the one in force"),
        (["CYCLE81(5,5)"], "needs RTP, RFP, SDIS and DP"),
        (["G0 X1 TURN=2"], "TURN: not used"),
        (["SPOS=90"], "angles other than 0"),
        (["SUBPROGRAM_7"], "is not known"),
    ],
)
def test_words_of_sinumerik_are_not_skipped(lines: list[str], message: str) -> None:
    with pytest.raises(PostError, match=message):
        blocks("G94 F100", "S500 M3", "G0 X0 Y0 Z5", *lines, control=Dialect.SINUMERIK)


def test_a_retract_plane_above_is_reached_after_the_cycle() -> None:
    found = blocks("G0 X1 Y1 Z5", "F60", "CYCLE81(20,0,2,-9)", control=Dialect.SINUMERIK)
    assert found[-1] == Rapid(end=(1.0, 1.0, 20.0))


def test_messages_and_angles_of_sinumerik() -> None:
    found = blocks('N10 MSG("hello")', "; a", "SPOS=0", control=Dialect.SINUMERIK)
    assert found == [Message(text="hello"), Comment(text="a"), SpindleOrient()]


def klartext(*texts: str) -> list[Block]:
    return blocks(
        *(f"{number} {text}" for number, text in enumerate(texts)), control=Dialect.HEIDENHAIN
    )


def test_a_small_program_of_klartext() -> None:
    found = klartext(
        "BEGIN PGM A_1-B MM",
        "; POCKET",
        "TOOL CALL 2 Z S600",
        "M3",
        "M8",
        "L Z+50 R0 FMAX",
        "L X+1 Y-2 FMAX",
        "L Z-5 F60",
        "L X+3 FU0.1",
        "CYCL DEF 9.0 DWELL TIME",
        "CYCL DEF 9.1 DWELL 1.5",
        "STOP",
        "M30",
        "END PGM A_1-B MM",
    )
    per_revolution = Rate(value=0.1, mode=RateMode.PER_REVOLUTION)
    assert found == [
        Comment(text="POCKET"),
        ToolChange(number=2),
        SpindleOn(speed=10.0),
        Coolant(kinds=frozenset({CoolantKind.FLOOD})),
        Rapid(end=(0.0, 0.0, 50.0)),
        Rapid(end=(1.0, -2.0, 50.0)),
        Linear(end=(1.0, -2.0, -5.0), rate=Rate(value=1.0)),
        Linear(end=(3.0, -2.0, -5.0), rate=per_revolution),
        Pause(seconds=1.5),
        ProgramStopBlock(),
        ProgramEnd(),
    ]


def test_arcs_of_klartext_in_two_planes() -> None:
    flat, steep = klartext(
        "CC X+10 Y+0", "C X+20 Y+0 DR- F60", "CC X+20 Z-10", "C X+10 Z-10 DR-"
    )
    assert isinstance(flat, Circular)
    assert isinstance(steep, Circular)
    assert flat.arc.plane is ArcPlane.XY
    assert flat.arc.turn == pytest.approx(-pi)
    assert (steep.arc.plane, steep.end) == (ArcPlane.ZX, (10.0, 0.0, -10.0))


def test_a_pitch_below_0_cuts_a_left_hand_thread() -> None:
    lines = [
        "0 CYCL DEF 207 RIGID TAPPING NEW ~",
        "  Q200=+0 ;SET-UP CLEARANCE ~",
        "  Q201=-10 ;DEPTH ~",
        "  Q239=-1.5 ;PITCH ~",
        "  Q203=+0 ;SURFACE COORDINATE",
        "1 TOOL CALL S300",
        "2 CYCL CALL",
    ]
    assert blocks(*lines, control=Dialect.HEIDENHAIN)[-1] == RigidTap(
        start=(0.0, 0.0, 0.0),
        bottom_z=-10.0,
        lead=1.5,
        speed=5.0,
        sense=SpindleDirection.COUNTERCLOCKWISE,
    )


@every_case(
    ("text", "message"),
    [
        ("L X+1", "no feed in force"),
        ("L X+1 A+5 FMAX", "another axis"),
        ("L X+1 RL F60", "cutter radius compensation"),
        ("L X+1 FOO FMAX", "FOO: not used"),
        ("C X+1 Y+0 DR+ F60", "an arc without its centre"),
        ("CP IPA+90 DR+ F60", "a polar arc without IPA"),
        ("CYCL CALL", "not expanded"),
        ("APPR LT X+1", "not expanded"),
        ("M3", "without a speed S"),
        ("M7", "M7 is not known"),
        ("TOOL CALL 1 Z S5 DL+1", "a wear of the tool's length"),
    ],
)
def test_words_of_klartext_are_not_skipped(text: str, message: str) -> None:
    with pytest.raises(PostError, match=message) as caught:
        klartext("BEGIN PGM A MM", text, "L Z+5 FMAX")
    assert caught.value.line in {2, 3}


def test_lathes_are_not_read_in_klartext() -> None:
    with pytest.raises(PostError, match="mills only"):
        read_blocks([], Dialect.HEIDENHAIN, machine=LATHE)


def test_canonical_commands_are_read_as_themselves() -> None:
    (found,) = read(["    1 STRAIGHT_FEED(1.0, 2.0, 3.0)"], Dialect.CANONICAL)
    assert found.arguments == (1.0, 2.0, 3.0)
