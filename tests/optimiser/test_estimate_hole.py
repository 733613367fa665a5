"""Holes of the sample bracket, against numbers worked out by hand."""

from dataclasses import replace
from math import pi, radians, tan
from pathlib import Path

import pytest

from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.feature_estimate import CLEARANCE, hole_cut
from simulator.spec import ToolKind
from stepnc_model.errors import Finding, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import tool_of

PARTS = Path(__file__).parents[2] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"
DRILL_ON_HOLE = "'DRILL HOLE 1',#43,#160,"


def edited(*changes: tuple[str, str], more: str = "") -> Program:
    """The bracket with some texts replaced and instances added."""
    text = (PARTS / "bracket.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(
        Part21File.from_bytes(text.replace(END, f"{more}\n{END}").encode(), name="bracket"),
        name="bracket",
    )


def estimate(program: Program, name: str) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a workingstep at 10 rev/s and 0.1 mm per tooth."""
    (step,) = (step for step in program.workingsteps if step.id == name)
    tool = tool_of(program, step.tool_ref)
    return hole_cut(program, step, tool, speed=10.0, feed=0.1)


def cut_of(program: Program, name: str) -> Cut:
    return estimate(program, name)[0]


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited()


def test_drill_adds_its_point_to_a_through_hole(bracket: Program) -> None:
    """40 mm, clearance, 3 mm of overcut, and D/2·tan 20° of a top angle of 20 degrees."""
    cut = cut_of(bracket, "DRILL HOLE 1")
    point = 0.5 * 9.8 * tan(radians(20.0))
    assert cut.length == pytest.approx(40.0 + CLEARANCE + 3.0 + point)
    assert cut.total_depth == 40.0
    assert cut.kind is CutKind.DRILLING
    assert cut.tool_kind is ToolKind.DRILL


def test_drill_does_not_add_its_point_to_a_blind_hole() -> None:
    program = edited((
        "#167=THROUGH_BOTTOM_CONDITION();",
        "#167=FLAT_HOLE_BOTTOM();",
    ))
    assert cut_of(program, "DRILL HOLE 1").length == pytest.approx(40.0 + CLEARANCE + 3.0)


def test_reamer_has_no_point(bracket: Program) -> None:
    cut = cut_of(bracket, "REAM HOLE 1")
    assert cut.length == pytest.approx(40.0 + CLEARANCE + 3.0)
    assert cut.tool_kind is ToolKind.REAMER


def test_depth_of_the_operation_holds_where_it_is_given(bracket: Program) -> None:
    """A centre hole of 1 mm in a feature of 40 mm."""
    cut = cut_of(bracket, "CENTRE HOLE 1")
    assert cut.total_depth == 1.0
    assert cut.length == pytest.approx(1.0 + CLEARANCE)
    assert cut.tool_kind is ToolKind.CENTER_DRILL


def test_reamer_takes_the_diameter_that_its_operation_gives(bracket: Program) -> None:
    assert cut_of(bracket, "REAM HOLE 1").previous_diameter == 9.8


def test_reamer_takes_the_diameter_of_the_drill_before_it() -> None:
    """Not that of the centre drill, which only marks the hole."""
    program = edited(("#330,3.,$,9.8,$,1.,", "#330,3.,$,$,$,1.,"))
    cut, findings = estimate(program, "REAM HOLE 1")
    assert cut.previous_diameter == 9.8
    assert findings == ()


def test_reamer_into_the_solid_is_said() -> None:
    program = edited(
        ("#330,3.,$,9.8,$,1.,", "#330,3.,$,$,$,1.,"),
        ("(#20,#21,#22,#23,#24,#25)", "(#24,#25)"),
    )
    cut, findings = estimate(program, "REAM HOLE 1")
    assert cut.previous_diameter == 0.0
    (finding,) = findings
    assert "no earlier hole is known" in str(finding)


def test_drill_cuts_into_the_solid_after_a_centre_drill(bracket: Program) -> None:
    cut, findings = estimate(bracket, "DRILL HOLE 1")
    assert cut.previous_diameter == 0.0
    assert findings == ()


def test_drill_widens_the_hole_of_a_smaller_one() -> None:
    """A second drilling of the same hole by 10 mm after 9.8 mm."""
    program = edited(
        (
            "#24=MACHINING_WORKINGSTEP('REAM HOLE 1',#43,#160,#214,$);",
            "#24=MACHINING_WORKINGSTEP('REAM HOLE 1',#43,#160,#900,$);",
        ),
        more="#900=DRILLING($,$,'WIDEN',5.,$,#460,#311,#330,3.,$,$,$,$,#361);",
    )
    assert cut_of(program, "REAM HOLE 1").previous_diameter == 9.8


def test_hole_is_one_pass_whose_depth_is_given(bracket: Program) -> None:
    cut = cut_of(bracket, "DRILL HOLE 2")
    assert (cut.programmed.passes, cut.is_depth_free) == (1, False)


def test_drill_returns_at_rapid_through_the_hole(bracket: Program) -> None:
    cut = cut_of(bracket, "REAM HOLE 1")
    assert cut.link_length == pytest.approx(cut.length + 2.0 * 5.0)


@pytest.mark.parametrize(
    ("pattern", "count"),
    [
        ("GENERAL_PATTERN('',#30,(#212),#41,#160,(#171,#161))", 3),
        ("CIRCULAR_PATTERN('',#30,(#212),#41,#160,60.,6,(),(),$,0.)", 6),
    ],
)
def test_pattern_repeats_the_hole(pattern: str, count: int) -> None:
    blind = ("#167=THROUGH_BOTTOM_CONDITION();", "#167=FLAT_HOLE_BOTTOM();")
    program = edited(
        blind, (DRILL_ON_HOLE, "'DRILL HOLE 1',#43,#900,"), more=f"#900={pattern};"
    )
    single = cut_of(edited(blind), "DRILL HOLE 1")
    cut = cut_of(program, "DRILL HOLE 1")
    assert cut.length == pytest.approx(count * single.length)
    assert cut.link_length == pytest.approx(count * single.link_length)


def test_pointed_drill_of_118_degrees_adds_0_3_of_its_diameter(bracket: Program) -> None:
    """Customary rule: 0.3 D."""
    (step,) = (step for step in bracket.workingsteps if step.id == "DRILL HOLE 1")
    tool = replace(tool_of(bracket, step.tool_ref), point_angle=118.0 * pi / 180.0)
    cut, _ = hole_cut(bracket, step, tool, speed=10.0, feed=0.1)
    assert cut.length == pytest.approx(45.0 + 0.3 * 9.8, abs=0.01)


def test_workingstep_without_feature_is_an_error() -> None:
    program = edited((DRILL_ON_HOLE, "'DRILL HOLE 1',#43,$,"))
    with pytest.raises(SchemaError, match="no feature"):
        cut_of(program, "DRILL HOLE 1")
