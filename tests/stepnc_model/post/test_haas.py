"""Where Haas is not Fanuc."""

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Coolant,
    CoolantKind,
    Cycles,
    MachineType,
    Pause,
    ProgramStart,
    Rapid,
    RigidTap,
    SpindleDirection,
    ThreadingMove,
)
from stepnc_model.post.fanuc import HAAS, Fanuc


def lines(*blocks: Block, machine: MachineType = MachineType.MILL) -> list[str]:
    program = [ProgramStart(name="P", machine=machine), *blocks]
    return list(Fanuc(HAAS).lines(program, Cycles.EXPANDED))


def test_programs_have_five_digits() -> None:
    assert lines()[1] == "O00001 (P)"


def test_a_dwell_with_a_point_is_in_seconds() -> None:
    assert lines(Pause(seconds=2.0))[-1] == "N20 G4 P2."


def test_coolant_through_the_spindle_has_codes_of_its_own() -> None:
    through = Coolant(kinds=frozenset({CoolantKind.THROUGH, CoolantKind.FLOOD}))
    found = [line.split()[-1] for line in lines(through, Coolant())[3:]]
    assert found == ["M8", "M88", "M9", "M89"]


@pytest.mark.parametrize(
    ("machine", "sense", "code"),
    [
        (MachineType.MILL, SpindleDirection.CLOCKWISE, "G84"),
        (MachineType.MILL, SpindleDirection.COUNTERCLOCKWISE, "G74"),
        (MachineType.LATHE, SpindleDirection.CLOCKWISE, "G84"),
        (MachineType.LATHE, SpindleDirection.COUNTERCLOCKWISE, "G184"),
    ],
)
def test_taps_need_no_m29(machine: MachineType, sense: SpindleDirection, code: str) -> None:
    tap = RigidTap(start=(0.0, 0.0, 5.0), bottom_z=-9.0, lead=1.0, speed=5.0, sense=sense)
    found = lines(Rapid(end=tap.start), tap, machine=machine)
    assert found[4] == "N30 S300"
    assert f" {code} Z-9. R5. F1." in found[5]


def test_a_mill_cuts_no_threads() -> None:
    thread = ThreadingMove(end=(0.0, 0.0, -5.0), lead=1.0)
    with pytest.raises(PostError, match="a synchronised move: this"):
        lines(Rapid(end=(0.0, 0.0, 0.0)), thread)
