import pytest

from docs.hooks.express.cursor import Cursor
from docs.hooks.express.lexer import TokenKind, tokens
from stepnc_model.errors import SchemaError


def at(source: str) -> Cursor:
    return Cursor(tokens(source))


def test_keywords_ignore_case() -> None:
    cursor = at("Subtype OF (a)")
    assert cursor.skip("SUBTYPE", "OF")
    assert cursor.next.text == "("


def test_skip_passes_all_or_nothing() -> None:
    cursor = at("SUBTYPE x")
    assert not cursor.skip("SUBTYPE", "OF")
    assert cursor.next.text == "SUBTYPE"


def test_names_are_lower_case() -> None:
    assert at("Cutting_Force").name("a name") == "cutting_force"


def test_list_in_brackets() -> None:
    assert at("(a, B, c)").names() == ("a", "b", "c")


def test_text_runs_to_the_symbol_outside_brackets() -> None:
    cursor = at("a[1:2] + f(b ; c) ; rest")
    assert cursor.text_until(";") == "a[1:2] + f(b ; c)"
    assert cursor.next.text == ";"


def test_symbol_within_a_string_ends_no_text() -> None:
    assert at("a = ';' ; b").text_until(";") == "a = ';'"


def test_end_stays() -> None:
    cursor = at("a")
    cursor.take()
    assert cursor.take().kind is TokenKind.END
    assert cursor.take().kind is TokenKind.END


def test_failure_says_what_was_expected_and_found() -> None:
    with pytest.raises(SchemaError, match="line 2: END_ENTITY expected, found x"):
        at("\nx").expect("END_ENTITY")
