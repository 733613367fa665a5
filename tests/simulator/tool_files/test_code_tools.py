"""Tools that the comments of NC programs describe."""

from pathlib import Path

import pytest

from simulator.removal.cutter import Cutter
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.code_tools import CodeTools, against_table, tools_of_code
from simulator.tools.plausible_tools import ToolGuess
from simulator.tools.tool_table import ToolRow, tool_of_row
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

POSTS = Path(__file__).parents[2] / "data" / "posts"


def tools(code: str, dialect: Dialect = Dialect.FANUC) -> CodeTools:
    """Tools of a program."""
    return tools_of_code(read_program(code.encode(), dialect=dialect), name="part.nc")


def sizes(found: CodeTools) -> dict[int, float]:
    """Diameters by the numbers of the tools, mm."""
    return {
        number: round(tool.shape.diameter, 4)
        for number, tool in found.by_number.items()
        if isinstance(tool.shape, Cutter)
    }


@pytest.mark.parametrize(
    ("post", "diameters"),
    [
        ("fusion_inch.nc", {1: 9.525, 2: 6.35, 3: 5.1054}),
        ("mastercam.nc", {1: 12.7, 2: 6.35}),
        ("cambam.nc", {5: 3.175}),
        ("freecad.ngc", {1: 6.0}),
        ("vcarve.nc", {1: 6.35}),
        ("estlcam.nc", {1: 3.0}),
        ("solidcam.nc", {1: 10.0, 2: 6.0}),
        ("heidenhain.h", {7: 10.0, 12: 10.0}),
        ("sinumerik.mpf", {1: 10.0}),
        ("carbide_create.nc", {102: 3.18}),
    ],
)
def test_programs_in_the_manner_of_posts(post: str, diameters: dict[int, float]) -> None:
    found = tools_of_code(read_program((POSTS / post).read_bytes()), name=post)
    assert sizes(found) == diameters
    assert set(found.guesses) == set(diameters)


@pytest.mark.parametrize(
    "code",
    [
        "T1 M6 (6MM END MILL)\nG0 X1\n",
        "(6MM END MILL)\nT1 M6\nG0 X1\n",
        "T1 M6\n(TOOL: 6MM END MILL)\nG0 X1\n",
        "(T1 D=6. - FLAT END MILL)\nT1 M6 (6MM END MILL)\nG0 X1\n",
        "(6MM END MILL)\nG0 X1 Y1 S9 M3\nX2\n",
    ],
)
def test_a_comment_without_a_number_is_about_the_tool_that_is_called(code: str) -> None:
    assert sizes(tools("G21\n" + code)) == {1: 6.0}


def test_a_comment_far_from_a_call_is_about_no_tool() -> None:
    assert not tools("G21\n(6MM END MILL)\nG0 X1\nT1 M6\nX2\n").tools
    assert not tools("G21\nT1 M6\nG0 X1\n(6MM END MILL)\nX2\n").tools


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("(T1 D=6. - END MILL)\n(T1 D=8. - END MILL)\n", "contradict"),
        ("(T1 D=6. - END MILL)\n(T1 D=6. - DRILL)\n", "contradict"),
        ("(T1 6MM END MILL 2 FLUTE)\n(T1 6MM END MILL 3 FLUTE)\n", "contradict"),
        ("(T1 D=0.25 CR=0. - 1/4 IN END MILL)\n", "unit of the program"),
        ("(T1 D=300. - END MILL)\n", "unit of the program"),
        ("(T1 D=6. - BULL NOSE END MILL)\n", "corner radius"),
        ("(T1 D=6. - CHAMFER MILL)\n", "angle of the chamfer"),
        ("(T1 D=6. - THREAD MILL)\n", "shape"),
        ("(T1 D=6. CR=5. - END MILL)\n", "corner_radius_mm"),
    ],
)
def test_what_is_not_known_or_contradicts_itself_is_left_out(code: str, why: str) -> None:
    found = tools("G21\n" + code + "T1 M6\nG0 X1\n")
    assert not found.tools
    assert why in found.findings[0].message
    assert found.findings[0].line


def test_guesses_are_told_with_the_line() -> None:
    found = tools("G21\n(T1 D=10. - FLAT END MILL)\n(T2 D=6. 3 FLUTE CARBIDE END MILL)\n")
    assert found.guesses[1] == ToolGuess(has_teeth=True, has_edge=True)
    assert found.guesses[2] == ToolGuess()
    assert "3 teeth" in found.findings[0].message
    assert [each.line for each in found.findings] == [2, 3]


def test_shapes_of_drills_cones_and_balls() -> None:
    code = (
        "(T1 D=5. TAPER=118DEG - DRILL)\n(T2 D=6. TAPER=45DEG - CHAMFER MILL)\n"
        "(T3 D=8. CR=4. - BALL END MILL HSS)\n"
    )
    found = tools("G21\n" + code).by_number
    shapes = {number: tool.shape for number, tool in found.items()}
    drill, cone, ball = (shapes[number] for number in (1, 2, 3))
    assert isinstance(drill, Cutter)
    assert isinstance(cone, Cutter)
    assert isinstance(ball, Cutter)
    assert drill.is_drill
    assert drill.point_angle == pytest.approx(2.0595, abs=1e-4)
    assert cone.point_angle == pytest.approx(1.5708, abs=1e-4)
    assert ball.corner_radius == 4.0
    assert found[3].cutting_material is CuttingMaterial.HSS


def test_a_table_counts_and_contradictions_are_told() -> None:
    found = tools("G21\n(T1 D=10. - END MILL)\n(T2 D=5. - DRILL)\n")
    table = {
        number: tool_of_row(ToolRow(number=number, kind=kind, diameter_mm=size))
        for number, kind, size in ((1, ToolKind.ENDMILL, 12.0), (2, ToolKind.DRILL, 5.0))
    }
    told = list(against_table(found, table))
    assert [each.line for each in told] == [2]
    assert "12 mm" in told[0].message
