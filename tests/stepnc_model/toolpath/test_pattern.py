"""Places of the copies of patterns, worked out by hand from ISO 14649-10."""

import pytest

from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.frame import MAX_COPIES, PlacedFeature, placements
from stepnc_model.toolpath.path import Point
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
COMMON = (
    "#20=ROUND_HOLE('HOLE',#40,(),#21,#30,#50,$,#51);",
    "#21=AXIS2_PLACEMENT_3D('',#22,$,$);",
    "#22=CARTESIAN_POINT('',(10.,0.,-1.));",
    "#23=AXIS2_PLACEMENT_3D('PATTERN',#24,$,$);",
    "#24=CARTESIAN_POINT('',(100.,50.,0.));",
    "#25=DIRECTION('',(1.,0.,0.));",
    "#26=DIRECTION('',(0.,1.,0.));",
    "#27=TOLERANCED_LENGTH_MEASURE(5.,$);",
    "#28=TOLERANCED_LENGTH_MEASURE(7.,$);",
    "#29=TOLERANCED_LENGTH_MEASURE(20.,$);",
    "#30=PLANE('',#21);",
    "#31=AXIS2_PLACEMENT_3D('TURNED',#24,$,#26);",
    "#32=AXIS2_PLACEMENT_3D('ORIGIN',#33,$,$);",
    "#33=CARTESIAN_POINT('',(0.,0.,0.));",
    "#34=ROUND_HOLE('HOLE AT CENTRE',#40,(),#32,#30,#50,$,#51);",
    "#51=THROUGH_BOTTOM_CONDITION();",
)


def copies(*instances: str, feature: int = 10) -> list[PlacedFeature]:
    body = "\n".join((*COMMON, *instances))
    text = f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    program = Program(Part21File.from_bytes(text.encode()))
    return list(placements(program, None, Ref(feature)))


def origins(*instances: str) -> list[Point]:
    return [placed.frame.origin for placed in copies(*instances)]


def circle(
    count: int = 4,
    increment: float = 90.0,
    *,
    moved: str = "",
    missing: str = "",
    diameter: str = "$",
    rotation: float = 0.0,
    base: int = 20,
    placement: int = 23,
) -> str:
    return (
        f"#10=CIRCULAR_PATTERN('C',#40,(),#{placement},#{base},{increment},{count},({moved}),"
        f"({missing}),{diameter},{rotation});"
    )


def rectangle(
    rows: str = "2",
    columns: int = 3,
    *,
    row_spacing: str = "#28",
    row_direction: str = "#26",
    moved: str = "",
    missing: str = "",
    base: int = 20,
) -> str:
    return (
        f"#10=RECTANGULAR_PATTERN('R',#40,(),#23,#{base},#27,#25,{rows},{columns},"
        f"{row_spacing},{row_direction},({moved}),({missing}));"
    )


def test_a_feature_that_is_no_pattern_is_its_own_place() -> None:
    (placed,) = copies(feature=20)
    assert placed.feature == Ref(20)
    assert placed.frame.origin == (10.0, 0.0, -1.0)


class TestCircular:
    def test_copies_stand_counter_clockwise_from_the_base(self) -> None:
        assert origins(circle()) == [
            pytest.approx((110.0, 50.0, -1.0)),
            pytest.approx((100.0, 60.0, -1.0)),
            pytest.approx((90.0, 50.0, -1.0)),
            pytest.approx((100.0, 40.0, -1.0)),
        ]

    def test_every_copy_is_the_base_feature(self) -> None:
        assert {placed.feature for placed in copies(circle())} == {Ref(20)}

    def test_a_turned_pattern_turns_its_copies(self) -> None:
        assert origins(circle(1, placement=31)) == [pytest.approx((100.0, 60.0, -1.0))]

    def test_copies_keep_their_orientation(self) -> None:
        assert all(placed.frame.x == (1.0, 0.0, 0.0) for placed in copies(circle()))

    def test_copies_that_turn_with_the_circle_say_so(self) -> None:
        axes = [placed.frame.x for placed in copies(circle(rotation=90.0))]
        assert axes[1] == pytest.approx((0.0, 1.0, 0.0))
        assert axes[2] == pytest.approx((-1.0, 0.0, 0.0))

    def test_an_omitted_place_is_left_out_and_not_counted(self) -> None:
        """Three copies and one omitted one make four places."""
        found = origins(circle(3, missing="#60"), "#60=CIRCULAR_OMIT(2);")
        assert found == [
            pytest.approx((110.0, 50.0, -1.0)),
            pytest.approx((90.0, 50.0, -1.0)),
            pytest.approx((100.0, 40.0, -1.0)),
        ]

    def test_a_relocated_copy_is_turned_further(self) -> None:
        found = origins(circle(2, moved="#60"), "#60=CIRCULAR_OFFSET(90.,2);")
        assert found[1] == pytest.approx((90.0, 50.0, -1.0))

    def test_a_base_at_the_centre_is_moved_out_to_the_diameter(self) -> None:
        assert origins(circle(2, diameter="#29", base=34)) == [
            pytest.approx((110.0, 50.0, 0.0)),
            pytest.approx((100.0, 60.0, 0.0)),
        ]

    def test_a_diameter_that_the_base_does_not_stand_on_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"radius 3\.5 mm, but .* 10 mm from the centre"):
            origins(circle(diameter="#28"))

    @every_case("index", [0, 5])
    def test_a_place_that_is_not_there_is_refused(self, index: int) -> None:
        with pytest.raises(PathError, match=f"index {index}: .* numbered 1 to 4"):
            origins(circle(4, moved="#60"), f"#60=CIRCULAR_OFFSET(1.,{index});")

    @every_case("count", [0, -1, MAX_COPIES + 1])
    def test_no_copies_and_too_many_are_refused(self, count: int) -> None:
        with pytest.raises(PathError, match=r"number_of_feature: .*copies"):
            origins(circle(count))


