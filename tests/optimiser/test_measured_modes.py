"""Which modes hold for a cut; what they bound is in test_stability.py."""

from dataclasses import replace

from optimiser.bounds.stability import measured_modes, what_is_measured
from simulator.library import load_machine
from simulator.spec import Machine, ModeDirection, VibratingPart, VibrationMode
from tests.optimiser.sample_cuts import CUT, DRILLED, TURNED

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="mill",
    direction=ModeDirection.XY,
    natural_frequency=900.0,
    damping_ratio=0.03,
    stiffness=12_000.0,
    source="tap test",
)
WORK = replace(MODE, part=VibratingPart.WORKPIECE, tool="", direction=ModeDirection.X)


def machine(*modes: VibrationMode) -> Machine:
    return replace(load_machine("vmc15"), modes=modes)


def test_a_round_tool_gives_alike_in_both_directions() -> None:
    found = measured_modes(CUT, machine(MODE))
    assert found is not None
    assert (found.x, found.y, found.z) == ((MODE,), (MODE,), ())
    assert found.in_plane == (MODE,)
    assert what_is_measured(CUT, found) == "1 measured mode"


def test_workpiece_and_tool_give_together() -> None:
    found = measured_modes(CUT, machine(MODE, WORK))
    assert found is not None
    assert (found.x, found.y) == ((MODE, WORK), (MODE,))
    assert what_is_measured(CUT, found) == "2 measured modes"


def test_a_mill_does_not_feel_modes_along_its_axis_nor_a_lathe_those_across() -> None:
    assert measured_modes(CUT, machine(replace(MODE, direction=ModeDirection.Z))) is None
    insert = replace(MODE, tool="insert")
    assert measured_modes(TURNED, machine(replace(insert, direction=ModeDirection.Y))) is None
    found = measured_modes(TURNED, machine(replace(insert, direction=ModeDirection.Z)))
    assert found is not None
    assert len(found.along_axis) == 1


def test_what_only_the_workpiece_gives_is_told() -> None:
    found = measured_modes(CUT, machine(WORK))
    assert found is not None
    expected = "1 measured mode of the workpiece, the tool taken as rigid, y taken as rigid"
    assert what_is_measured(CUT, found) == expected


def test_drills_have_no_modes_of_their_own() -> None:
    assert measured_modes(DRILLED, machine(replace(MODE, tool="drill"))) is None
