"""The tool paths of the shaft, and what cannot be turned."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.path import Move, MoveType, ToolPath
from tests.every_case import every_case


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


NAMES = [
    "ROUGH FACE",
    "FINISH FACE",
    "ROUGH CONTOUR",
    "FINISH CONTOUR",
    "THREAD RELIEF",
    "THREAD M30 X 2",
]


@pytest.mark.parametrize("name", NAMES)
def test_every_path_of_the_shaft_starts_and_ends_at_the_safe_point(
    path_of: Callable[..., ToolPath], name: str
) -> None:
    """5 mm outside the bar of 60 mm, on the security plane at 10 mm."""
    path = path_of(name)
    assert path.start == path.end == (35.0, 0.0, 10.0)
    assert path.is_turning
    assert cuts(path)
    assert path.findings == ()


def test_without_retract_plane_the_clearance_is_a_note(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of("ROUGH FACE", ("'ROUGH FACE',5.", "'ROUGH FACE',$"))
    assert "assuming 5 mm off the stock" in str(path.findings[0])


def test_without_nose_radius_the_tool_is_sharp_and_it_is_said(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of("FINISH CONTOUR", ("93.,$,55.,(#412)", "93.,$,55.,()"))
    assert "no nose radius" in str(path.findings)
    assert all(move.arc is None for move in path.moves)


@every_case(
    ("edit", "message"),
    [
        (("#352,0.5)", "#352,50.)"), "the allowance of 50 mm exceeds"),
        (("#352,0.5)", "#352,-0.5)"), "must be from 0 to 1000 mm"),
        (("(#110,#120),#202", "(),#202"), "has no feature"),
        (("152.,30.)", "152.,12.)"), "exceeds the bar radius of 12 mm"),
        (("152.,30.)", "62.,30.)"), "the bar extends from"),
        (("(2.),$,#504", "(-2.),$,#504"), "must be positive"),
    ],
)
def test_what_cannot_be_turned_is_said(
    path_of: Callable[..., ToolPath], edit: tuple[str, str], message: str
) -> None:
    edits = [edit]
    if "62." in edit[1]:
        edits.append(("(0.,0.,-150.)", "(0.,0.,-60.)"))
    with pytest.raises(SchemaError, match=message):
        path_of("ROUGH CONTOUR", *edits)
