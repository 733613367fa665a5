"""Reading Klartext."""

from math import pi

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    DrillingCycle,
    Linear,
    MachineType,
    Pause,
    ProgramEnd,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOn,
    ToolChange,
)
from stepnc_model.post.read_heidenhain import HeidenhainReader
from stepnc_model.toolpath.path import ArcPlane, CycleKind
from tests.every_case import every_case


def read(*texts: str) -> list[Block]:
    numbered = [f"{number} {text}" for number, text in enumerate(texts)]
    return list(HeidenhainReader(MachineType.MILL).blocks(numbered))


def test_a_small_program() -> None:
    found = read(
        "BEGIN PGM A MM",
        "; POCKET",
        "TOOL CALL 2 Z S600",
        "M3",
        "L Z+50 R0 FMAX",
        "L X+1 Y-2 FMAX",
        "L Z-5 F60",
        "L X+3 FU0.1",
        "CYCL DEF 9.0 DWELL TIME",
        "CYCL DEF 9.1 DWELL 1.5",
        "M30",
        "END PGM A MM",
    )
    per_revolution = Rate(value=0.1, mode=RateMode.PER_REVOLUTION)
    assert found == [
        Comment(text="POCKET"),
        ToolChange(number=2),
        SpindleOn(speed=10.0),
        Retract(z=50.0),
        Rapid(end=(1.0, -2.0, 50.0)),
        Linear(end=(1.0, -2.0, -5.0), rate=Rate(value=1.0)),
        Linear(end=(3.0, -2.0, -5.0), rate=per_revolution),
        Pause(seconds=1.5),
        ProgramEnd(),
    ]


def test_arcs_in_two_planes() -> None:
    flat, steep = read("CC X+10 Y+0", "C X+20 Y+0 DR- F60", "CC X+20 Z-10", "C X+10 Z-10 DR-")
    assert isinstance(flat, Circular)
    assert isinstance(steep, Circular)
    assert flat.plane is ArcPlane.XY
    assert flat.turn == pytest.approx(-pi)
    assert (steep.plane, steep.end) == (ArcPlane.ZX, (10.0, 0.0, -10.0))
    assert steep.turn == pytest.approx(-0.5 * pi)


def test_a_helix_ends_by_its_angle() -> None:
    (helix,) = read("CC X+10 Y+0", "CP IPA+450 IZ-6 DR+ F60")
    assert isinstance(helix, Circular)
    assert helix.turn == pytest.approx(2.5 * pi)
    assert helix.end == pytest.approx((10.0, -10.0, -6.0))


DRILLING = "CYCL DEF 200 DRILLING Q200=+2 Q201=-10 Q206=+60 Q202=+4 Q203=+1 Q211=+0"


def test_a_cycle_begins_at_its_clearance() -> None:
    way, cycle = read(DRILLING, "CYCL CALL")
    assert way == Rapid(end=(0.0, 0.0, 3.0))
    assert isinstance(cycle, DrillingCycle)
    assert (cycle.kind, cycle.retract_z, cycle.bottom_z) == (CycleKind.PECK, 3.0, -9.0)


def test_a_cycle_goes_on_over_lines() -> None:
    lines = [
        "0 CYCL DEF 207 RIGID TAPPING NEW ~",
        "  Q200=+0 ;SET-UP CLEARANCE ~",
        "  Q201=-10 ;DEPTH ~",
        "  Q239=-1.5 ;PITCH ~",
        "  Q203=+0 ;SURFACE COORDINATE",
        "1 TOOL CALL S300",
        "2 CYCL CALL",
    ]
    assert list(HeidenhainReader(MachineType.MILL).blocks(lines)) == [
        RigidTap(
            start=(0.0, 0.0, 0.0),
            bottom_z=-10.0,
            lead=1.5,
            speed=5.0,
            sense=SpindleDirection.COUNTERCLOCKWISE,
        )
    ]


@every_case(
    ("text", "message"),
    [
        ("FN 0: Q1 = 5", "unknown Klartext block"),
        ("L X+1", "without F"),
        ("L X+1 A+5 FMAX", r"word A\+5: unknown here"),
        ("L X+1 X+2 FMAX", "given twice"),
        ("L X+1 RL FMAX", "word RL"),
        ("C X+1 Y+0 DR+ F60", "without a preceding CC"),
        ("CP IPA+90 DR+ F60", "without a preceding CC"),
        ("CYCL CALL", "CYCL CALL without a defined cycle"),
        ("CYCL DEF 252 CIRCULAR POCKET", "unknown Klartext block"),
        ("M3", "no speed"),
        ("M7", "unknown Klartext block"),
        ("TOOL CALL 1 X S5", "unknown Klartext block"),
        ("L X+1 F60 ~", "no line follows"),
    ],
)
def test_nothing_is_skipped_in_silence(text: str, message: str) -> None:
    with pytest.raises(PostError, match=message) as caught:
        read("BEGIN PGM A MM", text)
    assert caught.value.line == 2


@every_case(
    ("arc", "message"),
    [
        ("C X+1 Y+0 DR+ F60", "radii to its ends are 10.0000 and 9.0000"),
        ("C X+20 Y+0 F60", "without DR"),
        ("C X+20 Y+0 Z+1 DR+ F60", "C leaves the plane of its CC"),
        ("CP IPA-90 DR+ F60", "signs of IPA and DR differ"),
        ("CP PA+90 DR+ F60", "unknown here"),
    ],
)
def test_arcs_that_are_none_are_refused(arc: str, message: str) -> None:
    with pytest.raises(PostError, match=message):
        read("CC X+10 Y+0", arc)


def test_a_cycle_that_lacks_a_parameter_is_refused() -> None:
    with pytest.raises(PostError, match="Q203 Q206 is missing"):
        read("CYCL DEF 200 DRILLING Q200=+2 Q201=-10", "CYCL CALL")


def test_a_block_without_number_is_refused() -> None:
    with pytest.raises(PostError, match="must begin with its number"):
        list(HeidenhainReader(MachineType.MILL).blocks(["L X+1 FMAX"]))


def test_lathes_are_not_read() -> None:
    with pytest.raises(PostError, match="mills only"):
        HeidenhainReader(MachineType.LATHE)
