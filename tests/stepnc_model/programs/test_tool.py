"""Every tool of ISO 14649-111 and -121 as numbers in mm and rad."""

from math import pi

import pytest

from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.entity import attributes
from stepnc_model.entities.tools import MillingToolBody
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import Tool, tool_of
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
FIRST_LINE = 8
BODIES = sorted(
    (keyword, len(attributes(cls)))
    for keyword, cls in classes().items()
    if issubclass(cls, MillingToolBody)
)


def read(*instances: str) -> Tool:
    """Tool #10."""
    body = "\n".join(instances)
    text = f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    return tool_of(Program(Part21File.from_bytes(text.encode())), Ref(10))


def rotating(
    body: str = "ENDMILL(#12,4,.RIGHT.,.F.,$)", dimension: str = "10.,$,$,22.,0.2,$,$"
) -> Tool:
    return read(
        "#10=MILLING_CUTTING_TOOL('T1',#11,(#13),80.,$,$);",
        f"#11={body};",
        f"#12=MILLING_TOOL_DIMENSION({dimension});",
        "#13=CUTTING_COMPONENT(80.,#14,$,$,$);",
        "#14=MATERIAL('carbide','P20',());",
    )


def turning(
    tool: str = "GENERAL_TURNING_TOOL('T2',150.,32.,$,$,$,#11,.RIGHT.)",
    edge: str = "$,$,12.,95.,$,80.,(#12),6.,$",
) -> Tool:
    return read(
        f"#10={tool};",
        f"#11=CUTTING_EDGE_PROPERTIES({edge});",
        "#12=ROUNDED_CORNER(0.8);",
        "#13=ROUNDED_CORNER(0.4);",
        "#14=CHAMFERED_CORNER(45.,0.1,$);",
    )


class TestRotating:
    @every_case(("keyword", "arity"), BODIES)
    def test_every_kind_has_diameter_teeth_and_length(self, keyword: str, arity: int) -> None:
        surplus = {
            "USER_DEFINED_TOOL": ",'X'",
            "BORING_TOOL": ",.T.",
        }.get(keyword, ",1." if arity > 5 else "")
        tool = rotating(f"{keyword}(#12,3,.RIGHT.,.F.,$" + surplus + ")")
        assert tool.id == "T1"
        assert tool.keyword == classes()[keyword].keyword
        assert (tool.diameter, tool.teeth, tool.has_teeth) == (10.0, 3, True)
        assert tool.cutting_edge_length == 22.0
        assert tool.width is None

    def test_its_edge_is_named_by_material_and_tool(self) -> None:
        assert rotating().edge_material == ("carbide", "P20", "T1")

    def test_an_end_mill_has_the_corner_of_its_dimension(self) -> None:
        assert rotating().corner_radius == 0.2

    def test_a_sharp_corner_is_none(self) -> None:
        assert rotating(dimension="10.,$,$,22.,0.,$,$").corner_radius is None

    def test_a_ball_has_half_its_diameter(self) -> None:
        assert rotating("BALL_ENDMILL(#12,2,.RIGHT.,.F.,$)").corner_radius == 5.0

    def test_teeth_left_out_count_as_one_that_the_file_does_not_say(self) -> None:
        tool = rotating("ENDMILL(#12,$,.RIGHT.,.F.,$)")
        assert (tool.teeth, tool.has_teeth) == (1, False)

    @pytest.mark.parametrize("teeth", [0, -4])
    def test_no_teeth_are_refused(self, teeth: int) -> None:
        with pytest.raises(SchemaError) as caught:
            rotating(f"ENDMILL(#12,{teeth},.RIGHT.,.F.,$)")
        assert caught.value.entity == "#11 ENDMILL"
        assert caught.value.attribute == "number_of_teeth"
        assert caught.value.line == FIRST_LINE + 1

    @every_case("diameter", ["0.", "-10.", "$", "1e400", "-1e400", "'ten'"])
    def test_a_diameter_that_is_not_positive_is_refused(self, diameter: str) -> None:
        with pytest.raises(SchemaError, match="diameter") as caught:
            rotating(dimension=f"{diameter},$,$,22.,0.2,$,$")
        assert caught.value.entity == "#12 MILLING_TOOL_DIMENSION"
        assert caught.value.line == FIRST_LINE + 2

    def test_a_whole_diameter_is_a_number(self) -> None:
        assert rotating(dimension="10,$,$,$,$,$,$").diameter == 10.0

    def test_the_drafts_name_of_the_dimension_is_read(self) -> None:
        tool = read(
            "#10=CUTTING_TOOL('T',#11,(),$);",
            "#11=TWIST_DRILL(#12,2,.RIGHT.,.F.,$);",
            "#12=TOOL_DIMENSION(8.5,$,$,$,$,$,$);",
        )
        assert tool.diameter == 8.5

    def test_no_cutting_edge_length_is_none(self) -> None:
        assert rotating(dimension="10.,$,$,$,$,$,$").cutting_edge_length is None
        assert rotating(dimension="10.,$,$,0.,$,$,$").cutting_edge_length is None

    def test_a_tool_without_body_is_refused(self) -> None:
        with pytest.raises(
            SchemaError, match=r"#10 .*no tool body: --tools gives a table with tool 'T'"
        ):
            read("#10=MILLING_CUTTING_TOOL('T',$,(),$,$,$);")

    def test_a_body_without_dimension_is_refused(self) -> None:
        with pytest.raises(
            SchemaError, match=r"#11 ENDMILL\.dimension: the tool body has no dimension"
        ):
            rotating("ENDMILL($,4,.RIGHT.,.F.,$)")

    def test_a_tool_without_name_is_called_by_its_kind(self) -> None:
        tool = read(
            "#10=MILLING_CUTTING_TOOL('',#11,(),$,$,$);",
            "#11=TWIST_DRILL(#12,2,.RIGHT.,.F.,$);",
            "#12=MILLING_TOOL_DIMENSION(8.,$,$,$,$,$,$);",
        )
        assert tool.id == "twist drill"


