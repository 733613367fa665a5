"""Estimates by the kind of the operation."""

from math import radians
from pathlib import Path

import pytest

from optimiser.cuts.cut import CutKind
from optimiser.cuts.feature_cuts import Estimates, estimated_cut
from simulator.library import find_grade, load_machine, load_material
from simulator.spec import CuttingMaterial, Machine, ToolKind
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"
STEEL = load_material("c45")
MILL = load_machine("vmc15")


@pytest.mark.parametrize(
    ("part", "name", "kind"),
    [
        ("bracket", "ROUGH POCKET", CutKind.MILLING),
        ("bracket", "REAM HOLE 1", CutKind.DRILLING),
        ("shaft", "ROUGH CONTOUR", CutKind.TURNING),
        ("shaft", "THREAD RELIEF", CutKind.GROOVING),
    ],
)
def test_each_operation_has_its_estimate(part: str, name: str, kind: CutKind) -> None:
    program = Program.load(PARTS / f"{part}.stpnc")
    (step,) = (each for each in program.workingsteps if each.id == name)
    cut, _ = estimated_cut(program, step, MILL, STEEL)
    assert cut.kind is kind
    assert cut.volume is None
    assert not cut.is_air


def test_no_workingstep_knows_of_another() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    cuts = Estimates(program, MILL, STEEL)
    first, second = program.workingsteps[:2]
    alone, _ = cuts.cut(second)
    cuts.leave_out(first)
    assert cuts.cut(second)[0] == alone


def helix_of(name: str, material: str, machine: Machine = MILL) -> float:
    program = Program.load(PARTS / "bracket.stpnc")
    (step,) = (each for each in program.workingsteps if each.id == name)
    return estimated_cut(program, step, machine, load_material(material))[0].helix_angle


def test_the_helix_of_a_cutter_is_that_of_its_grade() -> None:
    grade = find_grade(ToolKind.ENDMILL, CuttingMaterial.CARBIDE, "P")
    assert helix_of("FINISH CONTOUR", "c45") == grade.helix_angle == radians(30.0)


def test_the_helix_counts_wherever_the_tool_bends() -> None:
    """A machine with stated limits takes the stiffness of a tool where the group is known."""
    stated = load_machine("paper003")
    assert stated.only_stated_limits
    assert helix_of("FINISH CONTOUR", "c45", stated) == radians(30.0)
    assert helix_of("FINISH CONTOUR", "paper002", stated) == 0.0


def test_edges_of_a_face_mill_are_straight_whatever_the_material() -> None:
    assert helix_of("ROUGH FACE", "c45") == 0.0
    assert helix_of("FINISH CONTOUR", "paper002") == helix_of("FINISH CONTOUR", "c45") > 0.0
