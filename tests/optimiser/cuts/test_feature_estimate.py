"""Milling cuts estimated from the sample bracket, against numbers worked out by hand."""

from math import pi, sqrt
from pathlib import Path

import pytest

from optimiser.cuts.cut import Cut, Texture
from optimiser.cuts.feature_estimate import (
    DEFAULT_SIDE_ALLOWANCE,
    earlier_operations,
    milling_cut,
    passes_for,
    ratio,
)
from simulator.physics.engagement import bilateral, full_immersion, unidirectional
from simulator.spec import ToolKind
from stepnc_model.errors import Finding, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import tool_of
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "", name: str = "bracket") -> Program:
    """A sample part with some texts replaced and instances added."""
    text = (PARTS / f"{name}.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(
        Part21File.from_bytes(text.replace(END, f"{more}\n{END}").encode(), name=name),
        name=name,
    )


def estimate(program: Program, name: str) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a workingstep at 10 rev/s and 0.1 mm per tooth."""
    (step,) = (step for step in program.workingsteps if step.id == name)
    tool = tool_of(program, step.tool_ref)
    return milling_cut(program, step, tool, speed=10.0, feed=0.1)


def cut_of(program: Program, name: str) -> Cut:
    return estimate(program, name)[0]


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited()


def test_radial_width_is_the_diameter_less_the_overlap(bracket: Program) -> None:
    """63 mm with a quarter of overlap; 10 mm with half."""
    assert cut_of(bracket, "ROUGH FACE").radial_width == pytest.approx(63.0 * 0.75)
    assert cut_of(bracket, "ROUGH OPEN POCKET").radial_width == pytest.approx(5.0)


def test_overlap_in_percent_is_read_as_a_ratio() -> None:
    program = edited((
        "#350=BIDIRECTIONAL_MILLING(0.25,",
        "#350=BIDIRECTIONAL_MILLING(25.,",
    ))
    assert cut_of(program, "ROUGH FACE").radial_width == pytest.approx(63.0 * 0.75)


@every_case(
    ("written", "read"),
    [(0.0, 0.0), (0.25, 0.25), (25.0, 0.25), (80.0, 0.8), (-0.1, 0.0), (100.0, 0.95)],
)
def test_overlap_stays_a_ratio_below_one(written: float, read: float) -> None:
    assert ratio(written) == pytest.approx(read)


def test_radial_depth_of_the_operation_holds_where_it_is_less() -> None:
    """Half of 12 mm is 6 mm; the operation asks for 4."""
    program = edited(("4.,6.,0.3,0.2", "4.,4.,0.3,0.2"))
    assert cut_of(program, "ROUGH POCKET").radial_width == 4.0


def test_no_cut_is_wider_than_its_feature(bracket: Program) -> None:
    assert cut_of(bracket, "MILL SLOT").radial_width == 12.0


def test_centre_milling_of_a_slot_is_a_full_immersion(bracket: Program) -> None:
    assert cut_of(bracket, "MILL SLOT").engagement == full_immersion()


def test_narrow_slot_is_cut_by_the_middle_of_the_mill() -> None:
    program = edited((
        "#137=TOLERANCED_LENGTH_MEASURE(12.,",
        "#137=TOLERANCED_LENGTH_MEASURE(8.,",
    ))
    cut = cut_of(program, "MILL SLOT")
    assert cut.radial_width == 8.0
    assert cut.engagement == bilateral(8.0, 12.0)


def test_strip_of_a_face_is_cut_by_one_side_of_the_mill(bracket: Program) -> None:
    assert cut_of(bracket, "ROUGH FACE").engagement == unidirectional(47.25, 63.0)


def test_depth_of_roughing_leaves_the_allowance(bracket: Program) -> None:
    face, pocket = cut_of(bracket, "ROUGH FACE"), cut_of(bracket, "ROUGH POCKET")
    assert face.total_depth == pytest.approx(2.0 - 0.5)
    assert pocket.total_depth == pytest.approx(12.0 - 0.2)
    assert pocket.programmed.passes == 3


def test_finish_of_a_face_takes_what_roughing_left(bracket: Program) -> None:
    cut = cut_of(bracket, "FINISH FACE")
    assert cut.total_depth == pytest.approx(0.5)
    assert (cut.programmed.depth, cut.programmed.passes) == (0.5, 1)


def test_finish_of_a_face_without_roughing_takes_all_of_it() -> None:
    program = edited(("#3=WORKPLAN('OUTSIDE',(#10,#11,", "#3=WORKPLAN('OUTSIDE',(#11,"))
    assert cut_of(program, "FINISH FACE").total_depth == pytest.approx(2.0)


def test_finish_of_a_wall_takes_what_roughing_left(bracket: Program) -> None:
    cut = cut_of(bracket, "FINISH CONTOUR")
    assert cut.radial_width == pytest.approx(0.3)
    assert cut.texture is Texture.WALL
    assert not cut.is_depth_free


def test_finish_of_a_wall_that_nobody_roughed_takes_the_customary_width() -> None:
    program = edited(("(#10,#11,#12,#13)", "(#10,#11,#13)"))
    assert cut_of(program, "FINISH CONTOUR").radial_width == DEFAULT_SIDE_ALLOWANCE


def test_floor_of_a_bottom_and_side_finish_takes_what_roughing_left(bracket: Program) -> None:
    """0.2 mm, half of 10 mm wide, over 60 x 50 mm less the island; swept once."""
    cut = cut_of(bracket, "FINISH POCKET")
    floor = cut.floor
    assert floor is not None
    assert floor.total_depth == pytest.approx(0.2)
    assert floor.radial_width == pytest.approx(5.0)
    assert floor.length == pytest.approx((3000.0 - pi * 64.0) / 5.0)
    assert floor.engagement == unidirectional(5.0, 10.0)


def test_walls_of_a_bottom_and_side_finish_are_followed(bracket: Program) -> None:
    cut = cut_of(bracket, "FINISH POCKET")
    wall = 220.0 + 16.0 * pi
    assert cut.length == pytest.approx(wall + 2.0 * sqrt(0.3 * 9.7))
    assert cut.total_depth == pytest.approx(12.0)


def test_finish_has_no_floor_where_roughing_left_nothing() -> None:
    program = edited(("4.,6.,0.3,0.2", "4.,6.,0.3,0."))
    assert cut_of(program, "FINISH POCKET").floor is None


def test_roughing_has_no_floor_of_its_own(bracket: Program) -> None:
    assert cut_of(bracket, "ROUGH POCKET").floor is None


def test_open_face_is_swept_with_approach_and_overrun(bracket: Program) -> None:
    """156 mm need four strokes of 47.25 mm; A = (63 − √(63² − 47.25²))/2 at both ends."""
    approach = 0.5 * (63.0 - sqrt(63.0**2 - 47.25**2))
    expected = 96.0 * 156.0 / 47.25 + 4 * 2.0 * approach
    assert cut_of(bracket, "ROUGH FACE").length == pytest.approx(expected)


def test_closed_pocket_is_swept_without_approach(bracket: Program) -> None:
    expected = (3000.0 - pi * 64.0) / 6.0
    assert cut_of(bracket, "ROUGH POCKET").length == pytest.approx(expected)


def test_contour_is_followed_with_approach_and_overrun(bracket: Program) -> None:
    outline = 400.0 + 40.0 * sqrt(2.0)
    expected = outline + 2.0 * sqrt(2.7 * (20.0 - 2.7))
    assert cut_of(bracket, "ROUGH CONTOUR").length == pytest.approx(expected)


def test_paper_002_is_one_stroke_of_318_mm() -> None:
    """300 mm with an approach and an overrun of half of 18 mm."""
    cut = cut_of(edited(name="paper002"), "ROUGH THE FACE")
    assert cut.length == pytest.approx(300.0 + 18.0)
    assert cut.engagement == full_immersion()
    assert (cut.programmed.depth, cut.programmed.passes) == (3.0, 1)


def test_pattern_repeats_the_length() -> None:
    program = edited(
        (
            "#16=MACHINING_WORKINGSTEP('ROUGH POCKET',#43,#140,",
            "#16=MACHINING_WORKINGSTEP('ROUGH POCKET',#43,#900,",
        ),
        more="#900=CIRCULAR_PATTERN('',#30,(#206),#41,#140,60.,6,(),(),$,0.);",
    )
    single = cut_of(edited(), "ROUGH POCKET")
    assert cut_of(program, "ROUGH POCKET").length == pytest.approx(6.0 * single.length)


def test_each_pass_goes_to_the_retract_plane_and_back(bracket: Program) -> None:
    assert cut_of(bracket, "ROUGH FACE").link_length == pytest.approx(2.0 * 10.0)


def test_missing_depth_of_cut_is_assumed_and_said() -> None:
    """8 mm with a cutting edge of 40 mm: one pass."""
    program = edited(("     4.,12.,0.,0.);", "     $,12.,0.,0.);"))
    cut, findings = estimate(program, "MILL STEP")
    assert (cut.programmed.depth, cut.programmed.passes) == (8.0, 1)
    (finding,) = findings
    assert "no axial_cutting_depth: 8 mm assumed" in str(finding)


def test_what_is_written_is_not_assumed(bracket: Program) -> None:
    for step in bracket.workingsteps[:10]:
        assert estimate(bracket, step.id)[1] == ()


def test_allowance_that_leaves_everything_is_an_error() -> None:
    program = edited(("#340,#340,#350,1.5,0.5);", "#340,#340,#350,1.5,2.);"))
    with pytest.raises(SchemaError, match=r"allowance 2 mm on a depth of 2 mm: nothing is"):
        cut_of(program, "ROUGH FACE")


def test_workingstep_without_feature_is_an_error() -> None:
    program = edited(("'ROUGH FACE',#43,#100,", "'ROUGH FACE',#43,$,"))
    with pytest.raises(SchemaError, match="no feature"):
        cut_of(program, "ROUGH FACE")


def test_face_mill_marks_by_one_high_tooth_and_end_mill_by_all(bracket: Program) -> None:
    face, pocket = cut_of(bracket, "FINISH FACE"), cut_of(bracket, "ROUGH POCKET")
    assert (face.tool_kind, face.texture) == (ToolKind.FACEMILL, Texture.CORNER_PER_REVOLUTION)
    assert face.corner_radius == 0.8
    assert (pocket.tool_kind, pocket.texture) == (ToolKind.ENDMILL, Texture.CORNER_PER_TOOTH)
    assert pocket.corner_radius == 0.2


def test_sharp_corner_leaves_a_floor_that_the_feed_does_not_describe() -> None:
    cut = cut_of(edited(name="paper002"), "ROUGH THE FACE")
    assert cut.texture is Texture.NONE


def test_last_operation_on_a_feature_leaves_the_surface(bracket: Program) -> None:
    leaves = {
        step.id: cut_of(bracket, step.id).is_finishing for step in bracket.workingsteps[:10]
    }
    assert not leaves["ROUGH FACE"]
    assert not leaves["ROUGH POCKET"]
    assert leaves["FINISH FACE"]
    assert leaves["FINISH CONTOUR"]
    assert leaves["MILL STEP"]


def test_tool_cuts_no_deeper_than_its_edge(bracket: Program) -> None:
    assert cut_of(bracket, "ROUGH POCKET").depth_bound == 26.0


@pytest.mark.parametrize(
    ("total", "depth", "passes"),
    [(10.0, 10.0, 1), (10.0, 5.0, 2), (10.0, 4.9, 3), (0.3, 0.1, 3), (1.0, 99.0, 1)],
)
def test_passes_are_no_deeper_than_programmed(total: float, depth: float, passes: int) -> None:
    assert passes_for(total, depth) == passes


def test_earlier_operations_are_those_before_on_the_same_feature(bracket: Program) -> None:
    (reaming,) = (step for step in bracket.workingsteps if step.id == "REAM HOLE 1")
    names = [step.id for step, _ in earlier_operations(bracket, reaming)]
    assert names == ["CENTRE HOLE 1", "DRILL HOLE 1"]
