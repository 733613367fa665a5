"""Turning of the sample shaft, against numbers worked out by hand.

Bar of 60 mm that stands 2 mm in front; contour from a radius of 13.5 mm to a collar of 27 mm
at z = -80 mm, 30 mm long; groove from 30 down to 25 mm, 4 mm wide.
"""

from math import pi
from pathlib import Path

import pytest

from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.cuts.feature_cuts import CLEARANCE, FALLBACK_DEPTH, mean_diameter, turning_cut
from simulator.spec import ToolKind
from stepnc_model.errors import Finding, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_of

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def edited(*changes: tuple[str, str]) -> Program:
    """The shaft with some texts replaced."""
    text = (PARTS / "shaft.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="shaft"), name="shaft")


def estimate(program: Program, name: str) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a workingstep at 10 rev/s and 0.1 mm per revolution."""
    (step,) = (step for step in program.workingsteps if step.id == name)
    tool = tool_of(program, step.tool_ref)
    return turning_cut(program, step, tool, speed=10.0, feed=0.1)


def cut_of(program: Program, name: str) -> Cut:
    return estimate(program, name)[0]


@pytest.fixture(scope="module")
def shaft() -> Program:
    return edited()


def test_contour_is_roughed_from_the_bar_to_the_feature(shaft: Program) -> None:
    """30 − 13.5 − 0.5 mm in passes of 2 mm."""
    cut = cut_of(shaft, "ROUGH CONTOUR")
    assert cut.total_depth == pytest.approx(30.0 - 13.5 - 0.5)
    assert (cut.programmed.depth, cut.programmed.passes) == (2.0, 8)
    assert cut.is_depth_free


def test_contour_is_as_long_as_its_features_together(shaft: Program) -> None:
    """80 mm of contour and 30 mm of collar, clearance, 1 mm of overcut."""
    cut = cut_of(shaft, "ROUGH CONTOUR")
    assert cut.length == pytest.approx(80.0 + 30.0 + CLEARANCE + 1.0)
    assert cut.link_length == pytest.approx(110.0 + 2.0 * 5.0)


def test_finish_of_a_contour_takes_what_roughing_left(shaft: Program) -> None:
    cut = cut_of(shaft, "FINISH CONTOUR")
    assert cut.total_depth == pytest.approx(0.5)
    assert cut.programmed.passes == 1
    assert not cut.is_depth_free
    assert cut.is_finishing


def test_face_is_roughed_from_the_front_of_the_bar(shaft: Program) -> None:
    """The bar reaches to −150 + 152 = 2 mm; 0.5 mm stay."""
    cut = cut_of(shaft, "ROUGH FACE")
    assert cut.total_depth == pytest.approx(2.0 - 0.5)
    assert cut.length == pytest.approx(30.0 + CLEARANCE + 1.0)


def test_finish_of_a_face_takes_what_roughing_left(shaft: Program) -> None:
    assert cut_of(shaft, "FINISH FACE").total_depth == pytest.approx(0.5)


def test_groove_is_made_by_plunges_as_wide_as_the_insert(shaft: Program) -> None:
    """4 mm with an insert of 3 mm: two plunges from 15 to 12.5 mm."""
    cut = cut_of(shaft, "THREAD RELIEF")
    assert cut.kind is CutKind.GROOVING
    assert cut.tool_kind is ToolKind.GROOVING
    assert cut.programmed.passes == 2
    assert cut.programmed.depth == pytest.approx(15.0 - 12.5)
    assert cut.length == pytest.approx(2.5 + CLEARANCE)
    assert cut.radial_width == 3.0
    assert not cut.is_depth_free


def test_groove_as_wide_as_the_insert_is_one_plunge() -> None:
    program = edited((
        "#134=TOLERANCED_LENGTH_MEASURE(4.,",
        "#134=TOLERANCED_LENGTH_MEASURE(3.,",
    ))
    assert cut_of(program, "THREAD RELIEF").programmed.passes == 1


def test_mean_diameter_is_half_way_through_what_is_removed(shaft: Program) -> None:
    """Bar of 60 mm and neck of 27 mm; face from 0 to 60 mm; groove from 30 to 25 mm."""
    diameters = {step.id: mean_diameter(shaft, step) for step in shaft.workingsteps}
    assert diameters["ROUGH CONTOUR"] == pytest.approx(0.5 * (60.0 + 27.0))
    assert diameters["ROUGH FACE"] == pytest.approx(30.0)
    assert diameters["THREAD RELIEF"] == pytest.approx(27.5)


def test_cutting_speed_is_kept_at_the_mean_diameter(shaft: Program) -> None:
    (step,) = (step for step in shaft.workingsteps if step.id == "ROUGH CONTOUR")
    diameter = mean_diameter(shaft, step)
    speed = programmed(shaft, step.technology_ref).spindle_speed(diameter)
    assert pi * diameter * speed == pytest.approx(2500.0)


def test_insert_marks_the_surface_with_its_nose(shaft: Program) -> None:
    cut = cut_of(shaft, "FINISH CONTOUR")
    assert cut.texture is Texture.CORNER_PER_REVOLUTION
    assert cut.corner_radius == 0.8


def test_insert_cuts_no_deeper_than_it_may(shaft: Program) -> None:
    assert cut_of(shaft, "ROUGH CONTOUR").depth_bound == 6.0


def test_depth_without_strategy_is_all_at_once() -> None:
    program = edited((
        "UNIDIRECTIONAL_TURNING(1.,.T.,(2.),",
        "UNIDIRECTIONAL_TURNING(1.,.T.,(),",
    ))
    cut = cut_of(program, "ROUGH CONTOUR")
    assert (cut.programmed.depth, cut.programmed.passes) == (16.0, 1)


def test_without_a_bar_the_depth_is_assumed_and_said() -> None:
    program = edited(
        ("0.02,$,$,#33,(#36)", "0.02,$,$,$,(#36)"),
        ("UNIDIRECTIONAL_TURNING(1.,.T.,(1.5),", "UNIDIRECTIONAL_TURNING(1.,.T.,(),"),
    )
    cut, findings = estimate(program, "ROUGH FACE")
    assert cut.total_depth == FALLBACK_DEPTH
    (finding,) = findings
    assert "cannot be derived from the bar: 1 mm assumed" in str(finding)


def test_without_a_bar_the_strategy_says_the_depth() -> None:
    program = edited(("0.02,$,$,#33,(#36)", "0.02,$,$,$,(#36)"))
    assert cut_of(program, "ROUGH FACE").total_depth == 1.5


def test_operation_without_a_cutting_model_is_an_error(shaft: Program) -> None:
    with pytest.raises(SchemaError, match="threading_rough: no cutting model"):
        cut_of(shaft, "THREAD M30 X 2")


def test_groove_needs_the_width_of_its_insert() -> None:
    program = edited((".RIGHT.,3.,12.,0.2,$,$);", ".RIGHT.,$,12.,0.2,$,$);"))
    with pytest.raises(SchemaError, match="cutting width"):
        cut_of(program, "THREAD RELIEF")
