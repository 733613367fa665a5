"""What counts as tidy, and its values."""

import pytest

from stepnc_model.part21.tokens import is_tidy, tidy_values
from stepnc_model.part21.values import Real, Ref, Typed
from tests.every_case import every_case


@pytest.mark.parametrize(
    "text",
    [
        "#1=A();",
        "#12= A ( $ , * ) ;",
        "#1=A((1,(2,3)),L_M(0.5),'it''s',.T.,\"0A\",#9,-1.E+5);",
    ],
)
def test_text_by_the_letter_is_tidy(text: str) -> None:
    assert is_tidy(text)


@every_case(
    "text",
    [
        "#1=A()",
        "#1=A(1,);",
        "#1=A(/**/);",
        "#1=A(1E5);",
        "#1=A(1.e5);",
        "#1=(A());",
        "#1=A((((1))));",
        "#1=A(1 2);",
        "#1=A(X());",
        '#1=A("X");',
        "#1=A('x);",
        "#1=A(b);",
    ],
)
def test_all_other_text_is_not(text: str) -> None:
    assert not is_tidy(text)


def test_flat_and_mixed_lists_give_the_same_kind_of_values() -> None:
    flat = tidy_values("#1=A((0.,1.50),(#1,#2),X(0.5),Y(#3));")
    mixed = tidy_values("#1=A( ( 0. , 1.50 ) , ( #1 , #2 ) , X( 0.5 ) , Y( #3 ) );")
    assert flat == mixed == ((0.0, 1.5), (1, 2), Typed("X", Real(0.5)), Typed("Y", Ref(3)))
    assert repr(flat) == repr(mixed)
