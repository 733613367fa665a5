"""Boring from behind, on a hole of the sample bracket: 10 mm through 40 mm at (110, 65).

The bore behind it is 16 mm wide. The tool of 16 mm is 6 mm high above its tip; its bar of 8 mm
stands 16/2 − 10/2 + 0.5 = 3.5 mm beside the axis when its edge clears the hole by 0.5 mm: the
bar would reach 7.5 mm, so that hole of 10 mm needs a bar of 3 mm at most.
"""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.path import Dwell, Move, MoveType, SpindleCommand, ToolPath
from stepnc_model.toolpath.task import job_of
from tests.every_case import every_case
from tests.stepnc_model.places import place_of

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"
EXAMPLE3 = Path(__file__).parents[5] / "shared" / "corpus" / "iso14649" / "EXAMPLE3.stp"

OPERATION = (
    "#214=REAMING($,$,'REAM HOLE 1',5.,$,#460,#312,#330,3.,$,9.8,$,1.,#360,.F.,$,$)",
    "#214=BACK_BORING($,$,'BACK',5.,$,#460,#311,#330,2.,10.,10.,0.5,2.,$)",
)
WIDTH = (
    "#166=TOLERANCED_LENGTH_MEASURE(10.,",
    "#166=TOLERANCED_LENGTH_MEASURE(16.,",
)
TOOL = (
    ("'REAMER 10MM JS7',#461,(#463),110.,$,$)", "'BACK 16MM',#461,(#463),110.,#503,3.)"),
    ("#461=TAPERED_REAMER(#462,6,.RIGHT.,.F.,$,$)", "#461=BACKSIDE_COUNTERBORE(#462,1,$,$,$)"),
    ("#462=MILLING_TOOL_DIMENSION(10.,$,$,45.,", "#462=MILLING_TOOL_DIMENSION(16.,$,$,6.,"),
)
BACK = (OPERATION, WIDTH, *TOOL)


def path_in(text: str, name: str, *changes: tuple[str, str]) -> ToolPath:
    """Path of a workingstep with some texts replaced."""
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="part"))
    (step,) = (step for step in program.workingsteps if step.id == name)
    return hole_path(job_of(program, step))


def path(*changes: tuple[str, str]) -> ToolPath:
    return path_in(BRACKET.read_text(encoding="utf-8"), "REAM HOLE 1", *BACK, *changes)


def test_it_goes_in_beside_the_axis_and_bores_on_it() -> None:
    """The edge points along +y; stock to 2 mm, mouth at −40, 2 mm below it, edge 6 mm up."""
    aside, axis = (110.0, 61.5), (110.0, 65.0)
    assert [move.end for move in path().moves] == [
        pytest.approx(end)
        for end in (
            (*axis, 7.0),
            (*aside, 7.0),
            (*aside, -48.0),
            (*axis, -48.0),
            (*axis, -36.0),
            (*axis, -48.0),
            (*aside, -48.0),
            (*aside, 7.0),
            (*axis, 7.0),
            (*axis, 50.0),
        )
    ]


def test_only_the_way_up_on_the_axis_cuts() -> None:
    cuts = [(a, move.end) for a, move in path().segments() if move.type is MoveType.CONTACT]
    ((start, end),) = cuts
    assert start[:2] == end[:2] == (110.0, 65.0)
    assert end[2] > start[2]


def test_the_spindle_turns_below_the_part_only() -> None:
    found = [step if isinstance(step, SpindleCommand) else None for step in path().steps]
    commands = [step for step in found if step is not None]
    assert commands == [
        SpindleCommand.ORIENT,
        SpindleCommand.START,
        SpindleCommand.ORIENT,
        SpindleCommand.START,
    ]
    steps = path().steps
    first, last = found.index(SpindleCommand.START), len(found) - 1
    last -= [*reversed(found)].index(SpindleCommand.ORIENT)
    assert [type(step) for step in steps[first + 1 : last]] == [Move, Dwell, Move]


def test_no_rapid_goes_below_the_retract_plane() -> None:
    for start, move in path().segments():
        if move.feed is None:
            assert min(start[2], move.end[2]) >= 7.0


def test_it_leaves_at_the_feed_on_retract() -> None:
    (out,) = (move for move in path().moves if move.type is MoveType.RETRACT)
    assert out.feed is not None
    assert out.feed.ratio == 2.0


