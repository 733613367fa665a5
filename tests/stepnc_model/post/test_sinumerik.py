"""Sinumerik's own ways."""

from math import pi

import pytest

from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Cycles,
    DrillingCycle,
    Linear,
    MachineType,
    Message,
    Pause,
    ProgramStart,
    Rapid,
    Rate,
    RateMode,
    RigidTap,
    SpindleDirection,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
    expanded,
)
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.sinumerik import Sinumerik
from stepnc_model.toolpath.path import Arc, CycleKind

RATE = Rate(value=5.0)


def lines(
    *blocks: Block, machine: MachineType = MachineType.MILL, cycles: Cycles = Cycles.EXPANDED
) -> list[str]:
    """Lines after the name, without their numbers."""
    program = [ProgramStart(name="P", machine=machine), *blocks]
    found = list(Sinumerik().lines(program, cycles))[1:]
    return [line.split(" ", 1)[1] if line.startswith("N") else line for line in found]


def test_heads_are_metric_for_feeds_as_well() -> None:
    assert lines() == ["G17 G40 G54 G710 G90 G94"]
    assert lines(machine=MachineType.LATHE) == ["G18 G40 G54 G710 G90 G94", "DIAMON"]


def test_tools_have_an_edge_and_turrets_no_m6() -> None:
    assert lines(ToolChange(number=2))[1:] == ["T2 M6", "D1"]
    assert lines(ToolChange(number=2), machine=MachineType.LATHE)[2:] == ["T2", "D1"]


def test_additional_turns_are_counted() -> None:
    helix = Circular(
        end=(10.0, 0.0, -5.0), arc=Arc(centre=(5.0, 0.0, 0.0), turn=-7.0 * pi), rate=RATE
    )
    found = lines(Rapid(end=(0.0, 0.0, 0.0)), helix)[-1]
    assert found == "G2 X10 Y0 Z-5 I5 J0 TURN=3 F300"


def test_turns_back_to_the_start_are_single_blocks() -> None:
    helix = Circular(
        end=(0.0, 0.0, -4.0), arc=Arc(centre=(5.0, 0.0, 0.0), turn=4.0 * pi), rate=RATE
    )
    found = lines(Rapid(end=(0.0, 0.0, 0.0)), helix)[2:]
    assert found == ["G3 X0 Y0 Z-2 I5 J0 F300", "X0 Y0 Z-4 I5 J0"]


def test_surface_speed_stays_when_the_feed_changes_its_mode() -> None:
    """G94 would end it: they are one group."""
    per_revolution = Rate(value=0.2, mode=RateMode.PER_REVOLUTION)
    found = lines(
        SurfaceSpeed(speed=2500.0, limit=50.0),
        Linear(end=(1.0, 0.0, 0.0), rate=per_revolution),
        Linear(end=(2.0, 0.0, 0.0), rate=RATE),
        SpindleOn(speed=10.0),
        Linear(end=(3.0, 0.0, 0.0), rate=per_revolution),
        machine=MachineType.LATHE,
    )
    assert found[2:] == [
        "LIMS=3000",
        "G96 S150 M3",
        "G1 X2 Z0 F0.2",
        "G961 X4 F300",
        "G97 S600 M3",
        "X6 F0.2",
    ]


def test_a_dwell_is_in_f_and_leaves_the_feed_alone() -> None:
    assert lines(Pause(seconds=0.5))[-1] == "G4 F0.5"
    found = list(read_blocks(["G1 X1 F60", "G4 F0.5", "X2"], Dialect.SINUMERIK))
    assert found[1] == Pause(seconds=0.5)
    assert found[2] == Linear(end=(2.0, 0.0, 0.0), rate=Rate(value=1.0))


@pytest.mark.parametrize(
    ("end", "word"), [((0.0, 0.0, -20.0), "K2"), ((15.0, 0.0, -1.0), "I2")]
)
def test_the_lead_is_named_by_the_axis_that_moves_most(
    end: tuple[float, float, float], word: str
) -> None:
    thread = ThreadingMove(end=end, lead=2.0)
    found = lines(Rapid(end=(0.0, 0.0, 0.0)), thread, machine=MachineType.LATHE)
    assert found[-1].split()[-1] == word


def test_a_left_hand_tap_has_a_negative_lead() -> None:
    tap = RigidTap(
        start=(0.0, 0.0, 5.0),
        bottom_z=-9.0,
        lead=1.5,
        speed=5.0,
        sense=SpindleDirection.COUNTERCLOCKWISE,
    )
    assert lines(Rapid(end=tap.start), tap)[2:] == [
        "SPOS=0",
        "G331 Z-9 K-1.5 S300",
        "G332 Z5 K-1.5",
    ]


@pytest.mark.parametrize(
    ("kind", "step", "dwell", "call"),
    [
        (CycleKind.DRILL, 0.0, 0.0, "CYCLE81(2,2,0,-9)"),
        (CycleKind.DWELL, 0.0, 0.5, "CYCLE82(2,2,0,-9,,0.5)"),
        (CycleKind.PECK, 4.0, 0.0, "CYCLE83(2,2,0,-9,,,4,0,0,0,1,1,,,,,0.5)"),
        (CycleKind.CHIP_BREAK, 4.0, 0.0, "CYCLE83(2,2,0,-9,,,4,0,0,0,1,0,,,0.5)"),
        (CycleKind.BORE, 0.0, 0.0, "CYCLE85(2,2,0,-9,,0,300,300)"),
    ],
)
def test_cycles_are_calls_and_read_back(
    kind: CycleKind, step: float, dwell: float, call: str
) -> None:
    cycle = DrillingCycle(
        kind=kind,
        at=(1.0, 3.0),
        retract_z=2.0,
        bottom_z=-9.0,
        rate=RATE,
        step_depth=step,
        retract_distance=0.5 if step else 0.0,
        dwell=dwell,
    )
    found = lines(Rapid(end=(1.0, 3.0, 2.0)), expanded(cycle), cycles=Cycles.OWN)
    assert found[-2:] == ["F300", call]


def test_messages_and_comments() -> None:
    assert lines(Message(text='say "x"'), Comment(text="a ; b"))[1:] == [
        "MSG(\"say 'x'\")",
        "; a ; b",
    ]


def test_a_spindle_at_an_angle() -> None:
    assert lines(SpindleOrient())[-1] == "SPOS=0"
