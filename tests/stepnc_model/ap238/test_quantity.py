"""Units of AP238 files: SI, converted, derived and named ones, and how they fit a value."""

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.quantity import MEASURES, Units, conversion
from stepnc_model.ap238.table import Kind
from tests.every_case import every_case
from tests.stepnc_model.ap238.samples import read

UNITS = b"""ISO-10303-21;
HEADER;
ENDSEC;
DATA;
#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#3=(CONVERSION_BASED_UNIT('inch',#4)LENGTH_UNIT()NAMED_UNIT(#9));
#4=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);
#5=(NAMED_UNIT(*)SI_UNIT($,.SECOND.)TIME_UNIT());
#6=(CONVERSION_BASED_UNIT('minute',#7)NAMED_UNIT(#9)TIME_UNIT());
#7=TIME_MEASURE_WITH_UNIT(TIME_MEASURE(60.),#5);
#9=DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.);
#10=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#11=(CONVERSION_BASED_UNIT('degree',#12)NAMED_UNIT(#9)PLANE_ANGLE_UNIT());
#12=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.01745329252),#10);
#20=DERIVED_UNIT((#21,#22));
#21=DERIVED_UNIT_ELEMENT(#1,1.);
#22=DERIVED_UNIT_ELEMENT(#6,-1.);
#23=DERIVED_UNIT((#22));
#24=DERIVED_UNIT((#25,#26));
#25=DERIVED_UNIT_ELEMENT(#10,1.);
#26=DERIVED_UNIT_ELEMENT(#5,-1.);
#27=NAME_ATTRIBUTE('millimetre/minute',#20);
#28=DERIVED_UNIT((#29,#26));
#29=DERIVED_UNIT_ELEMENT(#3,1.);
#30=SI_UNIT(*,.MEGA.,.PASCAL.);
#31=CONTEXT_DEPENDENT_UNIT(#9,'count');
#32=(CONVERSION_BASED_UNIT('endless',#33)LENGTH_UNIT()NAMED_UNIT(#9));
#33=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#32);
#34=DIRECTION('',(0.,0.,1.));
ENDSEC;
END-ISO-10303-21;
"""


def units() -> Units:
    """Units of the file above."""
    return Units(Instances(read(UNITS)))


@every_case(
    ("number", "kind", "factor"),
    [
        (1, Kind.LENGTH, 1.0),
        (2, Kind.LENGTH, 1000.0),
        (3, Kind.LENGTH, 25.4),
        (5, Kind.TIME, 1.0),
        (6, Kind.TIME, 60.0),
        (10, Kind.ANGLE, 180.0 / pi),
        (11, Kind.ANGLE, 1.0),
        (20, Kind.SPEED, 1e-3 / 60.0),
        (23, Kind.ROTATION, 1.0 / 60.0),
        (24, Kind.ROTATION, 0.5 / pi),
        (28, Kind.SPEED, 0.0254),
        (30, Kind.PRESSURE, 1e6),
        (31, Kind.COUNT, 1.0),
    ],
)
def test_the_factor_to_the_unit_of_iso_14649(number: int, kind: Kind, factor: float) -> None:
    found = conversion(units().unit(number), MEASURES[kind])
    assert found.is_fitting
    assert found.factor == pytest.approx(factor, rel=1e-12)


def test_a_degree_of_few_digits_is_exactly_a_degree() -> None:
    assert conversion(units().unit(11), MEASURES[Kind.ANGLE]).factor == 1.0


@pytest.mark.parametrize(
    ("number", "kind", "factor"),
    [
        (20, Kind.LENGTH, 1.0),
        (28, Kind.LENGTH, 25.4),
        (20, Kind.ROTATION, 1.0 / 60.0),
        (1, Kind.TIME, 1.0),
        (1, Kind.PRESSURE, 1.0),
    ],
)
def test_a_unit_of_another_dimension_does_not_fit(
    number: int, kind: Kind, factor: float
) -> None:
    found = conversion(units().unit(number), MEASURES[kind])
    assert not found.is_fitting
    assert found.factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize("number", [9, 32, 34, 99])
def test_what_is_no_unit_or_refers_to_itself_has_none(number: int) -> None:
    assert units().unit(number) is None


def test_names_are_those_of_the_file_or_of_si() -> None:
    assert units().name(20) == "millimetre/minute"
    assert units().name(1) == "millimetre"
    assert units().name(31) == "count"


@given(st.floats(min_value=1e-9, max_value=1e9))
def test_a_number_in_inches_is_25_4_times_as_many_mm(number: float) -> None:
    factor = conversion(units().unit(3), MEASURES[Kind.LENGTH]).factor
    assert number * factor == pytest.approx(25.4 * number, rel=1e-12)
