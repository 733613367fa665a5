"""The bar of a tee slot: a T-slot mill runs from outside to outside, below the neck."""

from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import MoveType, ToolPath
from tests.every_case import every_case

PARTS = Path(__file__).parents[4] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"

SIZES = """#901=TOLERANCED_LENGTH_MEASURE(20.,#510);
#902=TOLERANCED_LENGTH_MEASURE(4.,#510);
#903=TOLERANCED_LENGTH_MEASURE(0.,#510);
"""


def path(
    *,
    mill: str = "T_SLOT_MILL(#422,4,.RIGHT.,.F.,$,4.)",
    diameter: float = 20.0,
    ends: str = "",
) -> ToolPath:
    """The slot of the bracket with a bar of 20 mm by 4 mm at its floor, 6 mm deep."""
    text = (PARTS / "bracket.stpnc").read_text()
    changes = [
        ("#136=SQUARE_U_PROFILE($,#137,#138,0.,#138,0.);",
         "#136=TEE_PROFILE($,0.,0.,#901,#902,#903,#137,#903,#903);"),
        ("#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$);", f"#421={mill};"),
        ("#422=MILLING_TOOL_DIMENSION(12.,", f"#422=MILLING_TOOL_DIMENSION({diameter},"),
        *([("#139=OPEN_SLOT_END_TYPE();", f"#139={ends};")] if ends else []),
        (END, SIZES + END),
    ]  # fmt: skip
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="tee"), name="tee")
    step = next(step for step in program.workingsteps if step.id == "MILL SLOT")
    return workingstep_path(program, step)


def below(
    found: ToolPath,
) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Ways whose start or end lies below the top of the part."""
    return [
        (start, move.end)
        for start, move in found.segments()
        if min(start[2], move.end[2]) < -1e-9
    ]


def test_a_mill_as_wide_as_the_bar_makes_one_pass_on_the_floor() -> None:
    found = path()
    flat = [(a, b) for a, b in below(found) if a[2] == b[2]]
    assert {a[2] for a, _ in flat} == {-6.0}
    assert {round(p[0], 9) for pair in flat for p in pair} == {90.0}
    assert any(move.type is MoveType.CONTACT for move in found.moves)


def test_it_goes_down_and_up_beside_the_part() -> None:
    """The part reaches from y = 0 to 90 mm and the mill has 10 mm of radius."""
    for start, end in below(path()):
        if start[2] != end[2]:
            assert start[1] + 10.0 < 0.0 or start[1] - 10.0 > 90.0


def test_a_narrower_mill_runs_along_either_side_of_the_bar() -> None:
    found = path(diameter=14.0)
    flat = [(a, b) for a, b in below(found) if a[2] == b[2]]
    assert {round(p[0], 9) for pair in flat for p in pair} == {87.0, 93.0}


def test_a_thinner_mill_makes_the_bar_level_by_level_from_its_top() -> None:
    """3 mm of mill in 4 mm of bar: its lower face first at −5 mm, then at −6 mm."""
    found = path(mill="T_SLOT_MILL(#422,4,.RIGHT.,.F.,$,3.)")
    heights = [a[2] for a, b in below(found) if a[2] == b[2]]
    assert sorted(set(heights), reverse=True) == [-5.0, -6.0]


@every_case(
    ("arguments", "message"),
    [
        ({"diameter": 21.0}, "21 mm for an undercut of 20 mm"),
        ({"diameter": 9.0}, "the mill must be between half and all of the undercut's width"),
        (
            {"mill": "T_SLOT_MILL(#422,4,.RIGHT.,.F.,$,5.)"},
            "5 mm thick does not fit an undercut of 4 mm",
        ),
        ({"ends": "RADIUSED_SLOT_END_TYPE()"}, "both must be open"),
    ],
)
def test_a_mill_that_cannot_make_it_is_refused(
    arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(PathError, match=message):
        path(**arguments)  # type: ignore[arg-type]


def test_an_end_mill_makes_the_neck_and_says_what_is_left() -> None:
    found = path(mill="TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$)", diameter=12.0)
    assert any("only the neck of the tee slot" in each.message for each in found.findings)
