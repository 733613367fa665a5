"""Instances of a file become entities; what deviates from the schema is said."""

from pathlib import Path

import pytest

from stepnc_model.entities.adaptive import AdaptiveMillingTechnology
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import SpeedName, StrokeConnectionStrategy, ToolReferencePoint
from stepnc_model.entities.executables import Workplan
from stepnc_model.entities.geometry import CartesianPoint, ElementarySurface, Plane
from stepnc_model.entities.milling import (
    BackBoring,
    BidirectionalMilling,
    BottomAndSideRoughMilling,
    Drilling,
    PlaneFinishMilling,
    Tapping,
)
from stepnc_model.entities.operations import CutterLocationTrajectory, MachiningOperation
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.tools import BoringTool, CuttingComponent, MillingCuttingTool
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Value
from stepnc_model.programs.binding import Model, bind, to_parameters

CORPUS = Path(__file__).parents[4] / "shared" / "corpus"
FILES = sorted(path for path in CORPUS.rglob("*") if path.suffix in {".stp", ".p21", ".stpnc"})

needs_corpus = pytest.mark.skipif(not FILES, reason="no corpus beside the project")


def model_of(*instances: str) -> Model:
    body = "\n".join(instances)
    text = (
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
        f"{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    return Model(Part21File.from_bytes(text.encode()))


def only_finding(model: Model) -> Finding:
    (finding,) = model.findings()
    return finding


POINT = "#1=CARTESIAN_POINT('P',(0.,1.,2.5));"
PLANES = (
    "#2=AXIS2_PLACEMENT_3D('',#1,$,$);",
    "#3=ELEMENTARY_SURFACE('old',#2);",
    "#4=PLANE('new',#2);",
)


def operation(keyword: str, own: str) -> tuple[str, ...]:
    """An operation #10 whose own attributes follow its_machine_functions."""
    return (
        f"#10={keyword}($,$,'OP',10.,$,#5,#6,#7,{own});",
        "#5=MILLING_CUTTING_TOOL('T',#8,(),$,$,$);",
        "#6=MILLING_TECHNOLOGY(0.04,.TCP.,$,-12.,$,.F.,.F.,.F.,$);",
        "#7=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
        "#8=TAPERED_ENDMILL(#9,4,.RIGHT.,.F.,$,$);",
        "#9=MILLING_TOOL_DIMENSION(18.,$,$,29.,0.,$,$);",
    )


OPTIMISATION = "#20=TIME_CRITICAL_OPTIMISATION('O',#21,$,0.1,3.,$);"
POWERS = ("#21=MACHINE_POWER(#22);", "#22=NUMERIC_PARAMETER('P',7.5,'kW');")


def test_attributes_of_the_supertypes_come_first() -> None:
    model = model_of(*operation("PLANE_FINISH_MILLING", "$,$,$,$,2.5,$"))
    step = model.get(Ref[PlaneFinishMilling](10))
    assert step.its_toolpath is None
    assert step.its_id == "OP"
    assert step.retract_plane == 10.0
    assert model.get(step.its_technology).feedrate == 0.04
    assert step.axial_cutting_depth == 2.5
    assert step.allowance_bottom is None
    assert model.findings() == ()


def test_entities_are_bound_once() -> None:
    model = model_of(POINT)
    assert model.get(Ref[CartesianPoint](1)) is model.get(Ref[CartesianPoint](1))


def test_of_type_yields_subclasses_in_file_order() -> None:
    model = model_of(PLANES[2], PLANES[1], PLANES[0], POINT)
    surfaces = [(ref, type(each)) for ref, each in model.of_type(ElementarySurface)]
    assert surfaces == [(Ref(4), Plane), (Ref(3), ElementarySurface)]


def test_lower_case_keywords_are_the_same() -> None:
    model = model_of("#1=cartesian_point('',(1.,2.,3.));")
    assert model.get(Ref[CartesianPoint](1)).coordinates == (1.0, 2.0, 3.0)


def test_dangling_reference_is_an_error() -> None:
    model = model_of("#2=AXIS2_PLACEMENT_3D('',#99,$,$);")
    finding = only_finding(model)
    assert finding.severity is Severity.ERROR
    assert finding.attribute == "location"
    assert finding.entity == "#2 AXIS2_PLACEMENT_3D"
    assert finding.line == 6
    assert finding.rule == "ISO 10303-21"
    with pytest.raises(SchemaError, match="#99: is referenced") as error:
        model.get(Ref[CartesianPoint](99))
    assert error.value.entity == "#99"
    assert model.entity(99) is None


def test_unknown_entity_is_kept_and_noted_once() -> None:
    model = model_of(POINT, "#2=TROCHOIDAL_MILLING(1.);", "#3=TROCHOIDAL_MILLING(2.);")
    finding = only_finding(model)
    assert finding.severity is Severity.NOTE
    assert "TROCHOIDAL_MILLING (2 instances)" in finding.message
    assert finding.line == 7
    assert model.entity(2) is None
    with pytest.raises(
        SchemaError, match="line 7: #2 TROCHOIDAL_MILLING: this entity type is not supported"
    ):
        model.get(Ref[Entity](2))


def test_complex_instance_is_noted() -> None:
    model = model_of("#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));")
    assert "(LENGTH_UNIT NAMED_UNIT SI_UNIT) is not supported" in only_finding(model).message
    with pytest.raises(SchemaError, match="complex"):
        model.get(Ref[Entity](1))


def test_malformed_instance_is_no_entity() -> None:
    model = model_of("#1=CARTESIAN_POINT('',(0.,1.,@));", POINT.replace("#1", "#2"))
    assert model.entity(1) is None
    assert [ref for ref, _ in model.of_type(CartesianPoint)] == [Ref(2)]
    with pytest.raises(SchemaError, match="CARTESIAN_POINT"):
        model.get(Ref[Entity](1))


def test_reference_to_the_wrong_kind_is_an_error() -> None:
    finding = only_finding(model_of(POINT, "#2=MACHINED_SURFACE(#1,.SIDE.);"))
    assert finding.severity is Severity.ERROR
    assert (
        finding.message
        == "#1 CARTESIAN_POINT is referenced where ManufacturingFeature is expected"
    )
    assert finding.attribute == "its_machining_feature"


def test_missing_attribute_at_the_end_is_tolerated() -> None:
    model = model_of("#1=CUTTING_COMPONENT(80.,$,$,$);")
    assert model.get(Ref[CuttingComponent](1)).its_technology is None
    finding = only_finding(model)
    assert (finding.severity, finding.attribute) == (Severity.NOTE, "its_technology")
    assert finding.rule == "ISO 14649-111"


def test_sixth_parameter_of_a_boring_tool_is_read() -> None:
    model = model_of(*operation("DRILLING", "$,$,$,$,$,$"), "#11=BORING_TOOL(#9,2,$,$,$,.F.);")
    assert model.get(Ref[BoringTool](11)).is_adjustable is False


def test_tapping_without_its_last_attribute_is_usable() -> None:
    model = model_of(*operation("TAPPING", "$,$,$,$,$,$"))
    tapping = model.get(Ref[Tapping](10))
    assert tapping.its_id == "OP"
    assert only_finding(model).attribute == "compensation_chuck"


def test_surplus_attribute_is_kept_and_told() -> None:
    model = model_of("#1=CHANNEL('C',$,4.);")
    finding = only_finding(model)
    assert finding.severity is Severity.WARNING
    assert finding.message == "3 attributes, 1 expected: the surplus is kept but ignored"


def test_optimisation_at_the_very_end_is_recognised() -> None:
    instances = operation("BOTTOM_AND_SIDE_ROUGH_MILLING", "$,$,$,$,6.5,5.,1.,0.5,#20")
    model = model_of(*instances, OPTIMISATION, *POWERS)
    step = model.get(Ref[BottomAndSideRoughMilling](10))
    assert step.its_optimisation == Ref(20)
    assert step.allowance_bottom == 0.5
    assert model.position(Ref(10), "its_optimisation") == 16
    assert model.position(Ref(10), "allowance_bottom") == 15


def test_optimisation_behind_the_machine_functions_is_recognised() -> None:
    instances = operation("BOTTOM_AND_SIDE_ROUGH_MILLING", "#20,$,$,$,$,6.5,5.,1.,0.5")
    model = model_of(*instances, OPTIMISATION, *POWERS)
    step = model.get(Ref[BottomAndSideRoughMilling](10))
    assert step.its_optimisation == Ref(20)
    assert (step.axial_cutting_depth, step.allowance_bottom) == (6.5, 0.5)
    assert model.position(Ref(10), "its_optimisation") == 8
    assert model.position(Ref(10), "its_machine_functions") == 7
    assert model.position(Ref(10), "overcut_length") == 9


def test_optimisation_of_turning_does_not_hide_the_approach() -> None:
    approach = "#30=PLUNGE_TOOLAXIS($);"
    instances = operation("FACING_ROUGH", "#30,$,$,0.2,#20")
    model = model_of(*instances, OPTIMISATION, *POWERS, approach)
    assert model.position(Ref(10), "its_optimisation") == 12
    assert model.position(Ref(10), "approach") == 8


def test_optimisation_of_any_kind_is_recognised_where_a_number_belongs() -> None:
    values: tuple[Value, ...] = (None, None, "OP", None, None, Ref(5), Ref(6), Ref(7), Ref(20))
    found = bind(Drilling, values + (None,) * 6).entity
    assert isinstance(found, Drilling)
    assert found.its_optimisation == Ref(20)


def test_dangling_optimisation_is_an_error() -> None:
    model = model_of(*operation("DRILLING", "$,$,$,$,$,$,#99"))
    finding = only_finding(model)
    assert (finding.severity, finding.attribute) == (Severity.ERROR, "its_optimisation")


def test_absent_attribute_has_the_place_where_it_belongs() -> None:
    model = model_of(*operation("DRILLING", "$,$,$,$,$,$"), "#11=CUTTING_COMPONENT(80.,$,$,$);")
    assert model.position(Ref(10), "its_optimisation") == 14
    assert model.position(Ref(11), "its_technology") == 4
    with pytest.raises(ValueError, match="CuttingComponent has no attribute colour"):
        model.position(Ref(11), "colour")
    with pytest.raises(ValueError, match="its_optimisation"):
        model.position(Ref(11), "its_optimisation")


def test_number_that_is_not_finite_is_an_error() -> None:
    model = model_of("#1=CUTTING_COMPONENT(1.E400,$,$,$,$);")
    finding = only_finding(model)
    assert finding.severity is Severity.ERROR
    assert finding.message == "inf is not a finite number"


def test_required_reference_may_be_unset() -> None:
    model = model_of("#1=TOLERANCED_LENGTH_MEASURE(60.,$);")
    assert only_finding(model).severity is Severity.WARNING
    assert model.entity(1) is not None


def test_workplan_that_contains_itself_is_told() -> None:
    model = model_of("#1=WORKPLAN('A',(#2),$,$,$);", "#2=WORKPLAN('B',(#1),$,$,$);")
    finding = only_finding(model)
    assert finding.severity is Severity.ERROR
    assert finding.entity == "#1 WORKPLAN"
    assert finding.message == "contains itself: #2 refers back to it"


def test_feature_that_repeats_itself_is_told() -> None:
    instances = (
        "#1=WORKPIECE('W',$,$,$,$,$,());",
        "#2=CARTESIAN_POINT('',(0.,0.,0.));",
        "#3=AXIS2_PLACEMENT_3D('',#2,$,$);",
        "#4=GENERAL_PATTERN('',#1,(),#3,#4,(#3));",
    )
    assert only_finding(model_of(*instances)).entity == "#4 GENERAL_PATTERN"


def test_deep_nesting_needs_no_stack() -> None:
    depth = 5000
    plans = [f"#{i}=WORKPLAN('',(#{i + 1}),$,$,$);" for i in range(1, depth)]
    model = model_of(*plans, f"#{depth}=WORKPLAN('',(#1),$,$,$);")
    assert only_finding(model).message == f"contains itself: #{depth} refers back to it"


def test_element_that_two_plans_share_is_no_circle() -> None:
    model = model_of(
        "#1=WORKPLAN('',(#2,#3),$,$,$);",
        "#2=WORKPLAN('',(#3),$,$,$);",
        "#3=WORKPLAN('',(),$,$,$);",
    )
    assert model.findings() == ()


def test_proposed_technology_is_told_apart() -> None:
    model = model_of(
        "#1=MILLING_TECHNOLOGY(#2,#3,.F.,.F.,.F.);",
        "#2=SPINDLE_SPEED(.T.,-12.);",
        "#3=FEEDRATE_TCP(.F.,0.04);",
    )
    assert isinstance(model.entity(1), AdaptiveMillingTechnology)
    assert list(model.of_type(MillingTechnology)) == []
    assert [ref for ref, _ in model.of_type(AdaptiveMillingTechnology)] == [Ref(1)]


def test_older_keyword_gives_the_newer_entity() -> None:
    model = model_of("#1=BIDIRECTIONAL(0.05,.T.,$,.LEFT.,.STRAIGHTLINE.);")
    strategy = model.get(Ref[BidirectionalMilling](1))
    assert strategy.its_stroke_connection_strategy is StrokeConnectionStrategy.STRAIGHTLINE
    assert strategy.keyword == "BIDIRECTIONAL_MILLING"


def test_entity_is_given_back_as_parameters() -> None:
    technology = MillingTechnology(
        feedrate=0.04,
        feedrate_reference=ToolReferencePoint.TCP,
        spindle=-12.0,
        synchronize_spindle_with_feed=False,
        inhibit_feedrate_override=False,
        inhibit_spindle_override=True,
    )
    no, yes = Enumeration("F"), Enumeration("T")
    assert to_parameters(technology) == (
        Real(0.04),
        Enumeration("TCP"),
        None,
        Real(-12.0),
        None,
        no,
        no,
        yes,
        None,
    )


def test_optimisation_is_written_at_the_very_end() -> None:
    drilling = Drilling(
        its_id="",
        its_tool=Ref(1),
        its_technology=Ref(2),
        its_machine_functions=Ref(3),
        its_optimisation=Ref(20),
    )
    assert to_parameters(drilling)[-1] == Ref(20)
    assert len(to_parameters(drilling)) == 15
    assert bind(Drilling, to_parameters(drilling)).entity == drilling


@needs_corpus
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_public_file_binds_without_a_crash(path: Path) -> None:
    data = path.read_bytes()
    if len(data) > 300_000:
        pytest.skip(f"{path.name} has {len(data)} bytes: too long for a quick test")
    file = Part21File.from_bytes(data, name=path.name)
    model = Model(file)
    assert all(finding.line for finding in model.findings())
    for id in file.ids():
        entity = model.entity(id)
        if entity is not None:
            again = bind(type(entity), to_parameters(entity), file=file)
            assert again.entity == entity


@needs_corpus
@pytest.mark.parametrize("name", ["ex1.stp", "ex1E.stp", "furo.p21"])
def test_clean_public_file_has_no_findings(name: str) -> None:
    path = CORPUS / "iso14649" / name
    assert Model(Part21File.from_bytes(path.read_bytes())).findings() == ()


@needs_corpus
def test_example_of_the_standard_is_bound() -> None:
    path = CORPUS / "iso14649" / "EXAMPLE3.stp"
    model = Model(Part21File.from_bytes(path.read_bytes()))
    (_, boring), *others = model.of_type(MachiningOperation)
    assert isinstance(boring, BackBoring)
    assert not others
    assert boring.its_toolpath is not None
    first, *_ = model.get(boring.its_toolpath).its_list
    trajectory = model.get(first)
    assert isinstance(trajectory, CutterLocationTrajectory)
    assert trajectory.its_speed is SpeedName.RAPID
    (_, plan), *_ = model.of_type(Workplan)
    assert plan.its_elements == (Ref(30),)


@needs_corpus
def test_tool_of_the_draft_is_read() -> None:
    path = CORPUS / "iso14649" / "nine_workingsteps.p21"
    model = Model(Part21File.from_bytes(path.read_bytes()))
    tool = model.get(Ref[MillingCuttingTool](18))
    assert (tool.its_id, tool.its_cutting_edge) == ("Bohrer 20mm", ())
    assert tool.overall_assembly_length == 75.0
