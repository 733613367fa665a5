"""Tokens cover any text."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.part21.places import SyntaxSlip
from stepnc_model.part21.tokens import TOKEN, MalformedError, scalar
from stepnc_model.part21.values import Real, Value
from tests.every_case import every_case


def value_of(text: str, *, slips: list[SyntaxSlip]) -> Value:
    match = TOKEN.fullmatch(text)
    assert match is not None
    return scalar(match, slips=slips)


@given(st.text(st.characters(max_codepoint=255)))
def test_tokens_cover_any_text_without_gaps(text: str) -> None:
    assert "".join(match[0] for match in TOKEN.finditer(text)) == text


@pytest.mark.parametrize("text", ["1E5", ".5", "1.e5", "-1.5e-05", "+.1E1"])
def test_real_in_another_notation_keeps_its_characters(text: str) -> None:
    slips: list[SyntaxSlip] = []
    value = value_of(text, slips=slips)
    assert isinstance(value, Real)
    assert (float(value), value.lexeme) == (float(text), text)
    assert len(slips) == 1


@every_case("text", ["NaN", "inf", "!X", "@", "'", "#" + "1" * 20])
def test_what_is_no_value_is_malformed(text: str) -> None:
    with pytest.raises(MalformedError):
        value_of(text, slips=[])