class TestPointAngle:
    """31 degrees between lip and face plane make the common drill of 118 degrees."""

    @pytest.mark.parametrize("top", ["31.", "0.5410520681182421"])
    def test_degrees_and_radians_mean_the_same(self, top: str) -> None:
        tool = rotating("TWIST_DRILL(#12,2,.RIGHT.,.F.,$)", f"10.,{top},$,$,$,$,$")
        assert tool.point_angle == pytest.approx(rad_from_deg(118.0), rel=1e-12)

    @every_case("top", ["$", "0.", "-31.", "90.", "118.", "1.6"])
    def test_an_angle_that_makes_no_point_is_none(self, top: str) -> None:
        tool = rotating("TWIST_DRILL(#12,2,.RIGHT.,.F.,$)", f"10.,{top},$,$,$,$,$")
        assert tool.point_angle is None

    def test_two_degrees_are_degrees(self) -> None:
        tool = rotating("TWIST_DRILL(#12,2,.RIGHT.,.F.,$)", "10.,2.,$,$,$,$,$")
        assert tool.point_angle == pytest.approx(rad_from_deg(176.0))


class TestTurning:
    def test_a_turning_tool_has_no_diameter_and_one_tooth(self) -> None:
        tool = turning()
        assert (tool.id, tool.keyword) == ("T2", "GENERAL_TURNING_TOOL")
        assert (tool.diameter, tool.teeth) == (0.0, 1)
        assert tool.corner_radius == 0.8
        assert tool.cutting_edge_length == 6.0
        assert tool.cutting_edge_angle == pytest.approx(rad_from_deg(95.0))
        assert tool.width is None

    @pytest.mark.parametrize(
        "tool",
        [
            "TURNING_THREADING_TOOL('T2',150.,32.,$,$,$,#11,.RIGHT.,2.,.RIGHT.,.EXTERNAL.,"
            ".FULL_PROFILE.,'M')",
            "KNURLING_TOOL('T2',150.,32.,$,$,$,#11,.RIGHT.,$,$,$,$)",
            "USER_DEFINED_TURNING_TOOL('T2',150.,32.,$,$,$,#11,.RIGHT.,'X')",
        ],
    )
    def test_other_turning_tools_are_read(self, tool: str) -> None:
        assert turning(tool).corner_radius == 0.8

    def test_a_grooving_tool_has_a_width(self) -> None:
        tool = turning(
            "GROOVING_TOOL('T2',150.,32.,$,$,$,#11,.RIGHT.,3.,12.,0.2,$,$)",
            "$,$,3.,$,$,$,(),$,$",
        )
        assert tool.width == 3.0

    def test_an_angle_left_out_is_a_right_angle(self) -> None:
        assert turning(edge="$,$,12.,$,$,80.,(#12),6.,$").cutting_edge_angle == 0.5 * pi

    def test_the_smallest_nose_counts(self) -> None:
        assert turning(edge="$,$,12.,95.,$,80.,(#12,#13,#14),6.,$").corner_radius == 0.4

    def test_no_corner_is_none(self) -> None:
        assert turning(edge="$,$,12.,95.,$,80.,(),6.,$").corner_radius is None
        assert turning(edge="$,$,12.,95.,$,80.,$,6.,$").corner_radius is None

    def test_a_turning_tool_without_edge_is_refused(self) -> None:
        with pytest.raises(
            SchemaError, match=r"#10 .*cutting_edge: the tool has no cutting edge"
        ):
            read("#10=GENERAL_TURNING_TOOL('T2',150.,32.,$,$,$,$,.RIGHT.);")


def test_a_probe_is_no_cutting_tool() -> None:
    with pytest.raises(SchemaError, match="is not a milling, drilling or turning tool"):
        read("#10=TOUCH_PROBE('P');")


def test_a_tool_that_is_not_there_is_refused() -> None:
    with pytest.raises(SchemaError, match="is referenced, but does not exist in the file"):
        read("#11=TOUCH_PROBE('P');")


def test_a_length_that_no_tool_has_is_refused() -> None:
    with pytest.raises(SchemaError, match=r"cutting edge length 1e\+300 mm"):
        rotating(dimension="10.,$,$,1.E300,0.2,$,$")


@every_case(
    ("edge", "message"),
    [
        ("CUTTING_EDGE_PROPERTIES($,$,$,60.,$,60.,(#13),$,$)", "corner_radius"),
        ("WORKPLAN('W',(),$,$,$)", "cutting_edge"),
    ],
)
def test_a_turning_tool_without_its_edge_is_told_with_its_place(
    edge: str, message: str
) -> None:
    tool = "GROOVING_TOOL('G',150.,32.,$,$,$,#12,.RIGHT.,3.,12.,0.2,$,$)"
    with pytest.raises(SchemaError, match=message):
        read(f"#10={tool};", f"#12={edge};", "#13=ROUNDED_CORNER($);")
