"""Where bores at the back of a hole lie, on a hole of the sample bracket.

At (110, 65) a hole of 10 mm through 40 mm, with a bore of 16 mm behind it that is 10 mm deep.
The stock ends 2 mm above the face.
"""

from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.back import back_holes
from stepnc_model.toolpath.hole.feature import Hole
from stepnc_model.toolpath.task import job_of
from tests.every_case import every_case

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"

COMPOUND = (
    "#170=",
    "#600=COUNTERBORE_HOLE('BACK',#30,(),#161,(#601,#610));\n"
    "#601=ROUND_HOLE('HOLE',#30,(),#602,#163,#166,$,#167);\n"
    "#602=AXIS2_PLACEMENT_3D('',#500,#501,#502);\n"
    "#610=ROUND_HOLE('BORE',#30,(),#611,#613,#616,$,#167);\n"
    "#611=AXIS2_PLACEMENT_3D('',#612,#501,#502);\n"
    "#612=CARTESIAN_POINT('',(0.,0.,-30.));\n"
    "#613=PLANE('',#614);\n"
    "#614=AXIS2_PLACEMENT_3D('',#615,#501,#502);\n"
    "#615=CARTESIAN_POINT('',(0.,0.,-10.));\n"
    "#616=TOLERANCED_LENGTH_MEASURE(16.,#512);\n"
    "#170=",
)
FROM_BEHIND = (
    ("#611=AXIS2_PLACEMENT_3D('',#612,#501,", "#611=AXIS2_PLACEMENT_3D('',#612,#505,"),
    ("(0.,0.,-30.)", "(0.,0.,-40.)"),
)
ON_COMPOUND = ("'REAM HOLE 1',#43,#160,", "'REAM HOLE 1',#43,#600,")
ON_BORE = ("'REAM HOLE 1',#43,#160,", "'REAM HOLE 1',#43,#610,")


def holes(*changes: tuple[str, str]) -> list[Hole]:
    """Bores of the first reamed hole's workingstep with some texts replaced."""
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == "REAM HOLE 1")
    return list(back_holes(job_of(program, step)))


@pytest.mark.parametrize("named", [ON_COMPOUND, ON_BORE], ids=["compound", "element"])
@pytest.mark.parametrize("turned", [(), FROM_BEHIND], ids=["from above", "from behind"])
def test_a_bore_is_the_same_from_above_and_from_behind(
    named: tuple[str, str], turned: tuple[tuple[str, str], ...]
) -> None:
    (hole,) = holes(COMPOUND, named, *turned)
    assert int(hole.ref) == 610
    assert hole.top == pytest.approx((110.0, 65.0, -30.0))
    assert hole.depth == pytest.approx(10.0)
    assert hole.diameter == 16.0


@pytest.mark.parametrize("named", [ON_COMPOUND, ON_BORE], ids=["compound", "element"])
def test_the_tool_enters_at_the_top_of_the_compound_feature(named: tuple[str, str]) -> None:
    (hole,) = holes(COMPOUND, named)
    assert hole.entry_z == 0.0


def test_a_compound_feature_may_be_placed_from_behind() -> None:
    """Its placement lies at the back of the part, 40 mm below the face, and points down."""
    changes = (
        (
            "#161=AXIS2_PLACEMENT_3D('HOLE 1',#162,#501,",
            "#161=AXIS2_PLACEMENT_3D('',#162,#505,",
        ),
        ("(110.,65.,0.)", "(110.,65.,-40.)"),
        ("(0.,0.,-30.)", "(0.,0.,0.)"),
    )
    (hole,) = holes(COMPOUND, ON_COMPOUND, *changes)
    assert int(hole.ref) == 610
    assert hole.top == pytest.approx((110.0, 65.0, -30.0))
    assert hole.entry_z == pytest.approx(0.0)


def test_the_widest_of_those_that_open_at_the_back_is_meant() -> None:
    """Both elements end 40 mm below the face."""
    (hole,) = holes(COMPOUND, ON_COMPOUND)
    assert int(hole.ref) == 610


def test_of_two_wide_holes_the_lower_one_is_meant() -> None:
    """A counterbore of 20 mm from above; the hole of 10 mm ends at the bore."""
    front = (
        "(#601,#610)",
        "(#601,#620,#610)",
    )
    wide = (
        "#601=",
        "#620=ROUND_HOLE('FRONT',#30,(),#602,#613,#626,$,#167);\n"
        "#626=TOLERANCED_LENGTH_MEASURE(20.,#512);\n#601=",
    )
    (hole,) = holes(COMPOUND, wide, front, ON_COMPOUND)
    assert int(hole.ref) == 610


def test_a_hole_by_itself_is_entered_above_the_stock() -> None:
    (hole,) = holes()
    assert hole.entry_z == 2.0
    assert hole.top == pytest.approx((110.0, 65.0, 0.0))
    assert hole.depth == pytest.approx(40.0)


@every_case(
    ("changes", "message"),
    [
        (
            (("'REAM HOLE 1',#43,#160,", "'REAM HOLE 1',#43,$,"),),
            "the workingstep has no feature to bore",
        ),
        ((("#162,#501,#502);", "#162,#502,#503);"),), r"axis \(1, 0, 0\)"),
        ((COMPOUND, ON_COMPOUND, ("(#601,#610)", "(#150)")), "no round hole"),
        (
            (("#161,#163,#166,$,#167);\n#161", "#161,$,#166,$,#167);\n#161"),),
            "the bore has no depth",
        ),
    ],
)
def test_what_is_no_bore_is_refused(changes: tuple[tuple[str, str], ...], message: str) -> None:
    with pytest.raises(PathError, match=message):
        holes(*changes)
