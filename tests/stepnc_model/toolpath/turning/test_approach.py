"""Approach and retract as the operation says."""

from collections.abc import Callable
from math import cos, radians, sin

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.path import MoveType, ToolPath

END = "ENDSEC;\nEND-"


def test_the_first_cut_is_met_tangentially_and_the_last_left_at_an_angle(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of(
        "FINISH CONTOUR",
        (
            "'FINISH CONTOUR',5.,$,#410,#301,#330,$,$",
            "'FINISH CONTOUR',5.,$,#410,#301,#330,#600,#601",
        ),
        (END, "#600=AP_RETRACT_TANGENT($,3.);\n#601=AP_RETRACT_ANGLE($,45.,2.);\n" + END),
    )
    (start, arc), *_ = [(a, m) for a, m in path.segments() if m.feed]
    assert arc.arc is not None
    assert arc.type is MoveType.NO_CONTACT
    assert (start[0] - arc.end[0], start[2] - arc.end[2]) == pytest.approx((3.0, 3.0))
    moves = list(path.segments())
    leaving = [(a, m) for a, m in moves if m.feed][-1]
    assert leaving[1].end[0] - leaving[0][0] == pytest.approx(2.0**0.5)


def test_an_obtuse_retract_leaves_back_over_the_cut(path_of: Callable[..., ToolPath]) -> None:
    path = path_of(
        "FINISH CONTOUR",
        (
            "'FINISH CONTOUR',5.,$,#410,#301,#330,$,$",
            "'FINISH CONTOUR',5.,$,#410,#301,#330,$,#601",
        ),
        (END, "#601=AP_RETRACT_ANGLE($,100.,2.);\n" + END),
    )
    before, move = [(a, m) for a, m in path.segments() if m.feed][-1]
    leaving = (move.end[0] - before[0], move.end[2] - before[2])
    # The contour ends up a shoulder, along x; its free side is that of z.
    wanted = (2.0 * cos(radians(100.0)), 2.0 * sin(radians(100.0)))
    assert leaving == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("given", ["45.,0.", "100.,12.", "180.,1."])
def test_an_angle_without_length_or_deep_in_the_material_is_refused(
    path_of: Callable[..., ToolPath], given: str
) -> None:
    edits = (
        (
            "'FINISH CONTOUR',5.,$,#410,#301,#330,$,$",
            "'FINISH CONTOUR',5.,$,#410,#301,#330,#600,$",
        ),
        (END, f"#600=AP_RETRACT_ANGLE($,{given});\n" + END),
    )
    with pytest.raises(SchemaError, match="is not a valid lead-in"):
        path_of("FINISH CONTOUR", *edits)


def test_a_bar_that_is_not_given_stands_out_by_one_cut_and_the_allowance(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of("ROUGH FACE", ("$,$,#33,(#36)", "$,$,$,(#36)"))
    cuts = {round(m.end[2], 9) for _, m in path.segments() if m.type is MoveType.CONTACT}
    assert cuts == {0.5}
    # The face reaches 30 mm from the axis, no feature farther; 1.5 mm are cut, 0.5 mm left.
    assert any(
        each.message.endswith("a bar of 60 mm diameter, as the features, and 2 mm to face off")
        for each in path.findings
    )
