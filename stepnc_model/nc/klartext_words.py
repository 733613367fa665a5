"""Words of one block of Heidenhain Klartext."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from stepnc_model.nc.moves import MoveFlag
from stepnc_model.nc.token import NUMBER, Token, TokenKind, tokens
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.words import LARGEST

PLAIN = re.compile(NUMBER)

FORMULA_ENDS = {
    TokenKind.COMMENT,
    TokenKind.CONTINUATION,
    TokenKind.LINE_END,
    TokenKind.ASSIGNMENT,
}
"""Kinds of tokens at which the value of a Q parameter ends."""

BLANK = {TokenKind.SPACE, TokenKind.LINE_END, TokenKind.COMMENT}

PLAIN_FUNCTIONS = {0, 10, 20, 30, 40, 50, 80, 90, 130, 140, 300}
"""M functions in tenths that a divided block may hold."""


@dataclass(slots=True, kw_only=True)
class KlartextWords:
    """Words of one block, sorted."""

    names: list[str] = field(default_factory=list)
    """Keywords, in the order of the block."""
    numbers: list[float] = field(default_factory=list)
    """Numbers without an address, without the block number."""
    values: dict[str, float] = field(default_factory=dict)
    """Number of each address."""
    macros: dict[str, str] = field(default_factory=dict)
    """Variable of each address that takes its value from one."""
    assigned: dict[str, float] = field(default_factory=dict)
    """Values given to Q parameters, as far as they are numbers."""
    formulas: dict[str, str] = field(default_factory=dict)
    """Values given to Q parameters, as written."""
    evaluated: set[str] = field(default_factory=set)
    """Addresses whose number was computed from Q parameters."""
    functions: list[int] = field(default_factory=list)
    """M codes in tenths."""
    texts: list[str] = field(default_factory=list)
    strange: list[str] = field(default_factory=list)
    cycle: str = ""
    """Number of a defined cycle, such as ``200`` or ``7.1``."""
    label: str = ""
    """Label of LBL and CALL LBL."""
    is_skippable: bool = False
    comments: list[str] = field(default_factory=list)
    """Comments beside words other than parameters, as they are written."""

    @property
    def is_empty(self) -> bool:
        """True if the block names nothing that a control executes."""
        return not (self.names or self.values or self.functions)

    @property
    def axes(self) -> set[str]:
        """Axes that the block names, absolute or relative."""
        return {name.removeprefix("I") for name in (*self.values, *self.macros)}

    @property
    def sense(self) -> float:
        """1 for DR+, -1 for DR-, 0 without one of them."""
        if "DR+" in self.names:
            return 1.0
        return -1.0 if "DR-" in self.names else 0.0


def klartext_words(text: str) -> KlartextWords:
    """Sort the words of a block.

    Examples
    --------
    >>> words = klartext_words("12 L X+10 IY-2 R0 F500 M3")
    >>> words.names, words.values, words.functions
    (['L', 'R0'], {'X': 10.0, 'IY': -2.0, 'F': 500.0}, [30])
    """
    words = KlartextWords()
    is_first = True
    if ";" in text or "*" in text:
        words.comments = _comments(text)
    for kind, start, end, name, value in _apart_from_formulas(text, words):
        if kind is TokenKind.NUMBER:
            if not is_first:
                _number(words, value)
        elif kind is TokenKind.WORD:
            _word(words, name, value)
        elif kind is TokenKind.MACRO:
            words.macros[name] = value
        elif kind is TokenKind.NAME:
            words.names.append(name)
        elif kind is TokenKind.ASSIGNMENT:
            words.assigned[name] = float(value) if PLAIN.fullmatch(value) else float("nan")
        elif kind is TokenKind.TEXT:
            _text(words, value)
        elif kind is TokenKind.SKIP and is_first:
            words.is_skippable = True
        elif kind is TokenKind.OTHER:
            words.strange.append(text[start:end])
        is_first = False
    return words


def _comments(text: str) -> list[str]:
    """Comments of a block; beside parameters they only name these."""
    found = list(tokens(text, Dialect.HEIDENHAIN))
    if {TokenKind.ASSIGNMENT, TokenKind.CONTINUATION} & {each.kind for each in found}:
        return []
    return [each.value for each in found if each.kind is TokenKind.COMMENT]


def _apart_from_formulas(text: str, words: KlartextWords) -> Iterator[Token]:
    """Yield what is not blank in a block; what follows an equals sign becomes a formula."""
    assigned, begin = "", 0
    for token in tokens(text, Dialect.HEIDENHAIN):
        if assigned and token.kind in FORMULA_ENDS:
            words.formulas[assigned], assigned = text[begin : token.start], ""
        if assigned or token.kind in BLANK:
            continue
        if token.kind is TokenKind.ASSIGNMENT:
            assigned, begin = token.name, token.end - len(token.value)
        yield token
    if assigned:
        words.formulas[assigned] = text[begin:]


def flags_of(words: KlartextWords) -> MoveFlag:
    """Flags that concern the whole block."""
    flags = MoveFlag(0)
    if words.macros or words.evaluated:
        flags |= MoveFlag.MACRO
    if "F" in words.values or "F" in words.macros or "FU" in words.values:
        flags |= MoveFlag.OWN_FEED
    if set(words.functions) - PLAIN_FUNCTIONS:
        flags |= MoveFlag.FIXED
    if words.is_skippable:
        flags |= MoveFlag.SKIPPABLE
    return flags


def _word(words: KlartextWords, name: str, text: str) -> None:
    """Take an address with a number."""
    value = float(text)
    if not abs(value) <= LARGEST:
        words.strange.append(f"{name}{text[:20]}")
        words.macros[name] = text
    elif name == "M":
        words.functions.append(round(10.0 * value))
    else:
        words.values[name] = value


def _number(words: KlartextWords, value: str) -> None:
    """Take a number without an address: of a cycle, a label, or another."""
    last = words.names[-1:]
    number = min(float(value), LARGEST)
    if last == ["DEF"] and words.names[:1] == ["CYCL"] and not words.cycle:
        words.cycle = value
    elif last == ["LBL"] and not words.label:
        words.label = value
    elif last == ["REP"] or (words.names[:1] == ["CALL"] and "REP" in words.names):
        words.values.setdefault("REP", number)
    else:
        words.numbers.append(number)


def _text(words: KlartextWords, value: str) -> None:
    if words.names[-1:] == ["LBL"]:
        words.label = value.upper()
    else:
        words.texts.append(value)
