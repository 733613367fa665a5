"""No byte of a program is lost, whatever it is."""

import time

from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.nc.token import TokenKind, tokens
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case

CONTROLS = [control for control in Dialect if control is not Dialect.CANONICAL]
PIECES = st.sampled_from([
    *("N10", "G1", "X-1.5", "Y.5", "Z5.", "F100", "%", "/", "(a)", "(", ")", ";x", "[", "]"),
    *("#1", "#<a>", "=", "+", "o1 sub", "IF", "GOTO", "\t", " ", "\r", "\n", "\r\n", "~", '"'),
    *("CYCLE81(", "R1=2", "X=IC(3)", "LAB:", "L", "CC", "IX+1", "DR-", "Q1", "FMAX", "\xe9"),
    *("TOOL CALL", "LBL", "REP2", "9" * 30, "\x00", "\x85", "*", "CYCL DEF 200"),
])


@given(
    st.one_of(st.binary(max_size=60), st.lists(PIECES, max_size=20).map("".join)),
    st.sampled_from(CONTROLS),
)
def test_tokens_laid_end_to_end_are_the_block(drawn: bytes | str, control: Dialect) -> None:
    text = drawn if isinstance(drawn, str) else drawn.decode("latin-1")
    found = list(tokens(text, control))
    assert "".join(text[each.start : each.end] for each in found) == text
    assert all(each.end > each.start for each in found)


@every_case("control", CONTROLS)
@every_case(
    "text",
    ["X[", "X[a", "#", "((", '"', "A=(", "Q1=", "o1 a[", "IF [", "X#", "#<a", "o<", "aX[b"],
)
def test_a_long_line_takes_no_more_than_its_length(control: Dialect, text: str) -> None:
    # A square of the length would be minutes of the processor, whatever else it does.
    begun = time.process_time()
    list(tokens(text * 10_000, control))
    assert time.process_time() - begun < 10.0


@every_case(
    ("control", "text", "kind", "name", "value"),
    [
        (Dialect.LINUXCNC, "o<a> call [1]", TokenKind.FLOW, "", "o<a> call [1]"),
        (Dialect.LINUXCNC, "x[#1+[2*3]]", TokenKind.MACRO, "X", "[#1+[2*3]]"),
        (Dialect.FANUC, ",R5.", TokenKind.WORD, ",R", "5."),
        (Dialect.FANUC, "WHILE [#1 LT 5] DO1", TokenKind.FLOW, "", "WHILE [#1 LT 5] DO1"),
        (Dialect.SINUMERIK, "CR=10.5", TokenKind.WORD, "CR", "10.5"),
        (Dialect.SINUMERIK, "X=IC(5)", TokenKind.MACRO, "X", "IC(5)"),
        (Dialect.SINUMERIK, "MCALL CYCLE81(1,2)", TokenKind.CALL, "MCALLCYCLE81", "(1,2)"),
        (Dialect.HEIDENHAIN, "IY-5.5", TokenKind.WORD, "IY", "-5.5"),
        (Dialect.HEIDENHAIN, "Q206=+150", TokenKind.ASSIGNMENT, "Q206", "+150"),
        (Dialect.HEIDENHAIN, "FQ1", TokenKind.MACRO, "F", "Q1"),
        (Dialect.HEIDENHAIN, "F Q1", TokenKind.MACRO, "F", "Q1"),
        *((each, "\xef\xbb\xbf", TokenKind.SPACE, "", "\xef\xbb\xbf") for each in CONTROLS),
    ],
)
def test_words_of_each_control(
    control: Dialect, text: str, kind: TokenKind, name: str, value: str
) -> None:
    (found,) = tokens(text, control)
    assert (found.kind, found.name, found.value) == (kind, name, value)
