"""What features ask to be removed, against numbers worked out from their dimensions."""

from math import pi, sin, sqrt, tan
from pathlib import Path

import pytest

from optimiser.cuts.region import DEFAULT_STEP_WIDTH, FeatureRegion, region_of
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"
FACE, CONTOUR, STEP, SLOT, POCKET, OPEN_POCKET, HOLE, NEW = (
    Ref[Entity](number) for number in (100, 110, 120, 130, 140, 150, 160, 900)
)
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


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited()


def test_face_is_travel_times_profile(bracket: Program) -> None:
    region = region_of(bracket, FACE)
    assert region.area == pytest.approx(96.0 * 156.0)
    assert region.width == 156.0
    assert region.depth == 2.0
    assert region.perimeter == 0.0
    assert region.is_open


def test_island_on_a_face_stays_and_its_wall_counts() -> None:
    program = edited(("#103,#106,#108,$,());", "#103,#106,#108,$,(#190));"))
    region = region_of(program, FACE)
    assert region.area == pytest.approx(96.0 * 156.0 - pi * 8.0**2)
    assert region.perimeter == pytest.approx(pi * 16.0)


def test_pocket_is_its_boundary_less_the_island(bracket: Program) -> None:
    region = region_of(bracket, POCKET)
    assert region.area == pytest.approx(60.0 * 50.0 - pi * 8.0**2)
    assert region.perimeter == pytest.approx(2.0 * (60.0 + 50.0) + pi * 16.0)
    assert region.width == 50.0
    assert region.depth == 12.0
    assert not region.is_open


def test_open_pocket_has_no_wall_where_it_is_open(bracket: Program) -> None:
    region = region_of(bracket, OPEN_POCKET)
    assert region.area == pytest.approx(28.0 * 40.0)
    assert region.perimeter == pytest.approx(40.0 + 28.0 + 40.0)
    assert region.width == 28.0
    assert region.depth == 10.0
    assert region.is_open


def test_slot_is_its_width_along_its_travel(bracket: Program) -> None:
    region = region_of(bracket, SLOT)
    assert region.area == pytest.approx(12.0 * 90.0)
    assert region.perimeter == pytest.approx(2.0 * 90.0)
    assert region.width == 12.0
    assert region.depth == 6.0
    assert region.is_open


def test_slot_with_closed_ends_is_closed() -> None:
    program = edited(("#139=OPEN_SLOT_END_TYPE();", "#139=RADIUSED_SLOT_END_TYPE();"))
    assert not region_of(program, SLOT).is_open


def test_vee_slot_is_as_wide_as_its_depth_opens_it() -> None:
    """90 degrees, 6 mm deep: 12 mm wide."""
    program = edited((
        "#136=SQUARE_U_PROFILE($,#137,#138,0.,#138,0.);",
        "#136=VEE_PROFILE($,#138,90.,45.);",
    ))
    assert region_of(program, SLOT).width == pytest.approx(12.0)


def test_step_reaches_to_the_side_of_the_stock(bracket: Program) -> None:
    """The stock ends at x = 153 mm, 15 mm from the edge at 138 mm."""
    region = region_of(bracket, STEP)
    assert region.width == pytest.approx(153.0 - 138.0)
    assert region.area == pytest.approx(90.0 * 15.0)
    assert region.perimeter == pytest.approx(90.0)
    assert region.depth == 8.0


def test_step_lies_to_the_right_of_its_edge() -> None:
    """Against y the right is at smaller x, where the stock ends at -3 mm."""
    program = edited(("#126=LINEAR_PATH($,#127,#503);", "#126=LINEAR_PATH($,#127,#504);"))
    assert region_of(program, STEP).width == pytest.approx(138.0 + 3.0)


def test_step_without_stock_has_the_customary_width() -> None:
    program = edited(("0.05,$,$,#33,", "0.05,$,$,$,"))
    assert region_of(program, STEP).width == DEFAULT_STEP_WIDTH


def test_outside_contour_is_its_outline_with_chords_for_arcs(bracket: Program) -> None:
    """130 + 70 + 130 + 70 mm, and four chords of arcs of 10 mm."""
    region = region_of(bracket, CONTOUR)
    assert region.perimeter == pytest.approx(400.0 + 4.0 * 10.0 * sqrt(2.0))
    assert region.perimeter == pytest.approx(400.0 + 2.0 * pi * 10.0, rel=0.015)
    assert region.area == 0.0
    assert region.depth == 20.0


def test_hole_is_a_circle(bracket: Program) -> None:
    region = region_of(bracket, HOLE)
    assert region.area == pytest.approx(pi * 25.0)
    assert region.perimeter == pytest.approx(pi * 10.0)
    assert region.depth == 40.0


def boundary(profile: str, more: str = "") -> FeatureRegion:
    """The pocket with another boundary and without its island."""
    program = edited(
        ("#148=RECTANGULAR_CLOSED_PROFILE($,#149,#180);", f"#148={profile};"),
        ("#141,#143,(#190),$,#146", "#141,#143,(),$,#146"),
        more=more,
    )
    return region_of(program, POCKET)


def test_round_pocket() -> None:
    region = boundary("CIRCULAR_CLOSED_PROFILE($,#180)")
    assert region.area == pytest.approx(pi * 30.0**2)
    assert region.perimeter == pytest.approx(pi * 60.0)


