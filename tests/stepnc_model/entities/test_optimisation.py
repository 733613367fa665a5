"""The entities of the optimisation record against their EXPRESS schema."""

import inspect
from enum import StrEnum
from importlib.resources import files
from types import NoneType
from typing import get_args, get_origin, get_type_hints

from docs.hooks.express.reader import read_schemas
from docs.hooks.express.schema import (
    AggregateType,
    AttributeType,
    EnumerationType,
    NamedType,
    attributes_in_order,
)
from stepnc_model.entities import optimisation
from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model, to_parameters
from tests.every_case import every_case

(SCHEMA,) = read_schemas(
    files("stepnc_model").joinpath("schemas/optimisation.exp").read_text("utf-8")
)
CLASSES = {
    name: value
    for name, value in vars(optimisation).items()
    if inspect.isclass(value) and value.__module__ == optimisation.__name__
}
ENTITIES = {name: cls for name, cls in CLASSES.items() if issubclass(cls, Entity)}
BORROWED = {
    "identifier": str,
    "label": str,
    "text": str,
    "length_measure": float,
    "plane_angle_measure": float,
    "positive_length_measure": float,
    "rot_speed_measure": float,
    "speed_measure": float,
    "time_measure": float,
}
SIMPLE = {"REAL": float, "INTEGER": int}


def python_name(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def python_type(found: AttributeType) -> object:
    """Annotation that belongs to an EXPRESS type."""
    if isinstance(found, AggregateType):
        return tuple[python_type(found.element), ...]  # type: ignore[misc]
    if found.name in SIMPLE:
        return SIMPLE[found.name]
    if found.name in BORROWED:
        return BORROWED[found.name]
    if found.name in SCHEMA.types:
        underlying = SCHEMA.types[found.name].underlying
        if isinstance(underlying, NamedType):
            return python_type(underlying)
        return CLASSES[python_name(found.name)]
    return f"Ref[{python_name(found.name)}]"


def shown(hint: object) -> tuple[object, bool]:
    """Annotation without ``None``, references by name, and whether it is optional."""
    choices = [each for each in get_args(hint) if each is not NoneType]
    is_optional = NoneType in get_args(hint)
    if is_optional:
        (hint,) = choices
    if get_origin(hint) is Ref:
        (target,) = get_args(hint)
        return f"Ref[{target.__name__}]", is_optional
    return hint, is_optional


def test_schema_and_module_have_the_same_entities() -> None:
    assert {python_name(name) for name in SCHEMA.entities} == set(ENTITIES)


@every_case("name", sorted(SCHEMA.entities))
def test_attributes_have_the_order_of_the_schema(name: str) -> None:
    expected = tuple(each.name for each in attributes_in_order(SCHEMA, name))
    assert attributes(ENTITIES[python_name(name)]) == expected


@every_case("name", sorted(SCHEMA.entities))
def test_attributes_have_the_types_of_the_schema(name: str) -> None:
    hints = get_type_hints(ENTITIES[python_name(name)])
    for attribute in attributes_in_order(SCHEMA, name):
        assert shown(hints[attribute.name]) == (
            python_type(attribute.type),
            attribute.is_optional,
        )


@every_case("name", sorted(SCHEMA.entities))
def test_supertypes_are_base_classes(name: str) -> None:
    definition = SCHEMA.entities[name]
    bases = [base for base in ENTITIES[python_name(name)].__bases__ if base is not Entity]
    assert [base.__name__ for base in bases] == [
        python_name(each) for each in definition.supertypes
    ]


@every_case("name", sorted(SCHEMA.entities))
def test_only_what_is_not_abstract_has_a_keyword(name: str) -> None:
    cls = ENTITIES[python_name(name)]
    keyword = "" if SCHEMA.entities[name].is_abstract else name.upper()
    assert vars(cls).get("keyword", "") == keyword


def test_enumerations_have_the_items_of_the_schema() -> None:
    for definition in SCHEMA.types.values():
        if isinstance(definition.underlying, EnumerationType):
            enumeration = CLASSES[python_name(definition.name)]
            assert issubclass(enumeration, StrEnum)
            assert tuple(enumeration) == tuple(
                item.upper() for item in definition.underlying.items
            )


def test_record_of_the_paper_is_the_beginning_of_ours() -> None:
    names = attributes(optimisation.TimeCriticalOptimisation)
    assert names[:5] == (
        "its_id",
        "main_drive_motor_power",
        "process_description",
        "feed_per_tooth_max",
        "axial_cutting_depth_max",
    )
    assert names[5:] == ("its_record",)


def test_record_may_be_left_out() -> None:
    record = optimisation.TimeCriticalOptimisation(
        its_id="TC",
        main_drive_motor_power=Ref(201),
        feed_per_tooth_max=0.5,
        axial_cutting_depth_max=3.0,
    )
    assert record.its_record is None
    assert record.process_description is None


WRITTEN = b"""ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','2025-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('OPTIMISATION_SCHEMA'));
ENDSEC;
DATA;
#1=TIME_CRITICAL_OPTIMISATION('TC',#5,'ROUGHING',0.117,3.,#2);
#2=OPTIMISATION_RECORD(1,'spindle power',#3,#4,#7,'paper002','paper002','optimise',
  $,0.117,3.,$,$,$);
#3=PREDICTED_VALUES(62.,0.29,447.4,$,1.8E4);
#4=PROGRAMMED_VALUES($,0.05,0.583,$,3.);
#5=MACHINE_POWER(#6);
#6=NUMERIC_PARAMETER('MACHINE POWER',0.29,'kW');
#7=MAIN_CUTTING_POWER(#8,#9,-10.3);
#8=NUMERIC_PARAMETER('CUTTING POWER',0.261,'kW');
#9=CUTTING_FORCE(#10,-10.3,0.117,1000.,3.);
#10=FACE_MILLING_TYPE(180.,.FULL_IMMERSION.);
#11=QUALITY_CRITICAL_OPTIMISATION('QC',#5,$,0.05,1.,$);
#12=ENERGY_CRITICAL_OPTIMISATION('EC',#5,$,0.1,3.,#2);
#13=CORRECTION('vmc15','c45','END MILL 12MM',1.07,0.8,$,'2025-01-01T00:00:00Z');
ENDSEC;
END-ISO-10303-21;
"""


def test_record_in_the_consistent_form_has_no_findings() -> None:
    file = Part21File.from_bytes(WRITTEN)
    assert [str(each) for each in (*file.findings, *Model(file).findings())] == []


def test_record_is_written_as_it_was_read() -> None:
    file = Part21File.from_bytes(WRITTEN)
    model = Model(file)
    for number in file.ids():
        entity = model.get(Ref[Entity](number))
        assert to_parameters(entity) == file.parameters(number)
