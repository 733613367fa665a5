"""Variables have the scope of their control, and only known values are numbers."""

from math import isnan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.nc.expression import Variables, evaluate, target_of
from tests.every_case import every_case


@every_case(
    ("text", "value"),
    [
        ("1+2*3", 7.0),
        ("[1+2]*3", 9.0),
        ("2**3**1", 8.0),
        ("-[2-5]", 3.0),
        ("7 MOD -4", 3.0),
        ("8/4/2", 1.0),
        ("sin[30]", 0.5),
        ("atan[-1]/[-1]", -135.0),
        ("[1 LT 2] AND [2 LT 3]", 1.0),
    ],
)
def test_operators_bind_as_on_a_control(text: str, value: float) -> None:
    assert evaluate(text, Variables(is_linuxcnc=True)) == pytest.approx(value)


@given(st.text(alphabet="#<>[]+-*/.0123456789 aeglnoqrstx", max_size=30))
def test_any_text_gives_a_number_or_nothing(text: str) -> None:
    assert isinstance(evaluate(text, Variables(is_linuxcnc=True)), float)


def test_a_subprogram_has_variables_of_its_own() -> None:
    variables = Variables(is_linuxcnc=True)
    variables.set(1, 5.0)
    variables.set(100, 6.0)
    variables.set("a", 7.0)
    variables.set("_a", 8.0)
    variables.enter({1: 2.0})
    assert [variables.get(each) for each in (1, 100, "_a")] == [2.0, 6.0, 8.0]
    assert isnan(variables.get("a"))
    variables.leave()
    assert variables.get(1) == 5.0
    variables.forget()
    assert isnan(variables.get(1))


def test_a_plain_call_keeps_the_variables_of_its_caller() -> None:
    variables = Variables(is_linuxcnc=False)
    variables.set(1, 5.0)
    variables.enter(None)
    variables.set(1, 6.0)
    variables.leave()
    assert variables.get(1) == 6.0


def test_variables_may_be_named_by_variables() -> None:
    variables = Variables(is_linuxcnc=False)
    variables.set(1, 20.0)
    assert target_of("#[#1+3]", variables) == 23
    assert target_of("##1", variables) == 20
    assert target_of("#<name>", variables) == "name"
    assert target_of("#[#2]", variables) is None
    assert target_of("#1 2", variables) is None
