"""Values of R and Q parameters: numbers by hand and from the manuals' rules."""

from math import isnan, nan, pi, sqrt

import pytest

from stepnc_model.nc.parameters import KLARTEXT, SINUMERIK, Arithmetic, Parameters
from tests.every_case import every_case


def value(text: str, arithmetic: Arithmetic, **given: float) -> float:
    """Value of an expression with some parameters."""
    return Parameters(arithmetic, dict(given)).evaluate(text)


@every_case(
    ("text", "wanted"),
    [
        ("R1+2*3", 16.0),
        ("-R1", -10.0),
        ("(R1-4)/R2", 2.0),
        ("R1/4*2", 5.0),
        ("SIN(30)+COS(60)", 1.0),
        ("ATAN2(1,1)", 45.0),
        ("SQRT(POT(R2)+16)", 5.0),
        ("ROUND(2.5)+TRUNC(-2.7)", 1.0),
        ("7 DIV 2", 3.0),
        ("7 MOD 4", 3.0),
        ("(R1>=10) AND (R2<>3)", 0.0),
        ("(R1==10) OR (R2==4)", 1.0),
        ("ABS(-R02)", 3.0),
    ],
)
def test_sinumerik(text: str, wanted: float) -> None:
    assert value(text, SINUMERIK, R1=10.0, R2=3.0) == pytest.approx(wanted)


@every_case(
    ("text", "wanted"),
    [
        ("+Q1 + +5", 15.0),
        ("Q1 DIV Q2", 10.0 / 3.0),
        ("Q2 LEN 4", 5.0),
        ("1 ANG 1", 45.0),
        ("SIN 30 * 2", 1.0),
        ("( Q1 + 2 ) * SQ Q2", 108.0),
        ("Q2 ^ 2 + 1", 10.0),
        ("NEG Q1 + INT 2.7", -8.0),
        ("SQRT ( Q1 * Q1 )", 10.0),
        ("PI", pi),
        ("+Q1 GT +5", 1.0),
        ("+Q1 EQU +Q2", 0.0),
        ("SQRT 2", sqrt(2.0)),
        ("QL1", 7.0),
    ],
)
def test_klartext(text: str, wanted: float) -> None:
    assert value(text, KLARTEXT, Q1=10.0, Q2=3.0, QL1=7.0) == pytest.approx(wanted)


@every_case(
    "text", ["R3", "R1/0", "R1+", "SQRT(-1)", "FOO(1)", "1,2", "SIN 30", "", "(" * 99, "R1=2"]
)
def test_what_is_not_known_is_no_number(text: str) -> None:
    assert isnan(value(text, SINUMERIK, R1=10.0))


def test_an_unknown_parameter_makes_unknown_what_depends_on_it() -> None:
    parameters = Parameters(KLARTEXT)
    parameters.set("Q5", nan)
    parameters.set("Q6", 2.0)
    assert isnan(parameters.evaluate("Q6 * Q5"))
    assert parameters.evaluate("Q06") == 2.0
    parameters.forget()
    assert isnan(parameters.get("Q6"))


def test_parameters_of_the_control_stay_unknown() -> None:
    parameters = Parameters(KLARTEXT)
    parameters.set("Q108", 5.0)
    assert isnan(parameters.get("Q108"))
