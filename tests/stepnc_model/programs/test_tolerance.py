"""Tolerances of lengths as files write them, and by the tables of the standards."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.errors import Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.tolerance import (
    GREATEST_GRADE,
    FileTolerance,
    Tolerance,
    general_tolerance,
    standard_tolerance,
    tolerance_findings,
    written_tolerance,
)
from tests.every_case import every_case

PROGRAM = (
    "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)

SIZES = st.floats(min_value=0.1, max_value=3150.0)
GRADES = st.integers(min_value=1, max_value=13)


def program_of(length: str, tolerance: str = "") -> Program:
    data = f"{PROGRAM}#3={length};\n{tolerance}\nENDSEC;\nEND-ISO-10303-21;"
    return Program(Part21File.from_bytes(data.encode(), name="part"), name="part")


def written(tolerance: str, size: str = "25.") -> FileTolerance:
    program = program_of(f"TOLERANCED_LENGTH_MEASURE({size},#4)", f"#4={tolerance};")
    return written_tolerance(program, Ref[TolerancedLengthMeasure](3))


@given(SIZES, SIZES, GRADES)
def test_standard_tolerance_grows_with_the_size(one: float, other: float, grade: int) -> None:
    small, large = sorted((one, other))
    assert standard_tolerance(small, grade) <= standard_tolerance(large, grade)


@given(st.floats(min_value=1.01, max_value=3150.0), st.integers(1, GREATEST_GRADE - 1))
def test_standard_tolerance_grows_with_the_grade(size: float, grade: int) -> None:
    assert standard_tolerance(size, grade) < standard_tolerance(size, grade + 1)


@given(st.floats(min_value=0.0, max_value=1e5), st.floats(min_value=0.0, max_value=1e5))
def test_general_tolerance_grows_with_the_size(one: float, other: float) -> None:
    small, large = sorted((one, other))
    assert general_tolerance(small).half_width <= general_tolerance(large).half_width


@every_case(
    ("size", "grade"), [(25.0, 0), (25.0, 19), (3151.0, 7), (0.0, 7), (-5.0, 7), (1.0, 14)]
)
def test_what_the_table_does_not_give_is_refused(size: float, grade: int) -> None:
    with pytest.raises(ValueError, match="ISO 286-1"):
        standard_tolerance(size, grade)


@every_case(
    ("text", "half_width", "code"),
    [
        ("PLUS_MINUS_VALUE(0.1,0.1,3)", 0.1, "±0.1 mm"),
        ("PLUS_MINUS_VALUE(0.2,0.1,3)", 0.15, "+0.2/-0.1 mm"),
        ("PLUS_MINUS_VALUE(0.021,0.,3)", 0.0105, "+0.021/-0 mm"),
        ("PLUS_MINUS_VALUE(0,1,3)", 0.5, "+0/-1 mm"),
        ("LIMITS_AND_FITS(0.,7.,.HOLE.)", 0.0105, "IT7"),
        ("LIMITS_AND_FITS(0,7,$)", 0.0105, "IT7"),
        ("LIMITS_AND_FITS('H',7.,.HOLE.)", 0.0105, "IT7"),
        ("LIMITS_AND_FITS('js','IT8',$)", 0.0165, "IT8"),
        ("LIMITS_AND_FITS('','H7',.HOLE.)", 0.0105, "IT7"),
        ("LIMITS_AND_FITS('zc',' 6 ',.SHAFT.)", 0.0065, "IT6"),
    ],
)
def test_tolerance_is_read(text: str, half_width: float, code: str) -> None:
    found = written(text)
    assert found.finding is None
    assert found.tolerance is not None
    assert found.tolerance.half_width == pytest.approx(half_width)
    assert found.tolerance.code == code


def test_length_without_a_tolerance_has_none() -> None:
    program = program_of("TOLERANCED_LENGTH_MEASURE(25.,$)")
    assert written_tolerance(program, Ref[TolerancedLengthMeasure](3)) == FileTolerance(
        tolerance=None
    )


@every_case(
    ("text", "why"),
    [
        ("PLUS_MINUS_VALUE(0.1,-0.1,3)", "positive numbers"),
        ("PLUS_MINUS_VALUE(-0.2,-0.1,3)", "positive numbers"),
        ("PLUS_MINUS_VALUE(-0.1,0.2,3)", "positive numbers"),
        ("PLUS_MINUS_VALUE(0.,0.,3)", "limits of 0 mm"),
        ("PLUS_MINUS_VALUE($,0.1,3)", "limit is missing"),
        ("PLUS_MINUS_VALUE(0.1)", "limit is missing"),
        ("LIMITS_AND_FITS('Q',7.,$)", "'Q'"),
        ("LIMITS_AND_FITS('','W7',$)", "'W'"),
        (
            "LIMITS_AND_FITS(0.,0.021,$)",
            "grade 0.021",
        ),
        ("LIMITS_AND_FITS(0.,'hole',$)", "grade 'hole'"),
        ("LIMITS_AND_FITS(0.,$,$)", "grade ''"),
        ("LIMITS_AND_FITS(0.,19.,$)", "IT19"),
        ("LIMITS_AND_FITS(0.,-7.,$)", "IT-7"),
        ("CARTESIAN_POINT('',(0.,0.,0.))", "not supported"),
        ("ODD_TOLERANCE(1.)", "not supported"),
    ],
)
def test_tolerance_that_cannot_be_read_is_a_warning_at_its_place(text: str, why: str) -> None:
    found = written(text)
    assert found.tolerance is None
    assert found.finding is not None
    assert found.finding.severity is Severity.WARNING
    assert why in found.finding.message
    assert "ISO 2768-m is used instead" in found.finding.message
    assert found.finding.entity == f"#4 {text.partition('(')[0]}"
    assert found.finding.line == 8


def test_a_warning_names_the_grade_the_grades_and_what_is_used() -> None:
    finding = written("LIMITS_AND_FITS(0.,19.,$)").finding
    assert finding is not None
    assert "IT19: ISO 286-1 has grades IT1 to IT18" in finding.message


@pytest.mark.parametrize(
    ("size", "why"), [("5000.", "up to 3150 mm"), ("-5.", "up to 3150 mm"), ("$", "nominal")]
)
def test_fit_of_a_size_beyond_the_table_is_a_warning(size: str, why: str) -> None:
    found = written("LIMITS_AND_FITS(0.,7.,$)", size=size)
    assert found.finding is not None
    assert why in found.finding.message


def test_tolerance_that_is_not_there_is_told_at_the_length() -> None:
    program = program_of("TOLERANCED_LENGTH_MEASURE(25.,#9)")
    found = written_tolerance(program, Ref[TolerancedLengthMeasure](3))
    assert found.finding is not None
    assert found.finding.entity == "#3 TOLERANCED_LENGTH_MEASURE"


def test_what_is_no_toleranced_length_has_no_tolerance() -> None:
    program = program_of("CARTESIAN_POINT('',(0.,0.,0.))")
    assert written_tolerance(program, Ref[TolerancedLengthMeasure](3)) == FileTolerance(
        tolerance=None
    )


def test_findings_of_a_file_name_each_tolerance_once() -> None:
    two = "#4=PLUS_MINUS_VALUE(0.1,-0.1,3);\n#5=TOLERANCED_LENGTH_MEASURE(8.,#4);"
    (found,) = tolerance_findings(program_of("TOLERANCED_LENGTH_MEASURE(25.,#4)", two))
    assert found.entity == "#4 PLUS_MINUS_VALUE"


@given(
    st.one_of(st.floats(allow_nan=False, allow_infinity=False), st.text(max_size=6)),
    st.one_of(st.floats(allow_nan=False, allow_infinity=False), st.text(max_size=6)),
)
def test_no_fit_makes_the_reader_fail(deviation: float | str, grade: float | str) -> None:
    shown = [
        "'" + "".join(c for c in v if c.isascii() and c.isalnum()) + "'"
        if isinstance(v, str)
        else repr(v).replace("e", "E")
        if "." in repr(v)
        else f"{v:.1f}"
        for v in (deviation, grade)
    ]
    found = written(f"LIMITS_AND_FITS({shown[0]},{shown[1]},$)")
    assert (found.tolerance is None) is (found.finding is not None)


@given(st.floats(0.0, 1e6), st.floats(0.0, 1e6))
def test_half_width_is_half_of_what_lies_between_the_limits(upper: float, lower: float) -> None:
    found = written(f"PLUS_MINUS_VALUE({upper:.9f},{lower:.9f},3)").tolerance
    total = float(f"{upper:.9f}") + float(f"{lower:.9f}")
    assert (found or Tolerance(half_width=0.0, code="")).half_width == 0.5 * total
