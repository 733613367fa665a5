"""Nominal outlines of turned features, from the front."""

from pathlib import Path

from service.programs.reading import read_program
from stepnc_model.toolpath.turning.nominal import nominal_outlines

PARTS = Path(__file__).parents[4] / "examples" / "parts"


def test_the_outlines_of_the_shaft() -> None:
    program = read_program(PARTS / "shaft.stpnc", units="iso")
    found = {step.id: nominal_outlines(program, step) for step in program.workingsteps}
    assert [piece.end for piece in found["FINISH FACE"][0].pieces] == [(0.0, 30.0)]
    contour = [piece for each in found["FINISH CONTOUR"] for piece in each.pieces]
    assert (contour[0].start, contour[-1].end) == ((0.0, 13.5), (-110.0, 27.0))
    assert found["THREAD RELIEF"][0].radii == (12.5, 30.0)
    # A thread lies on the cylinder that carries it.
    assert found["THREAD M30 X 2"][0].radii == (15.0, 15.0)


def test_a_milled_feature_has_no_outline() -> None:
    program = read_program(PARTS / "bracket.stpnc", units="iso")
    assert not any(nominal_outlines(program, step) for step in program.workingsteps)
