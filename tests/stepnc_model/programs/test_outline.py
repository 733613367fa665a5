"""Numbers of features that tool paths and estimates read the same way."""

from math import radians
from pathlib import Path

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import (
    boundary_of,
    feature_depth,
    known_depth,
    parameter,
    size,
    size_or_zero,
    vee_angle,
)
from stepnc_model.programs.program import Program

BRACKET = Path(__file__).parents[3] / "examples" / "parts" / "bracket.stpnc"
FACE, CONTOUR, STEP, SLOT, POCKET = (Ref[Entity](number) for number in range(100, 150, 10))
END = "ENDSEC;\nEND-ISO-10303-21;"


def program(more: str = "") -> Program:
    """The bracket with instances added."""
    text = BRACKET.read_text().replace(END, f"{more}\n{END}")
    return Program(Part21File.from_bytes(text.encode(), name="bracket"), name="bracket")


@pytest.mark.parametrize("number", ["0.", "-5.", "1.E9", "1.E999"])
def test_size_must_be_a_length_of_a_part(number: str) -> None:
    read = program(f"#900=TOLERANCED_LENGTH_MEASURE({number},#510);")
    with pytest.raises(SchemaError):
        size(read, Ref(900), POCKET)


def test_size_that_is_missing_is_said() -> None:
    with pytest.raises(PathError, match="#140 CLOSED_POCKET: a required size is missing"):
        size(program(), None, POCKET)


def test_size_that_may_be_absent_is_nothing_then_and_never_negative() -> None:
    read = program("#900=TOLERANCED_LENGTH_MEASURE(-1.,#510);")
    assert size_or_zero(read, None) == 0.0
    with pytest.raises(PathError, match=r"#900 .*-1 mm"):
        size_or_zero(read, Ref(900))


def test_parameter_must_be_a_length_of_a_part() -> None:
    read = program("#900=NUMERIC_PARAMETER('',0.,'MM');#901=NUMERIC_PARAMETER('',5.,'MM');")
    assert parameter(read, Ref(901)) == 5.0
    with pytest.raises(PathError, match="0 mm is not a length of a part"):
        parameter(read, Ref(900))


def test_depth_is_where_the_depth_plane_lies() -> None:
    read = program()
    depths = [known_depth(read, ref) for ref in (FACE, CONTOUR, STEP, SLOT, POCKET)]
    assert depths == [2.0, 20.0, 8.0, 6.0, 12.0]


def test_entity_without_depth_plane_has_no_depth() -> None:
    read = program("#900=TOLERANCED_LENGTH_MEASURE(1.,#510);")
    assert feature_depth(read, Ref(900)) is None
    with pytest.raises(PathError, match="has no depth"):
        known_depth(read, Ref(900))


def test_boundary_is_the_profile_of_the_walls() -> None:
    read = program()
    assert boundary_of(read.get(POCKET)) == read.get(POCKET).feature_boundary  # type: ignore[attr-defined]
    assert boundary_of(read.get(FACE)) is None


def test_angles_of_vees_are_in_degrees_or_in_radians() -> None:
    assert vee_angle(60.0) == pytest.approx(radians(60.0))
    assert vee_angle(radians(60.0)) == pytest.approx(radians(60.0))
    assert vee_angle(None) == 0.0