def test_the_edge_ends_clear_of_the_hole() -> None:
    """However wide the tool: its edge passes 0.5 mm from the wall."""
    for width, size in ((12.0, 1.5), (14.0, 2.5), (16.0, 3.5)):
        change = ("DIMENSION(16.,$,$,6.", f"DIMENSION({width},$,$,6.")
        shifted = path(change).moves[1].end
        assert 65.0 - shifted[1] == pytest.approx(size)
        assert shifted[1] + 0.5 * width == pytest.approx(65.0 + 5.0 - 0.5)


@given(depth=st.floats(0.5, 35.0), passed=st.floats(9.0, 15.0), height=st.floats(0.5, 20.0))
def test_the_edge_meets_the_shoulder_and_never_the_wall(
    depth: float, passed: float, height: float
) -> None:
    found = path(
        ("2.,10.,10.,0.5", f"2.,{depth!r},{passed!r},0.5"),
        (
            "#462=MILLING_TOOL_DIMENSION(16.,$,$,6.,",
            f"#462=MILLING_TOOL_DIMENSION(16.,$,$,{height!r},",
        ),
        ("#503,3.)", "#503,0.5)"),
    )
    top = max(move.end[2] for move in found.moves if move.type is MoveType.CONTACT)
    assert top + height == pytest.approx(-40.0 + depth)
    for start, move in found.segments():
        heights = sorted((start[2] + height, move.end[2] + height))
        if start[:2] == move.end[:2] and heights[0] < 0.0:
            is_in_hole = heights[1] > -40.0 + depth + 1e-9
            reach = start[1] + 8.0 - 65.0
            assert not is_in_hole or reach <= 0.5 * passed - 0.5 + 1e-9


def test_a_cone_sinks_until_it_meets_the_hole() -> None:
    """45 degrees between 16 mm and 10 mm: 3 mm high."""
    found = path(("DIMENSION(16.,$,$,6.", "DIMENSION(16.,45.,$,6."))
    top = max(move.end[2] for move in found.moves if move.type is MoveType.CONTACT)
    assert top == pytest.approx(-30.0 - 3.0)


def test_the_depth_of_the_feature_holds_where_none_is_given() -> None:
    """A bore 12 mm deep, seen from behind."""
    found = path(
        ("2.,10.,10.,0.5", "2.,$,10.,0.5"),
        (
            "#161=AXIS2_PLACEMENT_3D('HOLE 1',#162,#501,",
            "#161=AXIS2_PLACEMENT_3D('HOLE 1',#162,#505,",
        ),
        ("(110.,65.,0.)", "(110.,65.,-40.)"),
        ("(0.,0.,-40.));\n#166", "(0.,0.,-12.));\n#166"),
    )
    top = max(move.end[2] for move in found.moves if move.type is MoveType.CONTACT)
    assert top == pytest.approx(-28.0 - 6.0)


def test_the_drill_before_tells_what_is_passed() -> None:
    """A drill of 9.8 mm."""
    shifted = path(("2.,10.,10.,0.5", "2.,10.,$,0.5"), ("#503,3.)", "#503,2.)")).moves[1].end
    assert 65.0 - shifted[1] == pytest.approx(0.5 * (16.0 - 9.8) + 0.5)


def test_the_narrowest_hole_of_a_compound_feature_is_what_is_passed() -> None:
    """A hole that narrows from 14 mm to 11 mm, whatever its previous diameter was."""
    compound = (
        "#170=",
        "#600=COUNTERBORE_HOLE('BACK',#30,(),#601,(#160,#602));\n"
        "#601=AXIS2_PLACEMENT_3D('',#500,#501,#502);\n"
        "#602=ROUND_HOLE('HOLE',#30,(),#161,#163,#603,#604,#167);\n"
        "#603=TOLERANCED_LENGTH_MEASURE(14.,#512);\n"
        "#604=DIAMETER_TAPER(#605);\n"
        "#605=TOLERANCED_LENGTH_MEASURE(11.,#512);\n#170=",
    )
    for previous in ("$", "13."):
        shifted = path(compound, ("2.,10.,10.,0.5", f"2.,10.,{previous},0.5")).moves[1].end
        assert 65.0 - shifted[1] == pytest.approx(0.5 * (16.0 - 11.0) + 0.5)


def test_the_machine_functions_tell_the_direction_where_the_tool_does_not() -> None:
    found = path(
        ("110.,#503,3.)", "110.,$,3.)"),
        ("(),.T.,$,$,());", "(),.T.,#505,$,());"),
        ("#505=DIRECTION('AGAINST Z',(0.,0.,-1.)", "#505=DIRECTION('',(-1.,0.,0.)"),
    )
    assert found.moves[1].end == pytest.approx((113.5, 65.0, 7.0))
    assert not found.findings


