"""Fast parser of parameters that strictly follow the standard, by one regular expression.

Nearly all text of nearly all files is of this kind. Everything else is parsed by
:mod:`stepnc_model.part21.record`; both give the same values where both apply.
"""

import re

from stepnc_model.part21.strings import decode
from stepnc_model.part21.tokens import BINARY, ENUMERATION, KEYWORD, STRING
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Typed, Value

_SCALAR = (
    r"(?:#[0-9]{1,18}+|[+-]?[0-9]{1,300}+(?>(?:\.[0-9]*+(?>(?:E[+-]?[0-9]++)?))?)"
    rf"|{STRING}|\$|{ENUMERATION}|\*|{BINARY})"
)


def _list_of(value: str) -> str:
    """Pattern of a bracketed list whose items match a pattern."""
    return rf"\(\s*+(?>(?:{value}\s*+(?>(?:,\s*+{value}\s*+)*))?)\)"


def _value_of_depth(depth: int) -> str:
    """Pattern of a value with lists and types nested up to a depth."""
    if depth == 0:
        return _SCALAR
    inner = _value_of_depth(depth - 1)
    return rf"(?:{_SCALAR}|{_list_of(inner)}|{KEYWORD}\s*+\(\s*+{inner}\s*+\))"


_TIDY = re.compile(
    rf"#[0-9]++\s*+=\s*+{KEYWORD}\s*+{_list_of(_value_of_depth(2))}\s*+;", re.ASCII
)
_REAL = r"[+-]?[0-9]++\.[0-9]*+(?>(?:E[+-]?[0-9]++)?)"
_new_float = float.__new__
# Flat lists of reals or of references, the bulk of large files, are one token each.
_TOKEN = re.compile(
    rf"\((?>(?:{_REAL},)*){_REAL}\)|\((?>(?:#[0-9]++,)*)#[0-9]++\)"
    rf"|#[0-9]++|[+-]?[0-9][0-9.E+-]*+|[()$*]|{STRING}|{ENUMERATION}|{BINARY}|{KEYWORD}",
    re.ASCII,
)


def is_tidy(text: str) -> bool:
    """Whether ``#1=KEYWORD(...);`` strictly follows the standard in its plain form.

    The standard also allows comments and deeper nested lists, which are not tidy.
    """
    return _TIDY.fullmatch(text) is not None


def tidy_values(text: str) -> tuple[Value, ...]:
    """Values of a text that :func:`is_tidy` accepts."""
    open_lists: list[tuple[list[Value], str]] = []
    values: list[Value] = []
    keyword = ""
    for token in _TOKEN.findall(text, text.index("(") + 1, text.rindex(")")):
        head = token[0]
        if head == "#":
            values.append(Ref(token[1:]))
        elif head in "0123456789-+":
            values.append(_real(token) if "." in token else int(token))
        elif head == "'":
            values.append(decode(token[1:-1]) if token != "''" else "")
        elif token == "(":
            open_lists.append((values, keyword))
            values, keyword = [], ""
        elif head == "(":
            flat = _references(token) if token[1] == "#" else _reals(token)
            values.append(Typed(keyword, flat[0]) if keyword else flat)
            keyword = ""
        elif head == ")":
            inner = values
            values, named = open_lists.pop()
            values.append(Typed(named, inner[0]) if named else tuple(inner))
        elif head in '$.*"':
            values.append(_mark(token))
        else:
            keyword = token.upper()
    return tuple(values)


def _references(text: str) -> tuple[Value, ...]:
    """Values of a flat list of references, ``(#1,#2)``."""
    return tuple(map(Ref, text[2:-1].split(",#")))


def _reals(text: str) -> tuple[Value, ...]:
    """Values of a flat list of reals, ``(0.,1.)``."""
    return tuple(map(_real, text[1:-1].split(",")))


def _real(lexeme: str) -> Real:
    """Real with its characters, created without calling ``Real.__new__`` for speed."""
    real = _new_float(Real, lexeme)
    real.lexeme = lexeme
    return real


def _mark(token: str) -> Value:
    """Unset or derived value, enumeration or binary."""
    if token == "$":
        return None
    if token[0] == ".":
        return Enumeration(token[1:-1].upper())
    return DERIVED if token == "*" else Binary(token[1:-1])
