"""One line of G-code as words."""

import pytest

from stepnc_model.errors import PostError
from stepnc_model.post.words import LineWords, pairs, whole
from tests.every_case import every_case


def test_words_need_no_spaces() -> None:
    assert list(pairs("G01X-.5 Y+10. F 100")) == [
        ("G", "01"),
        ("X", "-.5"),
        ("Y", "+10."),
        ("F", "100"),
    ]


@every_case("text", ["X", "X1..2", "1X", "x1", "X#1", "X[1+2]", "GOTO 10"])
def test_what_is_no_word_is_refused(text: str) -> None:
    with pytest.raises(PostError, match="not a word of NC code"):
        list(pairs(text))


def test_codes_are_shortened() -> None:
    words = LineWords(pairs("G01 G91.1 M03 X1"))
    assert (words.codes, words.functions) == (["G1", "G91.1"], ["M3"])


def test_a_letter_said_twice_is_refused() -> None:
    with pytest.raises(PostError, match="X2: X appears twice"):
        LineWords(pairs("X1 X2"))


def test_a_word_is_taken_once() -> None:
    words = LineWords(pairs("X1 Y2"))
    assert "X" in words
    assert (words.take("X"), words.take("X")) == (1.0, None)
    with pytest.raises(PostError, match="Y2: not used by this block"):
        words.finish()


def test_a_missing_word_is_named_with_its_purpose() -> None:
    with pytest.raises(PostError, match="G4: the word P is missing"):
        LineWords(pairs("G4")).need("P", "G4")


@pytest.mark.parametrize("value", [0.0, 1.5, -1.0])
def test_tools_are_whole_numbers(value: float) -> None:
    with pytest.raises(PostError, match="whole number above 0"):
        whole(value, "T")
    assert whole(12.0, "T") == 12
