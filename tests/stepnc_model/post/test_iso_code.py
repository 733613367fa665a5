"""What writers of G-code share, seen through Fanuc's."""

from math import pi

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Coolant,
    CoolantKind,
    Cycles,
    DrillingCycle,
    Linear,
    MachineType,
    ProgramStart,
    Rapid,
    Rate,
    RateMode,
    Retract,
    SpindleOn,
    SurfaceSpeed,
    expanded,
)
from stepnc_model.post.fanuc import Fanuc
from stepnc_model.toolpath.path import Arc, CycleKind

RATE = Rate(value=5.0)


def lines(*blocks: Block, cycles: Cycles = Cycles.EXPANDED) -> list[str]:
    """Lines after the head, without their numbers."""
    program = [ProgramStart(name="P"), *blocks]
    return [line.split(" ", 1)[1] for line in list(Fanuc().lines(program, cycles))[3:]]


def test_words_that_hold_are_left_out() -> None:
    assert lines(
        Rapid(end=(0.0, 0.0, 5.0)),
        Linear(end=(0.0, 0.0, -1.0), rate=RATE),
        Linear(end=(10.0, 0.0, -1.0), rate=RATE),
        Linear(end=(10.0, 5.0, -1.0), rate=Rate(value=10.0)),
        Rapid(end=(10.0, 5.0, 5.0)),
    ) == [
        "G0 X0. Y0. Z5.",
        "G1 Z-1. F300.",
        "X10.",
        "Y5. F600.",
        "G0 Z5.",
    ]


def test_a_new_mode_of_feed_says_its_feed_again() -> None:
    per_revolution = Rate(value=0.5, mode=RateMode.PER_REVOLUTION)
    assert lines(
        Linear(end=(1.0, 0.0, 0.0), rate=RATE),
        Linear(end=(2.0, 0.0, 0.0), rate=per_revolution),
        Linear(end=(3.0, 0.0, 0.0), rate=RATE),
    )[1:] == ["G95 X2. F0.5", "G94 X3. F300."]


def test_an_arc_names_both_axes_of_its_plane() -> None:
    full = Circular(
        end=(5.0, 0.0, 0.0), arc=Arc(centre=(0.0, 0.0, 0.0), turn=2 * pi), rate=RATE
    )
    assert lines(Rapid(end=(5.0, 0.0, 0.0)), full)[1] == "G3 X5. Y0. I-5. J0. F300."


def test_an_arc_from_nowhere_is_refused() -> None:
    arc = Circular(end=(5.0, 5.0, 0.0), arc=Arc(centre=(0.0, 5.0, 0.0), turn=pi), rate=RATE)
    with pytest.raises(PostError, match="unknown position"):
        lines(arc)


def test_a_retract_moves_z_alone() -> None:
    assert lines(Retract(z=50.0)) == ["G0 Z50."]


def test_coolant_changes_only_what_changes() -> None:
    flood, mist = CoolantKind.FLOOD, CoolantKind.MIST
    found = lines(
        Coolant(kinds=frozenset({flood})),
        Coolant(kinds=frozenset({flood, mist})),
        Coolant(kinds=frozenset({mist})),
        Coolant(),
    )
    assert found == ["M8", "M7", "M9", "M7", "M9"]


def test_a_mill_has_no_surface_speed() -> None:
    with pytest.raises(PostError, match="milling machine"):
        lines(SurfaceSpeed(speed=1000.0))


def hole(x: float, kind: CycleKind = CycleKind.DRILL, dwell: float = 0.0) -> DrillingCycle:
    return expanded(
        DrillingCycle(
            kind=kind, at=(x, 0.0), retract_z=2.0, bottom_z=-9.0, rate=RATE, dwell=dwell
        )
    )


def test_a_cycle_is_said_in_full_once_and_ended() -> None:
    found = lines(
        Rapid(end=(1.0, 0.0, 2.0)),
        hole(1.0),
        Rapid(end=(2.0, 0.0, 2.0)),
        hole(2.0),
        Retract(z=50.0),
        cycles=Cycles.OWN,
    )
    assert found[1:] == [
        "G99 G81 X1. Y0. Z-9. R2. F300.",
        "X2. Y0.",
        "G80",
        "G0 Z50.",
    ]


def test_a_dwell_that_a_cycle_cannot_wait_is_written_out() -> None:
    found = lines(hole(1.0, CycleKind.DRILL, dwell=1.0), cycles=Cycles.OWN)
    assert found == ["G1 X1. Y0. Z-9. F300.", "G4 P1000", "G0 Z2."]


def test_cycles_of_a_lathe_are_written_out() -> None:
    program: list[Block] = [ProgramStart(name="L", machine=MachineType.LATHE), hole(0.0)]
    assert not any("G81" in line for line in Fanuc().lines(program, Cycles.OWN))


def test_numbers_end_before_the_control_runs_out() -> None:
    """Ten by ten up to N99990."""
    program: list[Block] = [ProgramStart(name="P")]
    program += [SpindleOn(speed=float(i)) for i in range(1, 10_010)]
    found = list(Fanuc().lines(program, Cycles.EXPANDED))
    assert found[10_000].startswith("N99990 ")
    assert found[10_001].startswith("S")