def test_what_the_tool_does_not_say_is_assumed_and_said() -> None:
    found = path(
        ("110.,#503,3.)", "110.,$,$)"), ("DIMENSION(16.,$,$,6.", "DIMENSION(16.,$,$,$")
    )
    assert found.moves[1].end == pytest.approx((106.5, 65.0, 7.0))
    said = [(finding.attribute, finding.severity) for finding in found.findings]
    assert said == [
        ("direction_for_spindle_orientation", Severity.NOTE),
        ("tool_holder_diameter_for_spindle_orientation", Severity.NOTE),
        ("its_tool_body", Severity.WARNING),
    ]


@pytest.mark.parametrize(
    ("change", "attribute"),
    [
        (
            ("'BACK 16MM',#461,(#463),110.", "'BACK 16MM',#461,(#463),40."),
            "overall_assembly_length",
        ),
        (("2.,10.,10.,0.5,2.,$)", "2.,10.,10.,0.5,2.,#361)"), "its_machining_strategy"),
        (("(0.,0.,-40.));\n#166", "(0.,0.,-30.));\n#166"), "depth"),
    ],
)
def test_what_is_odd_is_said(change: tuple[str, str], attribute: str) -> None:
    (finding,) = path(change).findings
    assert finding.attribute == attribute


@every_case(
    ("change", "place", "word"),
    [
        (
            ("2.,10.,10.,0.5", "2.,0.,10.,0.5"),
            "#214.cutting_depth",
            "positive",
        ),
        (("2.,10.,10.,0.5", "2.,43.,10.,0.5"), "#214.cutting_depth", "no shoulder"),
        (("2.,10.,10.,0.5", "2.,10.,-1.,0.5"), "#214.previous_diameter", "-1 mm"),
        (("2.,10.,10.,0.5", "-2.,10.,10.,0.5"), "#214.overcut_length", "-2 mm"),
        (("2.,10.,10.,0.5", "2.,10.,16.,0.5"), "#214.its_tool", "not wider"),
        (
            ("DIMENSION(16.,$", "DIMENSION(18.,$"),
            "#214.its_tool",
            "too wide",
        ),
        (
            ("#503,3.)", "#503,3.1)"),
            "#460.tool_holder_diameter_for_spindle_orientation",
            "3.1 mm",
        ),
        (("#503,3.)", "#503,0.)"), "#460.tool_holder_diameter_for_spindle_orientation", "0 mm"),
        (("110.,#503,3.)", "110.,#501,3.)"), "#501.direction_ratios", "along the axis"),
        (
            ("BACKSIDE_COUNTERBORE(#462,1", "BACKSIDE_COUNTERBORE(#462,2"),
            "#460.its_tool_body",
            "single-edge",
        ),
    ],
)
def test_what_cannot_be_bored_is_refused(
    change: tuple[str, str], place: str, word: str
) -> None:
    with pytest.raises(PathError) as caught:
        path(change)
    assert place_of(caught.value) == place
    assert word in caught.value.rule


def test_a_hole_that_nothing_tells_of_is_refused() -> None:
    text = BRACKET.read_text(encoding="utf-8")
    workplan = ("(#20,#21,#22,#23,#24,#25)", "(#24)")
    with pytest.raises(
        PathError, match=r"previous_diameter: the diameter of the hole that the tool passes"
    ):
        path_in(text, "REAM HOLE 1", *BACK, workplan, ("2.,10.,10.,0.5", "2.,10.,$,0.5"))


def test_the_example_of_the_standard_comes_out_without_its_path() -> None:
    """A sink of 1 mm behind 39 mm of a hole of 40 mm; the tool is 50 mm wide.

    The compound feature's top lies 88.668 mm below the setup's zero.
    """
    if not EXAMPLE3.is_file():
        pytest.skip("no EXAMPLE3.stp beside the project")
    text = EXAMPLE3.read_text(encoding="utf-8")
    name = "BACKSIDE_COUNTERBORING1"
    found = path_in(text, name, ("BACK_BORING(#31,", "BACK_BORING($,"))
    (cut,) = (move for move in found.moves if move.type is MoveType.CONTACT)
    assert cut.end == pytest.approx((155.328, 166.863, -88.668 - 39.0))
    assert cut.end[0] - found.moves[1].end[0] == pytest.approx(0.5 * (50.0 - 40.0) + 0.5)
