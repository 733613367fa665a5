"""Holes as the file says them: elements of compound holes, tapers, tolerances.

A counterbored hole at (30, 40, 0): 16 mm wide and 8 mm deep, below it 9 mm wide and 20 mm deep.
"""

from pathlib import Path

import pytest

from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.feature import DEFAULT_TOLERANCE, Hole, holes_of
from stepnc_model.toolpath.hole.operation import hole_path
from stepnc_model.toolpath.task import ToolPathTask, job_of

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"
COUNTERBORE = (
    "#600=COUNTERBORE_HOLE('CB',#30,(),#601,(#603,#610));\n"
    "#601=AXIS2_PLACEMENT_3D('',#602,$,$);\n#602=CARTESIAN_POINT('',(30.,40.,0.));\n"
    "#603=ROUND_HOLE('WIDE',#30,(),#604,#606,#609,$,#608);\n"
    "#604=AXIS2_PLACEMENT_3D('',#605,$,$);\n#605=CARTESIAN_POINT('',(0.,0.,0.));\n"
    "#606=PLANE('',#607);\n#607=AXIS2_PLACEMENT_3D('',#620,$,$);\n"
    "#608=FLAT_HOLE_BOTTOM();\n#609=TOLERANCED_LENGTH_MEASURE(16.,#512);\n"
    "#610=ROUND_HOLE('NARROW',#30,(),#611,#613,#616,$,#167);\n"
    "#611=AXIS2_PLACEMENT_3D('',#620,$,$);\n"
    "#613=PLANE('',#614);\n#614=AXIS2_PLACEMENT_3D('',#615,$,$);\n"
    "#615=CARTESIAN_POINT('',(0.,0.,-20.));\n#616=TOLERANCED_LENGTH_MEASURE(9.,#510);\n"
    "#620=CARTESIAN_POINT('',(0.,0.,-8.));\n"
    "#160=ROUND_HOLE('HOLE 1',"
)
TAPER = ("#609,$,#608", "#609,#630,#608")


def job_for(
    feature: int, *changes: tuple[str, str], diameter: str = "8.5", operation: str = "DRILLING"
) -> ToolPathTask:
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in (
        ("#160=ROUND_HOLE('HOLE 1',", COUNTERBORE),
        ("'DRILL HOLE 1',#43,#160,", f"'DRILL HOLE 1',#43,#{feature},"),
        ("DIMENSION(9.8,20.,$,60.", f"DIMENSION({diameter},20.,$,60."),
        ("#212=DRILLING(", f"#212={operation}("),
        *changes,
    ):
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == "DRILL HOLE 1")
    return job_of(program, step)


def hole(job: ToolPathTask) -> Hole:
    operation = job.step.operation
    assert isinstance(operation, DrillingTypeOperation)
    (found,) = holes_of(job, operation)
    return found


class TestCompound:
    def test_a_drill_makes_the_narrowest_hole_that_it_fits_into(self) -> None:
        found = hole(job_for(600))
        assert found.diameter == 9.0
        assert found.top == (30.0, 40.0, 0.0)
        assert found.depth == 28.0
        assert found.is_through

    def test_a_wider_tool_makes_the_counterbore(self) -> None:
        found = hole(job_for(600, diameter="16."))
        assert (found.diameter, found.depth, found.is_through) == (16.0, 8.0, False)

    def test_a_tool_wider_than_both_is_measured_against_the_widest(self) -> None:
        assert hole(job_for(600, diameter="20.")).diameter == 16.0

    def test_a_counterbore_makes_the_counterbore_though_it_fits_into_neither(self) -> None:
        body = ("#451=TWIST_DRILL(", "#451=COUNTERBORE(")
        assert hole(job_for(600, body, diameter="8.")).diameter == 16.0

    def test_a_countersink_makes_the_tapered_element(self) -> None:
        taper = ("#160=", "#630=ANGLE_TAPER(41.);\n#160=")
        found = hole(job_for(600, TAPER, taper, operation="COUNTER_SINKING"))
        assert (found.diameter, found.is_tapered) == (16.0, True)

    def test_a_centre_drill_marks_the_uppermost(self) -> None:
        assert hole(job_for(600, operation="CENTER_DRILLING")).diameter == 16.0

    def test_an_element_that_is_named_itself_counts_its_depth_from_its_own_top(self) -> None:
        found = hole(job_for(610))
        assert found.top == (30.0, 40.0, -8.0)
        assert found.depth == 20.0

    def test_the_retract_plane_of_an_element_lies_above_its_compound(self) -> None:
        assert hole(job_for(610)).entry_z == 0.0
        assert hole_path(job_for(610)).moves[0].end == (30.0, 40.0, 5.0)

    def test_a_compound_without_round_holes_is_refused(self) -> None:
        change = ("(#603,#610)", "(#140)")
        with pytest.raises(PathError, match="no round hole among its elements"):
            hole(job_for(600, change))


class TestTaper:
    @pytest.mark.parametrize(
        ("taper", "narrowest"),
        [
            ("ANGLE_TAPER(45.)", 0.0),
            ("ANGLE_TAPER(26.56505117707799)", 8.0),
            ("ANGLE_TAPER(135.)", 16.0),
            ("DIAMETER_TAPER(#616)", 9.0),
        ],
    )
    def test_it_narrows_to_the_depth_plane(self, taper: str, narrowest: float) -> None:
        """tan 26.565° = 1/2: 16 − 2·8·1/2."""
        change = ("#160=", f"#630={taper};\n#160=")
        found = hole(job_for(603, TAPER, change))
        assert found.narrowest == pytest.approx(narrowest, abs=1e-9)


def test_the_tolerance_is_the_upper_limit_of_the_diameter() -> None:
    assert hole(job_for(610)).tolerance == 0.1


def test_no_tolerance_is_the_default() -> None:
    change = ("MEASURE(9.,#510)", "MEASURE(9.,$)")
    assert hole(job_for(610, change)).tolerance == DEFAULT_TOLERANCE


def test_a_pocket_is_drilled_at_its_centre_down_to_its_floor() -> None:
    found = hole(job_for(140))
    assert found.top == (42.0, 45.0, 0.0)
    assert (found.depth, found.diameter, found.is_through) == (12.0, None, False)


def test_a_positive_depth_means_the_same() -> None:
    change = ("#620=CARTESIAN_POINT('',(0.,0.,-8.))", "#620=CARTESIAN_POINT('',(0.,0.,8.))")
    assert hole(job_for(603, change)).depth == 8.0


@pytest.mark.parametrize("diameter", ["0.", "-9."])
def test_a_diameter_that_is_not_positive_is_refused(diameter: str) -> None:
    with pytest.raises(PathError, match=r"#610 .*diameter: .*must be positive"):
        hole(job_for(610, ("MEASURE(9.,#510)", f"MEASURE({diameter},#510)")))
