"""Fig. 11 of paper 002, read as printed."""

from math import pi
from pathlib import Path

import pytest

from stepnc_model.entities.measures import NumericParameter
from stepnc_model.entities.optimisation import (
    CuttingForce,
    FaceMillingImmersion,
    FaceMillingType,
    MachinePower,
    MainCuttingPower,
    TimeCriticalOptimisation,
)
from stepnc_model.entities.paper002 import INLINED, RULE, ConsistentRecord, read_printed
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Value
from stepnc_model.programs.binding import Model, to_parameters
from stepnc_model.programs.program import Program
from tests.every_case import every_case

FIGURE = Path(__file__).parents[2] / "data" / "fig11.stpnc"


@pytest.fixture(scope="module")
def figure() -> Part21File:
    return Part21File.from_bytes(FIGURE.read_bytes(), name=FIGURE.name)


def read(figure: Part21File, number: int) -> ConsistentRecord:
    reading = read_printed(
        figure.keyword(number),
        figure.parameters(number),
        label=figure.label(number),
        line=figure.line(number),
    )
    assert reading is not None
    return reading


def test_figure_is_a_program_of_one_workingstep() -> None:
    program = Program.load(FIGURE)
    (step,) = program.workingsteps
    assert step.operation_type == "plane_rough_milling"


def test_operation_finds_its_optimisation_in_the_middle(figure: Part21File) -> None:
    model = Model(figure)
    assert model.position(Ref(20), "its_optimisation") == 8
    assert model.position(Ref(20), "axial_cutting_depth") == 13


def test_optimisation_with_five_parameters_is_read(figure: Part21File) -> None:
    found = Model(figure).get(Ref[TimeCriticalOptimisation](200))
    assert (found.feed_per_tooth_max, found.axial_cutting_depth_max) == (0.5, 3.0)
    assert found.its_record is None


@every_case(
    "words",
    [
        "FILE_DESCRIPTION has 1 parameter",
        "FILE_NAME has 1 parameter",
        "';' is missing after #202",
        "';' is missing after #203",
        "';' is missing after #204",
        "RIGHT: read as .RIGHT.",
        "..F.: an enumeration must have one dot",
        '"FULL_IMMERSION"',
        "'*****/'",
    ],
)
def test_slip_of_the_syntax_is_told(figure: Part21File, words: str) -> None:
    assert any(words in str(finding) for finding in figure.findings)


def test_real_for_the_number_of_teeth_is_told(figure: Part21File) -> None:
    findings = [
        each for each in Model(figure).findings() if each.attribute == "number_of_teeth"
    ]
    assert [each.message for each in findings] == ["a real where an integer is required"]


def test_machine_power_gives_its_parameter_back(figure: Part21File) -> None:
    reading = read(figure, 201)
    assert reading.entity == MachinePower(its_power_property=INLINED)
    assert reading.inlined == NumericParameter(
        parameter_name="MACHINE POWER", its_parameter_value=0.29, its_parameter_unit="kW"
    )
    assert [each.rule for each in reading.findings] == [RULE]


def test_cutting_power_without_value_is_told(figure: Part21File) -> None:
    reading = read(figure, 202)
    assert reading.entity == MainCuttingPower(
        its_power_property=INLINED, its_cutting_force=Ref(203), spindle_speed=35.0
    )
    assert reading.inlined is None
    assert [each.attribute for each in reading.findings] == [
        "its_power_property",
        "its_power_property",
        "spindle_speed",
    ]


def test_cutting_force_is_put_in_order(figure: Part21File) -> None:
    reading = read(figure, 203)
    assert reading.entity == CuttingForce(
        its_face_milling_type=Ref(204),
        spindle_speed=500.0 / 60.0,
        feed_per_tooth=0.5,
        specific_cutting_resistance=1000.0,
        axial_cutting_depth=5.0,
    )
    messages = " ".join(each.message for each in reading.findings)
    assert "comes first" in messages
    assert "read as 500 rpm" in messages


def test_spindle_of_the_figure_is_not_the_speed_of_table_2(figure: Part21File) -> None:
    """500 rpm of an 18 mm cutter give 28.27 m/min, not 35 (PHYSICS.md 1.1, no. 18)."""
    force = read(figure, 203).entity
    assert isinstance(force, CuttingForce)
    assert pi * 18.0 * force.spindle_speed * 60.0 / 1000.0 == pytest.approx(28.27, abs=0.01)


def test_immersion_in_double_quotes_is_read(figure: Part21File) -> None:
    reading = read(figure, 204)
    assert reading.entity == FaceMillingType(
        zeta=180.0, immersion_type=FaceMillingImmersion.FULL_IMMERSION
    )


def test_findings_name_instance_and_line(figure: Part21File) -> None:
    (finding,) = read(figure, 204).findings
    assert str(finding).startswith("warning: line 55: #204 FACE_MILLING_TYPE.immersion_type: ")


@pytest.mark.parametrize("number", [201, 203, 204])
def test_what_is_written_again_is_in_order(figure: Part21File, number: int) -> None:
    reading = read(figure, number)
    parameters = to_parameters(reading.entity)
    assert read_printed(figure.keyword(number), parameters) is None


@pytest.mark.parametrize(
    ("keyword", "values"),
    [
        ("MACHINE_POWER", (Ref(7),)),
        ("MAIN_CUTTING_POWER", (Ref(7), Ref(8), Real(-10.0))),
        ("CUTTING_FORCE", (None, Real(-10.0), Real(0.1), Real(1000.0), Real(3.0))),
        ("FACE_MILLING_TYPE", (Real(180.0), Enumeration("FULL_IMMERSION"))),
        ("FACE_MILLING_TYPE", (Real(180.0), "SOME_IMMERSION")),
        ("CUTTING_FORCE", (Real(1e3), "x", 500, None, Real(0.5), 5)),
        ("CUTTING_FORCE", (Real(float("inf")), Ref(4), 500, None, Real(0.5), 5)),
        ("MACHINE_POWER", ("MACHINE POWER", None, "kW")),
        ("MAIN_CUTTING_POWER", ("CUTTING POWER", None, "kW", 203, 35)),
        ("CARTESIAN_POINT", ("", ())),
    ],
)
def test_any_other_form_is_left_alone(keyword: str, values: tuple[Value, ...]) -> None:
    assert read_printed(keyword, values) is None
