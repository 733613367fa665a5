"""Fanuc's own ways."""

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Comment,
    Cycles,
    MachineType,
    Pause,
    ProgramStart,
    Rapid,
    RigidTap,
    SpindleDirection,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.fanuc import Fanuc


def lines(machine: MachineType, *blocks: Block) -> list[str]:
    program = [ProgramStart(name="Part", machine=machine), *blocks]
    return list(Fanuc().lines(program, Cycles.EXPANDED))


def test_heads_of_mill_and_lathe() -> None:
    assert lines(MachineType.MILL) == [
        "%",
        "O0001 (PART)",
        "N10 G17 G21 G40 G49 G54 G80 G90 G94",
    ]
    assert lines(MachineType.LATHE)[2] == "N10 G18 G21 G40 G54 G80 G97 G99"


def test_a_comment_has_capitals_and_nothing_that_ends_a_tape() -> None:
    found = lines(MachineType.MILL, Comment(text="Größe 50 %; (fine): x<y"))
    assert found[-1] == "(GROSSE 50    [FINE]  X Y)"


def test_the_length_offset_goes_with_the_first_z() -> None:
    change, move = ToolChange(number=7), Rapid(end=(1.0, 2.0, 50.0))
    assert lines(MachineType.MILL, change, move)[3:] == [
        "N20 T7 M6",
        "N30 G0 G43 H7 X1. Y2. Z50.",
    ]


def test_a_turret_has_tool_and_offset_in_one_word() -> None:
    assert lines(MachineType.LATHE, ToolChange(number=3))[-1] == "N20 T0303"
    with pytest.raises(PostError, match="tool 100"):
        lines(MachineType.LATHE, ToolChange(number=100))


def test_a_dwell_is_in_milliseconds() -> None:
    assert lines(MachineType.MILL, Pause(seconds=0.25))[-1] == "N20 G4 P250"


def test_surface_speed_has_its_limit_before_it(turned: list[Block]) -> None:
    found = list(Fanuc().lines(turned, Cycles.EXPANDED))
    at = found.index("N30 G50 S3000")
    assert found[at + 1] == "N40 G96 S150 M3"


def test_a_thread_has_its_lead_in_f(turned: list[Block]) -> None:
    found = [line.split(" ", 1)[-1] for line in Fanuc().lines(turned, Cycles.EXPANDED)]
    assert "G32 Z-20. F2." in found
    assert "G32 X32. Z-20. F2." in found


def test_a_rigid_tap_by_lead() -> None:
    """B-63833EN-1, 9.: M29 S, then G84 with the lead in F, feed per revolution."""
    tap = RigidTap(start=(0.0, 0.0, 5.0), bottom_z=-15.0, lead=1.25, speed=5.0)
    assert lines(MachineType.MILL, Rapid(end=tap.start), tap)[4:] == [
        "N30 M29 S300",
        "N40 G95 G99 G84 Z-15. R5. F1.25",
        "N50 G80",
    ]
    turned = lines(MachineType.LATHE, Rapid(end=tap.start), tap)
    assert turned[5] == "N40 G84 Z-15. F1.25"


def test_a_lathe_taps_right_hand_threads_only() -> None:
    tap = RigidTap(
        start=(0.0, 0.0, 5.0),
        bottom_z=-15.0,
        lead=1.25,
        speed=5.0,
        sense=SpindleDirection.COUNTERCLOCKWISE,
    )
    with pytest.raises(PostError, match="left-hand rigid tap"):
        lines(MachineType.LATHE, tap)


def test_a_thread_from_nowhere_is_refused() -> None:
    with pytest.raises(PostError, match="unknown position"):
        lines(MachineType.MILL, ThreadingMove(end=(0.0, 0.0, -5.0), lead=1.0))