class TestRectangular:
    def test_copies_come_row_by_row_from_the_base(self) -> None:
        assert origins(rectangle()) == [
            (110.0, 50.0, -1.0),
            (115.0, 50.0, -1.0),
            (120.0, 50.0, -1.0),
            (110.0, 57.0, -1.0),
            (115.0, 57.0, -1.0),
            (120.0, 57.0, -1.0),
        ]

    def test_rows_left_out_are_one(self) -> None:
        assert len(origins(rectangle("$", row_spacing="$", row_direction="$"))) == 3

    def test_omitted_copies_count_by_row_and_column_from_1(self) -> None:
        found = origins(rectangle(missing="#60"), "#60=RECTANGULAR_OMIT(2,1);")
        assert (110.0, 57.0, -1.0) not in found
        assert len(found) == 5

    def test_a_relocated_copy_is_moved_along_its_direction(self) -> None:
        found = origins(
            rectangle(moved="#60"),
            "#60=RECTANGULAR_OFFSET(#61,2.5,1,3);",
            "#61=DIRECTION('',(0.,0.,-9.));",
        )
        assert found[2] == (120.0, 50.0, -3.5)

    def test_rows_without_spacing_are_refused(self) -> None:
        with pytest.raises(PathError, match="several rows needs a row spacing"):
            origins(rectangle(row_spacing="$"))

    @every_case("place", ["0,1", "3,1", "1,4"])
    def test_a_place_that_is_not_there_is_refused(self, place: str) -> None:
        with pytest.raises(PathError, match="the places of this pattern are numbered 1"):
            origins(rectangle(missing="#60"), f"#60=RECTANGULAR_OMIT({place});")

    def test_too_many_copies_are_refused(self) -> None:
        with pytest.raises(PathError, match="1000000 copies"):
            origins(rectangle("1000", 1000))


class TestGeneral:
    PATTERN = "#10=GENERAL_PATTERN('G',#40,(),#23,#20,(#60,#61));"
    PLACES = (
        "#60=AXIS2_PLACEMENT_3D('',#62,$,$);",
        "#61=AXIS2_PLACEMENT_3D('',#63,$,#26);",
        "#63=CARTESIAN_POINT('',(0.,3.,0.));",
    )

    def test_copies_stand_at_their_placements_in_the_pattern(self) -> None:
        found = copies(self.PATTERN, *self.PLACES, "#62=CARTESIAN_POINT('',(1.,2.,0.));")
        assert [placed.frame.origin for placed in found] == [
            (110.0, 50.0, -1.0),
            pytest.approx((101.0, 52.0, 0.0)),
            pytest.approx((100.0, 53.0, 0.0)),
        ]
        assert found[2].frame.x == pytest.approx((0.0, 1.0, 0.0))

    def test_a_base_that_is_listed_counts_once(self) -> None:
        found = copies(self.PATTERN, *self.PLACES, "#62=CARTESIAN_POINT('',(10.,0.,-1.));")
        assert len(found) == 2


def test_a_pattern_of_patterns_has_the_copies_of_both() -> None:
    """A row of two circles of two, 5 mm apart."""
    found = copies(
        rectangle("$", 2, row_spacing="$", row_direction="$", base=11),
        circle(2, 180.0, placement=32).replace("#10=", "#11="),
    )
    assert {placed.feature for placed in found} == {Ref(20)}
    assert [placed.frame.origin for placed in found] == [
        pytest.approx((110.0, 50.0, -1.0)),
        pytest.approx((90.0, 50.0, -1.0)),
        pytest.approx((115.0, 50.0, -1.0)),
        pytest.approx((95.0, 50.0, -1.0)),
    ]


def test_patterns_that_name_each_other_are_refused() -> None:
    with pytest.raises(PathError, match=r"#10 .*contains itself"):
        copies(circle(base=11), circle(base=10).replace("#10=", "#11="))


def test_patterns_of_patterns_end_somewhere() -> None:
    """100 rows of 100 circles of 200: 2 million holes."""
    with pytest.raises(PathError, match=f"more than {MAX_COPIES} copies"):
        copies(
            rectangle("100", 100, base=11),
            circle(200, 1.8, placement=32).replace("#10=", "#11="),
        )


def test_an_attribute_that_is_missing_is_named_with_its_pattern() -> None:
    with pytest.raises(SchemaError) as caught:
        copies(circle().replace("90.0", "$"))
    assert caught.value.entity == "#10 CIRCULAR_PATTERN"
