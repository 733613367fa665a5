"""Threads and taps of foreign code stay synchronised moves, with their lead."""

from dataclasses import replace

import pytest

from stepnc_model.nc.neutral_blocks import neutral_blocks
from stepnc_model.nc.program import read_program
from stepnc_model.post.blocks import (
    Block,
    Linear,
    MachineType,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    RigidTap,
    SpindleOn,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write

THREAD = ThreadingMove(end=(9.5, 0.0, -20.0), lead=1.5)
TAP = RigidTap(start=(0.0, 0.0, 2.0), bottom_z=-12.0, lead=1.25, speed=10.0)


def read(code: str, control: Dialect, machine: MachineType) -> list[Block]:
    program = read_program(code.encode(), dialect=control, machine=machine)
    return [block for _, block in neutral_blocks(program)]


def round_trip(control: Dialect, machine: MachineType, *blocks: Block) -> list[Block]:
    program = [
        ProgramStart(name="P", machine=machine),
        ToolChange(number=1),
        SpindleOn(speed=10.0),
        *blocks,
        ProgramEnd(),
    ]
    text = "".join(f"{line}\n" for line in write(program, control))
    return read(text, control, machine)


@pytest.mark.parametrize("control", [Dialect.LINUXCNC, Dialect.FANUC, Dialect.SINUMERIK])
def test_a_thread_that_we_write_reads_back_as_a_thread(control: Dialect) -> None:
    found = round_trip(
        control,
        MachineType.LATHE,
        Rapid(end=(9.5, 0.0, 5.0)),
        THREAD,
        Linear(end=(9.5, 0.0, -21.0), rate=Rate(value=2.0)),
    )
    assert THREAD in found
    assert all(not isinstance(each, Rapid) or each.end[2] > 0.0 for each in found)
    assert isinstance(found[-2], Linear)
    assert found[-2].rate.value == pytest.approx(2.0)


@pytest.mark.parametrize("control", [each for each in Dialect if each is not Dialect.CANONICAL])
def test_a_tap_that_we_write_reads_back_synchronised_both_ways(control: Dialect) -> None:
    found = round_trip(control, MachineType.MILL, Rapid(end=TAP.start), TAP)
    assert TAP in found
    assert not any(isinstance(each, ThreadingMove) for each in found)


def test_a_lathe_takes_the_lead_from_the_feed_in_both_modes() -> None:
    for mode in ("G98", "G99"):
        code = f"O1\nT0101\nG97 S600 M3\nG0 X19. Z5.\n{mode}\nG32 Z-20. F1.5\nG0 X30.\nM30\n"
        assert THREAD in read(code, Dialect.FANUC, MachineType.LATHE)


def test_a_taper_has_its_lead_along_the_longer_axis() -> None:
    code = "T1 M6\nG97 S600 M3\nG8\nG0 X9 Z0\nG33 X12 Z-4 K2.5\nM2\n"
    found = read(code, Dialect.LINUXCNC, MachineType.LATHE)
    # LinuxCNC's K is along the path, which is 5 mm long.
    [thread] = [each for each in found if isinstance(each, ThreadingMove)]
    assert thread.lead == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("control", "tap"),
    [
        (Dialect.FANUC, "G94 F750.\nG99 G84 X0. Y0. Z-12. R2.\nG80\n"),
        (Dialect.FANUC, "G95\nM29 S600\nG99 G84 X0. Y0. Z-12. R2. F1.25\nG80\n"),
        (Dialect.HAAS, "M5\nG99 G84 X0. Y0. Z-12. R2. F750.\nG80\n"),
        (Dialect.LINUXCNC, "G99 G84 X0 Y0 Z-12 R2 F750\nG80\n"),
        (Dialect.SINUMERIK, "G0 Z2\nG331 Z-12 K1.25 S600\nG332 Z2 K1.25\n"),
        (Dialect.SINUMERIK, "G0 Z2\nCYCLE84(2,0,2,-12,,,3,,1.25,,600,600)\n"),
        (Dialect.SINUMERIK, "G0 Z2\nCYCLE840(2,0,2,-12,,,4,3,0,,1.25)\n"),
    ],
)
def test_taps_of_shops_are_synchronised(control: Dialect, tap: str) -> None:
    code = f"G17 G21 G90\nT1 M6\nS600 M3\nG54 G0 X0. Y0.\nG43 H1 Z20.\n{tap}M30\n"
    if control is Dialect.SINUMERIK:
        code = code.replace("G17 G21", "G17 G71").replace("G43 H1", "D1")
    found = read(code, control, MachineType.MILL)
    [tap_block] = [each for each in found if isinstance(each, RigidTap)]
    assert replace(tap_block, lead=1.25) == TAP
    assert tap_block.lead == pytest.approx(1.25)


def test_a_thread_of_unknown_lead_is_left_out_and_no_rapid() -> None:
    code = "T0101\nG97 S600 M3\nG0 X19. Z5.\nG32 Z-20. F#100\nG0 X30.\nM30\n"
    found = read(code, Dialect.FANUC, MachineType.LATHE)
    assert not any(isinstance(each, ThreadingMove) for each in found)
    assert not any(
        isinstance(each, Rapid) and each.end == (9.5, 0.0, -20.0) and not each.is_way
        for each in found
    )


def test_a_cycle_that_is_not_expanded_is_no_move() -> None:
    code = "T0101\nG97 S600 M3\nG0 X21. Z5.\nG76 X17. Z-20. P920 Q1000 F1.5\nG0 X30.\nM30\n"
    found = read(code, Dialect.FANUC, MachineType.LATHE)
    ends = [each.end for each in found if isinstance(each, Rapid) and not each.is_way]
    assert ends == [(10.5, 0.0, 5.0)]
