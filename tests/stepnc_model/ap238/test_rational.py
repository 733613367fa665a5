"""Curves with weights are read from AP238, and stand in the program of ISO 14649."""

import re

from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.stepnc_model.ap238.test_writer_samples import moves, program
from tests.stepnc_model.ap238.writer_samples import editor_ball_splines


def rational(weight: str) -> str:
    """Sample with curves whose second control points have a weight."""
    pattern = (
        r"=B_SPLINE_CURVE_WITH_KNOTS\('',(3,.*?),\.UNSPECIFIED\.,\.F\.,\.F\.,"
        r"(\([^)]*\),\([^)]*\)),\.UNSPECIFIED\.\)"
    )
    weights = ",".join(["1.", weight, *["1."] * 9])
    return re.sub(
        pattern,
        r"=(BOUNDED_CURVE()B_SPLINE_CURVE(\1,.UNSPECIFIED.,.F.,.F.)"
        r"B_SPLINE_CURVE_WITH_KNOTS(\2,.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()"
        rf"RATIONAL_B_SPLINE_CURVE(({weights}))REPRESENTATION_ITEM(''))",
        editor_ball_splines(),
    )


def ends_of(found: Program) -> list[tuple[float, float, float]]:
    return [move.end for move in moves(found)]


def test_rational_curves_are_followed_in_both_standards() -> None:
    plain, weighted = program(editor_ball_splines()), program(rational("0.7"))
    assert not [each for each in weighted.findings() if "RATIONAL" in each.message]
    assert ends_of(program(rational("1."))) == ends_of(plain)
    assert ends_of(weighted) != ends_of(plain)
    again = Program(Part21File.from_bytes(weighted.file.data))
    assert ends_of(again) == ends_of(weighted)
