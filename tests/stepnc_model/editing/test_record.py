"""A record is the same in its two forms, to the last digit."""

from collections.abc import Mapping
from dataclasses import fields, replace
from math import pi
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.editing.record import (
    MODES,
    PREFIX,
    AdviceRecord,
    parameters_of,
    read_entities,
    read_parameters,
    write_entities,
)
from stepnc_model.entities.measures import DescriptiveParameter, NumericParameter
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.part21.writer import Edits
from stepnc_model.programs.binding import Model
from tests.every_case import every_case

EMPTY = (
    b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\n"
    b"DATA;\nENDSEC;\nEND-ISO-10303-21;\n"
)

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
IMMERSIONS = st.sampled_from(sorted(FaceMillingImmersion))

RECORD = AdviceRecord(
    mode="TC",
    id="ROUGH THE FACE",
    description="as fast as the spindle allows",
    machine="paper002",
    material="st37",
    generator="another",
    active_limit="motor power",
    number_of_passes=2,
    feed_per_tooth=0.1234567890125,
    axial_depth=1.5,
    machine_power=0.29,
    cutting_power=0.2,
    spindle_speed=-10.3,
    specific_cutting_resistance=1000.0,
    machining_time=31.5,
    motor_power=0.25,
    cutting_force=321.0,
    energy=8000.0,
    surface_roughness=3.2,
    contact_angle=180.0,
    immersion="FULL_IMMERSION",
    programmed_feedrate=0.04,
    programmed_feedrate_per_tooth=0.05,
    programmed_cutspeed=0.58,
    programmed_spindle=-12.0,
    programmed_axial_depth=3.0,
    plunge_feed_per_tooth=0.02,
    machine_power_bound=0.3,
    feed_per_tooth_bound=0.5,
    axial_depth_bound=3.0,
)
OPTIONAL = tuple(each.name for each in fields(AdviceRecord) if each.default is None)


@st.composite
def records(draw: st.DrawFn) -> AdviceRecord:
    """Any record; the angle of contact and the name of the immersion come together."""
    faces = st.tuples(NUMBERS, IMMERSIONS.map(str)) | st.just((None, None))
    values: dict[str, Any] = {
        "mode": draw(st.sampled_from(sorted(MODES))),
        "number_of_passes": draw(st.integers(0, 10**6)),
    }
    values["contact_angle"], values["immersion"] = draw(faces)
    for each in fields(AdviceRecord):
        if each.name in values:
            continue
        strategy: st.SearchStrategy[Any] = NUMBERS if "unit" in each.metadata else TEXTS
        values[each.name] = draw(st.none() | strategy if each.default is None else strategy)
    maxima = (values["feed_per_tooth_max"], values["axial_depth_max"])
    if values["mode"] != "TC" or None in maxima:
        values |= {"feed_per_tooth_max": None, "axial_depth_max": None}
    return AdviceRecord(**values)


def through_entities(record: AdviceRecord) -> AdviceRecord | None:
    edits = Edits(Part21File.from_bytes(EMPTY))
    ref = write_entities(record, edits)
    return read_entities(Model(Part21File.from_bytes(edits.apply())), ref)


def through_parameters(record: AdviceRecord) -> AdviceRecord | None:
    return read_parameters(values_of(record))


def values_of(record: AdviceRecord) -> dict[str, float | str]:
    """Parameters by their names without the prefix."""
    found: dict[str, float | str] = {}
    for parameter in parameters_of(record):
        name = parameter.parameter_name.removeprefix(PREFIX)
        if isinstance(parameter, NumericParameter):
            found[name] = parameter.its_parameter_value
        else:
            assert isinstance(parameter, DescriptiveParameter)
            found[name] = parameter.descriptive_string
    return found


