"""Words of one block in the manner of ISO 6983, as a control would sort them.

G and M codes are whole numbers of tenths, so that G38.2 is 382. Words with variables or
expressions are listed apart: their values are not known.
"""

import re
from dataclasses import dataclass, field

from stepnc_model.nc.token import TokenKind, tokens
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.words import LARGEST

PLAIN = re.compile(
    r"(?:N[0-9]{1,9} ?)?(?:G0?([01])(?![0-9.]) ?)?"
    r"(?:X([-+]?[0-9]{1,9}\.[0-9]{0,9}) ?)?(?:Y([-+]?[0-9]{1,9}\.[0-9]{0,9}) ?)?"
    r"(?:Z([-+]?[0-9]{1,9}\.[0-9]{0,9}) ?)?(?:F([0-9]{1,9}(?:\.[0-9]{0,9})?) ?)?\r?\n?",
    re.IGNORECASE,
)
"""Block that moves on a straight line, and does nothing else."""


@dataclass(slots=True, kw_only=True)
class BlockWords:
    """Words of one block. Mutable while the block is executed: used words are taken out."""

    codes: list[int] = field(default_factory=list)
    """G codes in tenths, in the order of the block."""
    functions: list[int] = field(default_factory=list)
    """M codes in tenths."""
    values: dict[str, float] = field(default_factory=dict)
    """Number of each other address."""
    pointless: set[str] = field(default_factory=set)
    """Addresses whose number has no decimal point."""
    macros: dict[str, str] = field(default_factory=dict)
    """Value of each address that is given by a variable or an expression."""
    calls: list[tuple[str, str]] = field(default_factory=list)
    """Names with their arguments."""
    names: list[str] = field(default_factory=list)
    """Keywords and other names."""
    flows: list[str] = field(default_factory=list)
    """Statements that steer the flow of the program."""
    strange: list[str] = field(default_factory=list)
    """Pieces of text that are no words."""
    number: int | None = None
    """Block number N."""
    label: str = ""
    is_skippable: bool = False
    assignments: list[str] = field(default_factory=list)
    """Values given to variables, as written."""
    evaluated: set[str] = field(default_factory=set)
    """Addresses whose value was computed from variables."""
    is_percent: bool = False
    comments: list[str] = field(default_factory=list)
    """Comments as they are written, with their marks."""

    @property
    def is_empty(self) -> bool:
        """True if the block holds nothing that a control executes."""
        return not (
            self.codes
            or self.functions
            or self.values
            or self.macros
            or self.calls
            or self.names
            or self.flows
            or self.strange
        )


def words_of(text: str, dialect: Dialect) -> BlockWords:
    """Sort the words of a block.

    Examples
    --------
    >>> words = words_of("N10 G1 X5. F[#2*2] M8", Dialect.FANUC)
    >>> words.codes, words.functions, words.values, words.macros
    ([10], [80], {'X': 5.0}, {'F': '[#2*2]'})
    """
    words = BlockWords()
    for kind, start, end, name, value in tokens(text, dialect):
        if kind is TokenKind.WORD:
            _take(words, name, value)
        elif kind is TokenKind.MACRO:
            words.macros[name] = value
        elif kind is TokenKind.FLOW:
            words.flows.append(value.strip())
        elif kind is TokenKind.CALL:
            words.calls.append((name, value[1:-1]))
        elif kind is TokenKind.NAME:
            words.names.append(name)
        elif kind is TokenKind.LABEL:
            words.label = name
        elif kind is TokenKind.SKIP:
            words.is_skippable = True
        elif kind is TokenKind.ASSIGNMENT:
            words.assignments.append(value)
        else:
            _take_text(words, kind, text[start:end])
    return words


def _take_text(words: BlockWords, kind: TokenKind, text: str) -> None:
    """Sort in what is no word: percent signs, comments, and what is not understood."""
    if kind is TokenKind.PERCENT:
        words.is_percent = True
    elif kind is TokenKind.COMMENT:
        words.comments.append(text)
    elif kind in {TokenKind.OTHER, TokenKind.TEXT}:
        words.strange.append(text)


def _take(words: BlockWords, name: str, value: str) -> None:
    """Sort in one word with a number."""
    number = float(value)
    if not abs(number) <= LARGEST:
        words.strange.append(f"{name}{value[:20]}")
        return
    if name in words.values and name not in {"G", "M", "N"}:
        words.strange.append(f"{name}{value}")
    take_word(words, name, number)
    if "." not in value and name not in {"G", "M"}:
        words.pointless.add(name)


def take_word(words: BlockWords, name: str, number: float) -> None:
    """Sort in a word by its address and its number."""
    if name == "G":
        words.codes.append(round(10.0 * number))
    elif name == "M":
        words.functions.append(round(10.0 * number))
    elif name == "N" and words.number is None:
        words.number = round(number)
    else:
        words.values["O" if name == ":" else name] = number
