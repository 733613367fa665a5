"""Programs of ISO 14649 written as AP238, and read back."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.profiles import SurfaceTextureParameter
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real
from stepnc_model.part21.writer import Edits
from stepnc_model.programs.program import Program
from tests.stepnc_model.ap238.long_form import deviations, schema
from tests.stepnc_model.ap238.samples import (
    OWN,
    PUBLIC,
    Comparison,
    exported,
    long_form,
    own,
    public,
    read,
)
from tests.stepnc_model.ap238.test_reading import NAMED, paths, shape


@pytest.mark.parametrize("name", OWN)
def test_a_way_through_ap238_keeps_every_number(name: str) -> None:
    back = AimView.of(read(exported(name)))
    assert set(Comparison(own(name), back).run()) <= NAMED


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_file_stays_the_same_through_iso_14649(name: str) -> None:
    view = AimView.of(read(public(name)))
    again = AimView.of(read(to_ap238(Part21File.from_bytes(view.data)).data))
    assert Comparison(view, again).run() == {}


@pytest.mark.parametrize("name", OWN)
def test_the_long_form_accepts_what_is_written(name: str) -> None:
    assert list(deviations(read(exported(name)), schema(long_form()))) == []


@pytest.mark.parametrize("name", ["paper002", "paper003_pocket"])
def test_the_tool_paths_are_the_same(name: str) -> None:
    one, other = paths(Program(own(name))), paths(Program(read(exported(name))))
    assert [shape(path) for path in one] == [shape(path) for path in other]


@pytest.mark.parametrize("name", OWN)
def test_the_same_program_gives_the_same_bytes(name: str) -> None:
    assert to_ap238(own(name)).data == exported(name)


def test_what_cannot_be_said_is_listed() -> None:
    assert to_ap238(own("bracket")).findings == ()
    data = own("bracket").data.replace(b"'ISO 4287',$,(#51)", b"'ISO 4287','max',(#51)")
    (left,) = to_ap238(read(data)).findings
    assert left.entity.endswith(" SURFACE_TEXTURE_PARAMETER")
    assert left.attribute == "parameter_index"
    assert left.line > 0
    assert left.rule == "ISO 10303-238"


def textures(program: Program) -> set[tuple[float, str, str, str, str]]:
    """Surface textures of a program, each with the id of its feature."""
    return {
        (
            texture.its_value,
            texture.parameter_name,
            texture.measuring_method,
            program.get(program.get(ref).its_machining_feature).its_id,
            program.get(ref).surface_element.value,
        )
        for _, texture in program.model.of_type(SurfaceTextureParameter)
        for ref in texture.applied_surfaces
    }


@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_surface_textures_come_back_with_their_features(name: str) -> None:
    wanted = textures(Program(own(name)))
    assert wanted
    assert textures(Program(read(exported(name)))) == wanted


def test_a_texture_is_one_property_of_its_surfaces() -> None:
    file = read(exported("bracket"))
    count = len(file.ids_of("SURFACE_TEXTURE_REPRESENTATION"))
    assert count == 3
    assert len(file.ids_of("GENERAL_PROPERTY_ASSOCIATION")) == count


def test_a_file_without_program_is_refused() -> None:
    file = Part21File.from_bytes(
        b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=DIRECTION('',(0.,0.,1.));ENDSEC;END-ISO-10303-21;"
    )
    with pytest.raises(SchemaError, match="no program to convert"):
        to_ap238(file)


@settings(max_examples=20)
@given(
    number=st.floats(min_value=1e-6, max_value=1e6),
    depth=st.floats(min_value=1e-6, max_value=1e3),
)
def test_any_number_comes_back_as_it_was(number: float, depth: float) -> None:
    file = own("paper002")
    program = Program(file)
    step = program.workingsteps[0]
    changed = _with(file, int(step.technology_ref), 0, number)
    changed = _with(changed, int(step.operation_ref), 3, depth)
    back = AimView.of(read(to_ap238(changed).data))
    assert Comparison(changed, back).run().keys() <= NAMED


def _with(file: Part21File, id: int, position: int, value: float) -> Part21File:
    """File with another number in one instance."""
    edits = Edits(file)
    edits.replace_parameter(id, position, Real(value))
    return Part21File.from_bytes(edits.apply())
