"""Numbers, texts and what is in force."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.post.words import Modal, ascii_text, bracketed, decimal, pointed


@pytest.mark.parametrize(
    ("value", "short", "with_point"),
    [
        (10.0, "10", "10."),
        (-0.5, "-0.5", "-0.5"),
        (1.2346, "1.235", "1.235"),
        (-0.0001, "0", "0."),
        (100.0, "100", "100."),
    ],
)
def test_numbers_are_as_short_as_they_can_be(value: float, short: str, with_point: str) -> None:
    assert decimal(value, 3) == short
    assert pointed(value, 3) == with_point


def test_no_places_leave_zeros_alone() -> None:
    assert decimal(1200.0, 0) == "1200"


@given(st.floats(-1e5, 1e5))
def test_a_written_number_is_the_rounded_one(value: float) -> None:
    assert float(decimal(value, 4)) == pytest.approx(value, abs=0.5001e-4)


def test_a_word_is_said_when_it_is_new() -> None:
    modal = Modal()
    assert [modal.word("F", "F1"), modal.word("F", "F1"), modal.word("F", "F2")] == [
        "F1",
        "",
        "F2",
    ]
    modal.forget("F", "G")
    assert modal.word("F", "F2") == "F2"
    modal.set("F", "F3")
    assert not modal.word("F", "F3")


@given(st.text())
def test_every_text_becomes_printable(text: str) -> None:
    assert all(" " <= character <= "~" for character in ascii_text(text))


def test_accents_fall() -> None:
    assert ascii_text("Größe é Ø8") == "Grosse e D8"


def test_brackets_do_not_nest() -> None:
    assert bracketed("a (b) c", 80) == "(a [b] c)"
    assert bracketed("abcdef", 3) == "(abc)"