class TestLossless:
    @given(records())
    def test_any_record_through_entities(self, record: AdviceRecord) -> None:
        assert through_entities(record) == record

    @given(records())
    def test_any_record_through_parameters(self, record: AdviceRecord) -> None:
        assert through_parameters(record) == record

    @given(records())
    def test_any_record_through_both(self, record: AdviceRecord) -> None:
        first = through_entities(record)
        assert first is not None
        second = through_parameters(first)
        assert second is not None
        assert through_entities(second) == record

    @pytest.mark.parametrize("mode", sorted(MODES))
    def test_every_mode(self, mode: str) -> None:
        record = replace(RECORD, mode=mode)
        assert through_entities(record) == through_parameters(record) == record

    @every_case(
        "name", [name for name in OPTIONAL if name not in {"contact_angle", "immersion"}]
    )
    def test_every_optional_absent(self, name: str) -> None:
        changes: Mapping[str, Any] = {name: None}
        record = replace(RECORD, **changes)
        assert through_entities(record) == through_parameters(record) == record

    def test_all_optionals_absent(self) -> None:
        changes: Mapping[str, Any] = dict.fromkeys(OPTIONAL)
        record = replace(RECORD, **changes)
        assert through_entities(record) == through_parameters(record) == record

    @every_case(
        "number", [0.1 + 0.2, pi, 5e-324, 1.7976931348623157e308, 1e22, 123456789.123456789]
    )
    def test_the_last_digit_counts(self, number: float) -> None:
        record = replace(RECORD, energy=number)
        assert through_entities(record) == through_parameters(record) == record

    @every_case(
        "text", ["", "it's", "a;b", "/* no comment */", "Größe µm", "\\", "\n", "日本", "🔩"]
    )
    def test_every_text_counts(self, text: str) -> None:
        record = replace(RECORD, description=text, id=text)
        assert through_entities(record) == through_parameters(record) == record


class TestParameters:
    def test_every_name_has_the_prefix(self) -> None:
        assert all(each.parameter_name.startswith(PREFIX) for each in parameters_of(RECORD))

    def test_one_for_each_number_or_word(self) -> None:
        assert len(list(parameters_of(RECORD))) == sum(
            getattr(RECORD, each.name) is not None for each in fields(AdviceRecord)
        )

    def test_what_is_absent_is_not_written(self) -> None:
        assert "surface_roughness" not in values_of(replace(RECORD, surface_roughness=None))

    def test_numbers_have_the_units_of_the_file(self) -> None:
        units = {
            each.parameter_name.removeprefix(PREFIX): each.its_parameter_unit
            for each in parameters_of(RECORD)
            if isinstance(each, NumericParameter)
        }
        assert units["feed_per_tooth"] == "mm"
        assert units["spindle_speed"] == "rev/s"
        assert units["machine_power"] == "kW"
        assert units["specific_cutting_resistance"] == "N/mm2"
        assert units["programmed_feedrate"] == "m/s"

    def test_a_record_that_is_not_complete_is_none(self) -> None:
        values = values_of(RECORD)
        del values["energy"]
        assert read_parameters(values) is None

    def test_no_parameters_are_no_record(self) -> None:
        assert read_parameters({}) is None

    def test_an_unknown_parameter_is_passed_over(self) -> None:
        assert read_parameters(values_of(RECORD) | {"colour": "blue"}) == RECORD


class TestEntities:
    def test_the_papers_optimisation_without_record_is_none(self) -> None:
        text = EMPTY.replace(
            b"DATA;\n",
            b"DATA;\n#1=NUMERIC_PARAMETER('P',0.29,'kW');\n#2=MACHINE_POWER(#1);\n"
            b"#3=TIME_CRITICAL_OPTIMISATION('ID',#2,$,0.5,5.);\n",
        )
        assert read_entities(Model(Part21File.from_bytes(text)), Ref(3)) is None

    def test_another_entity_is_none(self) -> None:
        text = EMPTY.replace(b"DATA;\n", b"DATA;\n#1=NUMERIC_PARAMETER('P',0.29,'kW');\n")
        assert read_entities(Model(Part21File.from_bytes(text)), Ref(1)) is None

    def test_an_instance_that_is_not_there_is_none(self) -> None:
        assert read_entities(Model(Part21File.from_bytes(EMPTY)), Ref(1)) is None

    @pytest.mark.parametrize(
        ("mode", "keyword"),
        [
            ("TC", "TIME_CRITICAL_OPTIMISATION"),
            ("QC", "QUALITY_CRITICAL_OPTIMISATION"),
            ("EC", "ENERGY_CRITICAL_OPTIMISATION"),
        ],
    )
    def test_the_mode_is_the_entity(self, mode: str, keyword: str) -> None:
        edits = Edits(Part21File.from_bytes(EMPTY))
        ref = write_entities(replace(RECORD, mode=mode), edits)
        assert Part21File.from_bytes(edits.apply()).keyword(int(ref)) == keyword

    def test_what_is_written_follows_the_schema(self) -> None:
        edits = Edits(Part21File.from_bytes(EMPTY))
        write_entities(RECORD, edits)
        assert Model(Part21File.from_bytes(edits.apply())).findings() == ()