def test_hexagon_by_its_circumscribed_circle_and_across_its_flats() -> None:
    """Edge is half the outer diameter, or the distance over √3."""
    outer = boundary("NGON_CLOSED_PROFILE($,#180,6,.T.)")
    assert outer.perimeter == pytest.approx(6.0 * 30.0)
    assert outer.area == pytest.approx(1.5 * sqrt(3.0) * 30.0**2)
    flats = boundary("NGON_CLOSED_PROFILE($,#180,6,.F.)")
    assert flats.perimeter == pytest.approx(6.0 * 60.0 / sqrt(3.0))
    assert flats.width == pytest.approx(60.0)


def test_triangle_by_its_corners() -> None:
    """30, 40 and 50 mm: 600 mm²."""
    more = (
        "#901=POLYLINE('',(#902,#903,#904,#902));#902=CARTESIAN_POINT('',(0.,0.,0.));"
        "#903=CARTESIAN_POINT('',(30.,0.,0.));#904=CARTESIAN_POINT('',(0.,40.,0.));"
    )
    region = boundary("GENERAL_CLOSED_PROFILE($,#901)", more)
    assert region.area == pytest.approx(600.0)
    assert region.perimeter == pytest.approx(120.0)


def test_pocket_open_along_an_arc_is_a_segment_of_a_circle() -> None:
    program = edited((
        "#157=GENERAL_PROFILE($,#158);",
        "#157=PARTIAL_CIRCULAR_PROFILE($,#149,180.);",
    ))
    region = region_of(program, OPEN_POCKET)
    assert region.area == pytest.approx(0.5 * pi * 50.0**2)
    assert region.perimeter == pytest.approx(pi * 50.0)


@pytest.mark.parametrize(
    ("path", "length"),
    [
        ("LINEAR_PATH($,#127,#503)", 90.0),
        ("COMPLETE_CIRCULAR_PATH($,#127)", 2.0 * pi * 90.0),
        ("PARTIAL_CIRCULAR_PATH($,#127,30.)", 90.0 * pi / 6.0),
        ("GENERAL_PATH($,#158)", 40.0 + 28.0 + 40.0),
    ],
)
def test_slot_is_as_long_as_its_course_of_travel(path: str, length: float) -> None:
    program = edited(("#133,#126,#136,", "#133,#901,#136,"), more=f"#901={path};")
    assert region_of(program, SLOT).area == pytest.approx(12.0 * length)


@pytest.mark.parametrize(
    ("pattern", "count"),
    [
        ("GENERAL_PATTERN('',#30,(),#41,#140,(#171,#161))", 3),
        ("CIRCULAR_PATTERN('',#30,(),#41,#140,60.,6,(),(),$,0.)", 6),
        ("CIRCULAR_PATTERN('',#30,(),#41,#140,60.,6,(),(#901),$,0.)", 5),
        ("RECTANGULAR_PATTERN('',#30,(),#41,#140,#127,#502,3,4,$,$,(),())", 12),
        ("RECTANGULAR_PATTERN('',#30,(),#41,#140,#127,#502,3,4,$,$,(),(#902))", 11),
        ("RECTANGULAR_PATTERN('',#30,(),#41,#140,#127,#502,$,4,$,$,(),())", 4),
    ],
)
def test_patterns_repeat_their_base(pattern: str, count: int) -> None:
    more = f"#900={pattern};#901=CIRCULAR_OMIT(2);#902=RECTANGULAR_OMIT(1,1);"
    program = edited(more=more)
    region, base = region_of(program, NEW), region_of(program, POCKET)
    assert region.count == count
    assert (region.area, region.perimeter) == (base.area, base.perimeter)


def test_boss_is_cut_along_its_outline(bracket: Program) -> None:
    region = region_of(bracket, Ref[Entity](190))
    assert region.perimeter == pytest.approx(pi * 16.0)
    assert region.area == 0.0


def test_feature_without_depth_removes_nothing() -> None:
    program = edited((
        "#105=CARTESIAN_POINT('',(0.,0.,-2.));",
        "#105=CARTESIAN_POINT('',(0.,0.,0.));",
    ))
    with pytest.raises(SchemaError, match=r"#100 PLANAR_FACE.*depth 0 mm is not valid"):
        region_of(program, FACE)


def test_size_that_is_no_length_is_an_error_at_its_line() -> None:
    program = edited((
        "#107=TOLERANCED_LENGTH_MEASURE(96.,",
        "#107=TOLERANCED_LENGTH_MEASURE(-96.,",
    ))
    with pytest.raises(SchemaError, match=r"line \d+: #107.*-96 mm is not a length"):
        region_of(program, FACE)


def test_paper_002_has_a_face_of_one_stroke() -> None:
    region = region_of(edited(name="paper002"), Ref[Entity](30))
    assert (region.area, region.width, region.depth) == (300.0 * 18.0, 18.0, 3.0)


def test_polygon_of_twelve_sides_by_its_circumscribed_circle() -> None:
    """Twelve corners on a circle of 30 mm: edge 2·30·sin 15°, inner radius 30·cos 15°."""
    region = boundary("NGON_CLOSED_PROFILE($,#180,12,.T.)")
    edge = 60.0 * sin(pi / 12.0)
    assert region.perimeter == pytest.approx(12.0 * edge)
    assert region.width == pytest.approx(edge / tan(pi / 12.0))
