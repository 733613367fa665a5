"""Estimates by the kind of the operation."""

from pathlib import Path

import pytest

from optimiser.cut import CutKind
from optimiser.estimated import Estimates, estimated_cut
from stepnc_model.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"


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
    cut, _ = estimated_cut(program, step)
    assert cut.kind is kind
    assert cut.volume is None
    assert not cut.is_air


def test_no_workingstep_knows_of_another() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    cuts = Estimates(program)
    first, second = program.workingsteps[:2]
    alone, _ = cuts.cut(second)
    cuts.leave_out(first)
    assert cuts.cut(second)[0] == alone
