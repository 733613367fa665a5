"""Strings: each directive by its own, and what is no directive."""

import pytest

from stepnc_model.part21.tokens import decode, encode
from tests.every_case import every_case


@every_case(
    ("raw", "text"),
    [
        ("", ""),
        ("plain; text, with (brackets) #5=", "plain; text, with (brackets) #5="),
        ("d''usinage", "d'usinage"),
        (r"a\\b", r"a\b"),
        (r"\X2\00E9\X0\t\X2\00E9\X0\ ", "été "),
        (r"\X2\03B103B2\X0\ ", "αβ "),
        (r"\X2\03b1\X0\ ", "α "),
        (r"\X4\0001F600\X0\ ", "😀 "),
        (r"\X\E9t\X\E9", "été"),
        (r"\S\D\S\<", "Ä¼"),
        (r"\PE\\S\P\S\`", "ар"),
        (r"\PB\\S\!\PA\\S\D", "ĄÄ"),
        (r"line\N\text\F\ ", "line\ntext\f "),
        ("over\r\ntwo lines", "overtwo lines"),
        ("caf\xc3\xa9", "café"),
        ("caf\xe9", "café"),
    ],
)
def test_directive_is_decoded(raw: str, text: str) -> None:
    assert decode(raw) == text


@every_case(
    "raw",
    [
        r"C:\temp",
        r"\X2\00E9",
        r"\X2\00E\X0\ ",
        r"\X4\FFFFFFFF\X0\ ",
        r"\X\G1",
        "\\",
        r"\PC\\S\%",
    ],
)
def test_what_is_no_directive_stays(raw: str) -> None:
    assert decode(raw).replace("\\", "") == raw.replace("\\PC\\", "").replace("\\", "")


def test_encoded_text_is_ascii_with_wide_directives() -> None:
    assert encode("50 % Ø 'x' \\ 😀") == r"50 % \X2\00D8\X0\ ''x'' \\ \X4\0001F600\X0" + "\\"


@pytest.mark.parametrize(
    "text", ["\ud83d\ude00", "\udc00", "a\nb\tc\x7f", "\r\n", "é\U0010ffff€"]
)
def test_odd_characters_come_back(text: str) -> None:
    assert encode(text).isascii()
    assert decode(encode(text)) == text
