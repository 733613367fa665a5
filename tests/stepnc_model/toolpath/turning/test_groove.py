"""Grooves of the shaft: plunges, pecks, dwells and walls."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.path import Move, MoveType, ToolPath


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


SQUARE = "SQUARE_U_PROFILE($,#134,#135,0.,#135,0.)"


def test_two_plunges_of_three_make_a_groove_of_four(path_of: Callable[..., ToolPath]) -> None:
    """From −29 to −25 mm: the left corner at −29 and at −28 mm, down to 12.5 mm."""
    assert [m.end for m in cuts(path_of("THREAD RELIEF"))] == [
        pytest.approx((12.5, 0.0, -29.0)),
        pytest.approx((12.5, 0.0, -28.0)),
    ]


def test_a_finish_comes_down_both_walls_and_meets_in_the_middle(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of("THREAD RELIEF", ("#204=GROOVING_ROUGH", "#204=GROOVING_FINISH"))
    ends = [(round(m.end[0], 3), round(m.end[2], 3)) for m in cuts(path)]
    assert ends.count((12.5, -28.5)) == 2
    assert {(12.5, -28.0), (12.5, -29.0)} <= set(ends)


def test_pecks_go_back_and_the_tool_dwells_on_the_floor(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of(
        "THREAD RELIEF",
        ("$,$,#354,$,0.)", "$,$,#354,DWELL_REVOLUTION(2.),0.)"),
        (
            "GROOVING_STRATEGY($,.T.,(),$,#506,$)",
            "MULTISTEP_GROOVING_STRATEGY($,.T.,(1.),$,#504,1.,0.5)",
        ),
    )
    assert [m.end[0] for m in cuts(path)] == pytest.approx([14.0, 13.0, 12.5] * 2)
    assert [step.revolutions for step in path.steps if hasattr(step, "revolutions")] == [
        2.0
    ] * 2


def test_cutting_in_goes_to_the_axis_and_past_it_by_the_corner(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of(
        "THREAD RELIEF",
        ("#204=GROOVING_ROUGH", "#204=CUTTING_IN"),
        ("#505,12.5,", "#505,0.,"),
        ("3.,12.,0.2", "3.,20.,0.2"),
    )
    assert min(m.end[0] for m in path.moves) == pytest.approx(-0.2)


def test_a_vee_too_sharp_for_the_insert_is_said(path_of: Callable[..., ToolPath]) -> None:
    path = path_of("THREAD RELIEF", (SQUARE, "VEE_PROFILE($,#135,90.,0.)"))
    assert "does not reach the bottom" in str(path.findings)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ((".RIGHT.,3.,12.", ".RIGHT.,4.5,12."), "too narrow for an insert of 4.5 mm"),
        ((".RIGHT.,3.,12.", ".RIGHT.,3.,2."), "the insert reaches 2 mm"),
        ((".RIGHT.,3.,12.", ".RIGHT.,$,12."), "an insert width of None mm"),
        (("(),$,#506,$)", "(),$,#506,9.)"), "a step of 9 mm"),
    ],
)
def test_what_an_insert_cannot_do_is_said(
    path_of: Callable[..., ToolPath], edit: tuple[str, str], message: str
) -> None:
    with pytest.raises(SchemaError, match=message):
        path_of("THREAD RELIEF", edit)
