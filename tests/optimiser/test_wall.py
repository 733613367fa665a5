"""Which sizes of a feature place its walls."""

import pytest

from optimiser.bounds.tolerance import wall_sizes
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from tests.optimiser.plans import edited

SLOT = "#130=SLOT('SLOT',#30,(#205),#131,#133,#126,#136,(#139,#139));"
PROFILE = "#136=SQUARE_U_PROFILE($,#137,#138,0.,#138,0.);"
RECTANGLE = "#148=RECTANGULAR_CLOSED_PROFILE($,#149,#180);"
FACE = "#100=PLANAR_FACE('TOP',#30,(#200,#201),#101,#103,#106,#108,$,());"


def found(program: Program, feature: int) -> list[tuple[str, float, str]]:
    sizes = wall_sizes(program, Ref(feature))
    return [(each.name, each.size, str(each.ref or "")) for each in sizes]


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited("bracket")


@pytest.mark.parametrize(
    ("feature", "expected"),
    [
        (100, []),
        (110, [("width", 90.0, "")]),
        (120, [("width", 15.0, "")]),
        (130, [("width", 12.0, "#137")]),
        (140, [("width", 50.0, "#149"), ("length", 60.0, "#180"), ("diameter", 16.0, "#192")]),
        (150, [("width", 28.0, "")]),
        (160, [("diameter", 10.0, "#166")]),
        (190, [("diameter", 16.0, "#192")]),
    ],
)
def test_widths_lengths_and_diameters_place_walls(
    bracket: Program, feature: int, expected: list[tuple[str, float, str]]
) -> None:
    """Depths, radii of corners and the length of an open slot do not."""
    assert found(bracket, feature) == expected


def test_closed_ends_of_a_slot_are_walls() -> None:
    program = edited(
        "bracket", ("#139=OPEN_SLOT_END_TYPE();", "#139=RADIUSED_SLOT_END_TYPE();")
    )
    assert found(program, 130) == [("width", 12.0, "#137"), ("length", 90.0, "#127")]


@pytest.mark.parametrize(
    ("profile", "expected"),
    [
        ("#136=ROUNDED_U_PROFILE($,#137);", [("width", 12.0, "#137")]),
        ("#136=PARTIAL_CIRCULAR_PROFILE($,#137,180.);", [("radius", 12.0, "#137")]),
        (
            "#136=TEE_PROFILE($,0.,0.,#149,#138,#138,#137,#138,#138);",
            [("width", 12.0, "#137"), ("cross bar width", 50.0, "#149")],
        ),
    ],
)
def test_profile_of_a_slot_has_its_own_sizes(
    profile: str, expected: list[tuple[str, float, str]]
) -> None:
    assert found(edited("bracket", (PROFILE, profile)), 130) == expected


@pytest.mark.parametrize(
    ("profile", "name"),
    [
        ("#148=CIRCULAR_CLOSED_PROFILE($,#149);", "diameter"),
        ("#148=NGON_CLOSED_PROFILE($,#149,6,.T.);", "diameter"),
    ],
)
def test_pocket_of_another_shape_has_a_diameter(profile: str, name: str) -> None:
    program = edited("bracket", (RECTANGLE, profile))
    assert found(program, 140)[0] == (name, 50.0, "#149")


def test_shape_without_a_toleranced_length_is_measured() -> None:
    program = edited("bracket", (RECTANGLE, "#148=GENERAL_CLOSED_PROFILE($,#520);"))
    assert found(program, 140) == [("width", 90.0, ""), ("diameter", 16.0, "#192")]


def test_boss_on_a_face_has_walls() -> None:
    program = edited("bracket", (FACE, FACE.replace("$,())", "$,(#190))")))
    assert found(program, 100) == [("diameter", 16.0, "#192")]


def test_boss_of_any_shape_is_measured() -> None:
    program = edited(
        "bracket",
        ("#191=CIRCULAR_CLOSED_PROFILE($,#192);", "#191=GENERAL_CLOSED_PROFILE($,#520);"),
    )
    assert found(program, 140)[-1] == ("width of a boss", 90.0, "")


def test_pattern_has_the_walls_of_what_it_repeats() -> None:
    pattern = "#901=GENERAL_PATTERN('ROW',#30,(),#131,#130,(#151));\n"
    program = edited("bracket", (SLOT, SLOT + "\n" + pattern))
    assert found(program, 901) == [("width", 12.0, "#137")]


def test_compound_has_the_walls_of_all_its_elements() -> None:
    compound = "#901=COUNTERBORE_HOLE('BORE',#30,(),#161,(#160,#130));\n"
    program = edited("bracket", (SLOT, SLOT + "\n" + compound))
    assert found(program, 901) == [("diameter", 10.0, "#166"), ("width", 12.0, "#137")]
