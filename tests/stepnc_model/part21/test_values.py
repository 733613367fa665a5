"""Values keep what the text said."""

from stepnc_model.part21.values import DERIVED, Enumeration, Real, Ref


def test_reference_shows_its_hash() -> None:
    assert str(Ref(42)) == repr(Ref(42)) == "#42"
    assert Ref(42) == 42


def test_real_is_a_float_with_its_characters() -> None:
    assert Real(0.5, "0.50") == 0.5
    assert Real(0.5, "0.50").lexeme == "0.50"
    assert Real(0.5).lexeme == ""


def test_marks_are_told_apart_from_text() -> None:
    assert isinstance(Enumeration("T"), str)
    assert repr(DERIVED) == "*"
