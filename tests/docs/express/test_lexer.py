import pytest

from docs.hooks.express.lexer import TokenKind, tokens
from stepnc_model.errors import SchemaError


def texts(source: str) -> list[str]:
    return [token.text for token in tokens(source)[:-1]]


def test_remarks_nest_and_vanish() -> None:
    assert texts("a (* one (* two *) still one *) b") == ["a", "b"]


def test_tail_remark_ends_with_its_line() -> None:
    assert texts("a -- b (* c\nd") == ["a", "d"]


def test_remark_markers_within_a_string_are_text() -> None:
    assert texts("'(* no remark -- at all'") == ["'(* no remark -- at all'"]


def test_apostrophe_is_doubled_within_a_string() -> None:
    assert texts("'it''s' x") == ["'it''s'", "x"]


def test_longest_symbol_wins() -> None:
    assert texts("a :<>: b := c <* d || e ** f") == [
        *("a", ":<>:", "b", ":=", "c", "<*", "d", "||", "e", "**", "f")
    ]


def test_numbers_are_one_token() -> None:
    assert texts("1.5E-3 2. 7 %1010") == ["1.5E-3", "2.", "7", "%1010"]


def test_lines_count_from_one_and_through_remarks() -> None:
    assert [token.line for token in tokens("a\n(* \n *) b\n")] == [1, 3, 4]


def test_end_is_always_there() -> None:
    assert [token.kind for token in tokens("")] == [TokenKind.END]


def test_space_before_a_token_is_known() -> None:
    assert [token.is_apart for token in tokens("a(b, c)")[:-1]] == [
        *(False, False, False, False, True, False)
    ]


@pytest.mark.parametrize(
    ("source", "line", "words"),
    [
        ("a\n(* b (* c *)", 2, "not closed"),
        ("\n'abc\n'", 2, "not closed"),
        ("a\n\n§", 3, "unexpected character '§'"),
    ],
)
def test_what_is_no_express_names_its_line(source: str, line: int, words: str) -> None:
    with pytest.raises(SchemaError, match=words) as caught:
        tokens(source)
    assert caught.value.line == line
