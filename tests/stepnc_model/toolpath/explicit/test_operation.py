"""Tool paths of the file, as given: workingsteps, copies of a pattern, rapid movements."""

import pytest

from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.explicit.operation import explicit_path, rapid_movement_path
from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.task import job_of

FILE = """ISO-10303-21;
HEADER;
FILE_SCHEMA(('MACHINING_SCHEMA'));
ENDSEC;
DATA;
#1=PROJECT('P',#2,(),$,$,$);
#2=WORKPLAN('W',(#3,#4,#5,#6),$,$,$);
#3=MACHINING_WORKINGSTEP('CUT',#40,#20,#10,$);
#4=RAPID_MOVEMENT('AWAY',#40,#15,$);
#5=RETURN_HOME('HOME',#40,$,$);
#6=RAPID_MOVEMENT('NOTHING',#40,#18,$);
#10=FREEFORM_OPERATION(#11,$,'CUT',10.,$,#50,#60,#61,$,$,$,$);
#11=TOOLPATH_LIST((#12));
#12=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#13,$,$);
#13=POLYLINE('',(#30,#31));
#15=TOOLPATH_LIST((#16));
#16=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,#60,$,$,#17,$,$);
#17=TRIMMED_CURVE('',#35,(#30),(#32),.T.,.CARTESIAN.);
#18=TOOLPATH_LIST(());
#20=TOOLPATH_FEATURE('T',$,(),#21,$);
#21=AXIS2_PLACEMENT_3D('',#22,$,#33);
#22=CARTESIAN_POINT('',(100.,0.,10.));
#23=GENERAL_PATTERN('TWO',$,(),#24,#20,(#21,#25));
#24=AXIS2_PLACEMENT_3D('',#34,$,$);
#25=AXIS2_PLACEMENT_3D('',#26,$,$);
#26=CARTESIAN_POINT('',(0.,50.,10.));
#30=CARTESIAN_POINT('',(5.,0.,-2.));
#31=CARTESIAN_POINT('',(8.,0.,-2.));
#32=CARTESIAN_POINT('',(0.,5.,-2.));
#33=DIRECTION('',(0.,1.,0.));
#34=CARTESIAN_POINT('',(0.,0.,0.));
#35=CIRCLE('',#36,5.);
#36=AXIS2_PLACEMENT_3D('',#37,$,$);
#37=CARTESIAN_POINT('',(0.,0.,-2.));
#40=PLANE('SECURITY',#41);
#41=AXIS2_PLACEMENT_3D('',#42,$,$);
#42=CARTESIAN_POINT('',(0.,0.,30.));
#50=MILLING_CUTTING_TOOL('MILL',#51,(),$,$,$);
#51=ENDMILL(#52,4,.RIGHT.,.F.,$);
#52=MILLING_TOOL_DIMENSION(10.,$,$,22.,$,$,$);
#60=MILLING_TECHNOLOGY(0.01,.TCP.,$,-10.,$,.F.,.F.,.F.,$);
#61=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());
ENDSEC;
END-ISO-10303-21;
"""


def edited(*changes: tuple[str, str]) -> Program:
    text = FILE
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode()))


def cut(*changes: tuple[str, str]) -> ToolPath:
    program = edited(*changes)
    return explicit_path(job_of(program, program.workingsteps[0]))


def moved(name: str, *changes: tuple[str, str]) -> ToolPath | None:
    program = edited(*changes)
    (executable,) = (each for each in program.executables if each.id == name)
    return rapid_movement_path(program, executable)


def test_a_trajectory_lies_in_the_coordinates_of_its_feature() -> None:
    """Feature at (100, 0, 10), its x along y."""
    found = cut()
    assert found.start == pytest.approx((100.0, 5.0, 8.0))
    assert found.end == pytest.approx((100.0, 8.0, 8.0))


def test_nothing_is_added_to_it() -> None:
    (step,) = cut().steps
    (move,) = cut().moves
    assert step == move
    assert move.type is MoveType.CONTACT


def test_it_tells_whose_path_it_is() -> None:
    found = cut()
    assert (int(found.workingstep), found.id, int(found.operation_ref)) == (3, "CUT", 10)
    assert (found.tool_ref, found.technology_ref, found.functions_ref) == (50, 60, 61)
    assert not found.is_turning


def test_every_copy_of_a_pattern_is_cut() -> None:
    """The second one at (0, 50, 10) and not turned."""
    found = cut(("'CUT',#40,#20", "'CUT',#40,#23"))
    ends = [move.end for move in found.moves if move.type is MoveType.CONTACT]
    assert ends == [pytest.approx((100.0, 8.0, 8.0)), pytest.approx((8.0, 50.0, 8.0))]
    assert max(move.end[2] for move in found.moves) == 30.0


def test_without_a_feature_it_lies_in_those_of_the_workpiece() -> None:
    assert cut(("'CUT',#40,#20", "'CUT',#40,$")).start == (5.0, 0.0, -2.0)


def test_an_operation_without_path_is_refused() -> None:
    with pytest.raises(PathError, match=r"#10 .*its_toolpath: has no explicit tool path"):
        cut(("FREEFORM_OPERATION(#11", "FREEFORM_OPERATION($"))


def test_a_path_that_leads_nowhere_is_refused() -> None:
    with pytest.raises(PathError, match="the tool path contains no moves"):
        cut(("TOOLPATH_LIST((#12))", "TOOLPATH_LIST(())"))


def test_a_reference_that_is_no_tool_path_is_refused() -> None:
    with pytest.raises(SchemaError, match=r"#11|#50"):
        cut(("TOOLPATH_LIST((#12))", "TOOLPATH_LIST((#50))"))


class TestRapidMovement:
    def test_it_lies_in_the_coordinates_of_the_setup(self) -> None:
        found = moved("AWAY")
        assert found is not None
        assert found.start == (5.0, 0.0, -2.0)
        assert found.end == (0.0, 5.0, -2.0)

    def test_all_of_it_is_rapid_whatever_it_says(self) -> None:
        found = moved("AWAY")
        assert found is not None
        assert {move.type for move in found.moves} == {MoveType.RAPID}
        assert {move.feed for move in found.moves} == {None}

    def test_an_arc_becomes_chords_for_no_control_has_rapid_arcs(self) -> None:
        found = moved("AWAY")
        assert found is not None
        assert len(found.moves) > 10
        for move in found.moves:
            x, y, _ = move.end
            assert move.arc is None
            assert x * x + y * y == pytest.approx(25.0)

    def test_it_has_no_tool_and_no_technology_of_its_own(self) -> None:
        found = moved("AWAY")
        assert found is not None
        assert (found.tool_ref, found.technology_ref, found.functions_ref) == (None, None, None)
        assert found.workingstep == found.operation_ref == 4

    def test_one_without_path_is_left_to_the_control(self) -> None:
        assert moved("HOME") is None

    def test_one_whose_path_is_empty_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"#6 .*contains no moves"):
            moved("NOTHING")

    def test_a_workingstep_is_none(self) -> None:
        with pytest.raises(PathError, match=r"#3 .*is not a rapid movement"):
            moved("CUT")
