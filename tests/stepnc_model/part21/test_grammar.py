"""Blanks, comments and brackets over bytes."""

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.grammar import MAX_DEPTH, closing, skip_blank
from stepnc_model.part21.places import SyntaxSlip


def test_blanks_and_comments_are_passed() -> None:
    slips: list[SyntaxSlip] = []
    assert skip_blank(b" \r\n/* a */\t/**/x", 0, slips=slips) == 15
    assert skip_blank(b"x", 0, slips=slips) == 0
    assert slips == []


def test_nested_comment_is_noted_with_what_it_hides() -> None:
    slips: list[SyntaxSlip] = []
    assert skip_blank(b"/* a /* #1=A(); #2 = B(); */ */", 0, slips=slips) == 29
    assert "it hides 2 instances" in slips[0].message


def test_comment_without_end_is_an_error_where_it_begins() -> None:
    with pytest.raises(Part21Error) as caught:
        skip_blank(b"\n /* a *", 0, slips=[])
    assert (caught.value.line, caught.value.column) == (2, 2)


@pytest.mark.parametrize(
    ("text", "end"),
    [
        (b"()", 2),
        (b"(a,(b),'it''s )',\")\",/* ) */ /1) ;", 32),
        (b"(a;)", -1),
        (b"((a)", -1),
        (b"(a,'b)", -1),
    ],
)
def test_closing_bracket_is_found_outside_strings_and_comments(text: bytes, end: int) -> None:
    assert closing(text, 0) == end


def test_brackets_too_deep_are_an_error() -> None:
    deepest = b"(" * MAX_DEPTH + b")" * MAX_DEPTH
    assert closing(deepest, 0) == 2 * MAX_DEPTH
    with pytest.raises(Part21Error, match="nested deeper"):
        closing(b"(" + deepest + b")", 0)
