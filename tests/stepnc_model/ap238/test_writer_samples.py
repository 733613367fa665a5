"""Programs of tool paths alone are read as several writers write them."""

import re
from collections.abc import Callable

import pytest

from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Move
from tests.stepnc_model.ap238.writer_samples import (
    SAMPLES,
    apt_two_setups,
    editor_ball_splines,
    editor_pocket_nested,
    lathe_constant_surface_speed,
)


def program(text: str) -> Program:
    return Program(Part21File.from_bytes(text.encode(), name="part.stpnc"), name="part.stpnc")


def moves(found: Program, row: int = 0) -> list[Move]:
    path = workingstep_path(found, found.workingsteps[row])
    return [each for each in path.steps if isinstance(each, Move)]


@pytest.mark.parametrize("make", SAMPLES, ids=lambda make: make.__name__)
def test_each_sample_has_its_paths(make: Callable[[], str]) -> None:
    found = program(make())
    assert found.workingsteps
    assert not found.faults
    assert any(move.feed is not None for move in moves(found))


def emptied(entity: str) -> Callable[[str], str]:
    """Text without the description of an entity's instances."""
    pattern = rf"({entity}\('[^']*'),'[^']*'"
    return lambda text: re.sub(pattern, r"\1,''", text)


@pytest.mark.parametrize(
    "entity",
    [
        "MACHINING_TECHNOLOGY",
        "MACHINING_TOOLPATH",
        "MACHINING_WORKINGSTEP",
        "MACHINING_FUNCTIONS",
        "PRODUCT_DEFINITION_PROCESS",
    ],
)
@pytest.mark.parametrize("make", [editor_pocket_nested, lathe_constant_surface_speed])
def test_what_leaves_out_its_kind_is_read_alike(make: Callable[[], str], entity: str) -> None:
    text = make()
    bare = emptied(entity)(text)
    one, other = program(text), program(bare)
    assert [step.operation_type for step in other.workingsteps] == [
        step.operation_type for step in one.workingsteps
    ]
    steps = range(len(one.workingsteps))
    assert [len(moves(other, row)) for row in steps] == [len(moves(one, row)) for row in steps]


def bezier(text: str) -> str:
    """Splines of eleven poles as three Bezier curves of ten."""
    pattern = (
        r"=B_SPLINE_CURVE_WITH_KNOTS\('',3,\((.*?),#\d+\),\.UNSPECIFIED\.,\.F\.,\.F\.,"
        r"\([^)]*\),\([^)]*\),\.UNSPECIFIED\.\)"
    )
    return re.sub(pattern, r"=BEZIER_CURVE('',3,(\1),.UNSPECIFIED.,.F.,.F.)", text)


def test_bezier_curves_pass_their_joints() -> None:
    found = program(bezier(editor_ball_splines()))
    ends = [move.end for move in moves(found)]
    # Every third control point lies on the curve; the first row begins at x = 0.
    assert any(abs(x - 24.0) < 1e-6 and abs(y - 2.0) < 1e-6 for x, y, _ in ends)


def test_the_second_setup_is_cut_from_the_other_side() -> None:
    found = program(apt_two_setups())
    one, other = (
        {round(move.end[2], 6) for move in moves(found, row) if move.feed is not None}
        for row in range(2)
    )
    assert one == other == {-1.0}
