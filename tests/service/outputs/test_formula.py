"""A name never becomes a calculation of a spreadsheet, and every other text stays as it is."""

from hypothesis import given
from hypothesis import strategies as st

from service.outputs.formula import FIRST, disarmed


@given(st.text())
def test_no_text_is_a_formula_and_none_is_lost(text: str) -> None:
    made = disarmed(text)
    assert made[:1] not in {*FIRST}
    assert made.removeprefix("'" if made != text else "") == text
    assert (made == text) is (text[:1] not in {*FIRST})
