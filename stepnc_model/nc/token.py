"""Tokens of a block of NC code: words, comments and everything else, each with its place.

The tokens of a block, laid end to end, are the block: whatever fits no other kind is a token
of the kind :attr:`TokenKind.OTHER`. Nothing is judged here.
"""

import re
from collections.abc import Iterator
from enum import IntEnum
from typing import NamedTuple

from stepnc_model.post.dialect import Dialect


class TokenKind(IntEnum):
    """Kinds of tokens."""

    SPACE = 1
    """Blanks, tabs and null bytes."""
    LINE_END = 2
    COMMENT = 3
    SKIP = 4
    """Block delete, ``/`` or ``/2``."""
    PERCENT = 5
    WORD = 6
    """Address with a number, such as ``X-1.5``; of Sinumerik also ``CR=10``."""
    MACRO = 7
    """Address whose value is a variable or an expression, such as ``X[#1+2]``."""
    ASSIGNMENT = 8
    """Value given to a variable."""
    FLOW = 9
    """Statement that steers the flow of the program, such as ``o100 sub`` or ``IF``."""
    CALL = 10
    """Name with arguments, such as ``CYCLE81(...)``."""
    NAME = 11
    """Keyword or other name."""
    LABEL = 12
    """Target of jumps and repeats."""
    TEXT = 13
    """String in quotation marks."""
    NUMBER = 14
    """Number without an address."""
    CONTINUATION = 15
    """Tilde of Klartext, with the line end that it continues."""
    OTHER = 16


class Token(NamedTuple):
    """Piece of a block."""

    kind: TokenKind
    start: int
    """Offset of the first character in the block."""
    end: int
    name: str
    """Address, keyword or name in capitals; empty for other kinds."""
    value: str
    """Number, expression or arguments as written."""


BYTE_ORDER_MARK = "\xef\xbb\xbf"
"""Mark of UTF-8 at the beginning of a file, one character a byte; a blank to the control."""

NUMBER = r"[-+]?(?:[0-9]++\.?+[0-9]*+|\.[0-9]++)"
_BLANK = r"[ \t\x0b\x0c\x00]"
_BRACKET = r"\[[^\[\]\r\n]*+\]"
for _ in range(3):
    _BRACKET = rf"\[(?>(?:[^\[\]\r\n]|{_BRACKET})*)\]"
_VARIABLE = rf"\#{_BLANK}*+(?:[0-9]++|<[^<>\r\n]*+>|\#++[0-9]++|{_BRACKET})"
_TERM = rf"[-+]?(?:{_BRACKET}|{_VARIABLE}|[A-Za-z]{{2,6}}{_BRACKET}(?:/{_BRACKET})?)"
_ARGUMENTS = r"\((?>(?:[^()\"\r\n]|\"[^\"\r\n]*+\"|\((?>(?:[^()\r\n]|\([^()\r\n]*+\))*)\))*)\)"
_VALUE = rf"(?>(?:{_ARGUMENTS}|\"[^\"\r\n]*+\"|\[[^\[\]\r\n]*+\]|[^\s;()\[\]\"])+)"
_ADDRESS = r"IPA|IPR|I[XYZABCUVW]|PA|PR|DR|DL|CCA|FU|FZ|FT|REP|[XYZABCUVWFSRMT]"

# The last group of an alternative names the kind and holds the value; a group of_KIND holds
# the name. No group repeats over what another could match: no input makes them slow.
_COMMON = (rf"(?P<SPACE>{_BLANK}++|\A{BYTE_ORDER_MARK})", r"(?P<LINE_END>\r\n|\n|\r)")
_LAST = (r"(?P<SKIP>/[0-9]?)", r"(?P<PERCENT>%)", r"(?P<OTHER>.)")
_ISO = (
    rf"(?P<ASSIGNMENT>{_VARIABLE}{_BLANK}*+={_BLANK}*+(?>(?:{_BRACKET}|[^\s;(\[\]])*))",
    rf"(?P<of_WORD>(?:,{_BLANK}*+)?[A-Za-z:$]){_BLANK}*+(?P<WORD>{NUMBER})",
    rf"(?P<of_MACRO>(?:,{_BLANK}*+)?[A-Za-z]){_BLANK}*+(?P<MACRO>{_TERM})",
)
_ROUND_COMMENT = r"(?P<COMMENT>\([^)\r\n]*+\)?+|;[^\r\n]*+)"
_LINUXCNC_FLOW = (
    rf"(?P<FLOW>o{_BLANK}*+(?:[0-9]++|<[^<>\r\n]*+>|{_TERM}){_BLANK}*+[a-z]"
    rf"(?>(?:{_BRACKET}|[^\r\n;(\[])*))"
)
_FANUC_FLOW = (
    r"(?P<FLOW>(?:IF|WHILE|GOTO|DO|END|THEN|DPRNT|BPRNT|POPEN|PCLOS|SETVN)(?![a-z])"
    rf"(?>(?:{_BRACKET}|[^\r\n;(\[])*))"
)
_QUOTED = r'(?P<TEXT>"[^"\r\n]*+"?+)'
_SINUMERIK = (
    r"(?P<COMMENT>;[^\r\n]*+)",
    _QUOTED,
    r"(?P<FLOW>(?:IF|GOTO[FBCS]?|WHILE|ENDWHILE|FOR|ENDFOR|LOOP|ENDLOOP|UNTIL|ELSE|ENDIF|CASE|"
    r"REPEATB|REPEAT|DEF|PROC|EXTERN)(?![a-z0-9_=])[^\r\n;]*+)",
    rf"(?P<of_CALL>(?:MCALL{_BLANK}++)?[a-z_]{{2}}[a-z0-9_]*+){_BLANK}*+(?P<CALL>{_ARGUMENTS})",
    rf"(?P<of_WORD>[a-z_$]{{2}}[a-z0-9_]*+|[a-z][0-9]*+){_BLANK}*+={_BLANK}*+"
    rf"(?P<WORD>{NUMBER})(?![^\s;a-z])",
    rf"(?P<of_MACRO>[a-z_$]{{2}}[a-z0-9_$]*+(?:\[[^\[\]\r\n]*+\])?|[a-z][0-9]*+)"
    rf"{_BLANK}*+={_BLANK}*+(?P<MACRO>{_VALUE})",
    r"(?P<LABEL>[a-z_]{2}[a-z0-9_]*+:)",
    r"(?P<NAME>[a-z_]{2}[a-z0-9_]*+|%_N_[a-z0-9_]*+)",
    rf"(?P<of_WORD2>[a-z]){_BLANK}*+(?P<WORD2>{NUMBER})",
)
_HEIDENHAIN = (
    r"(?P<COMMENT>;[^\r\n~]*+|\*{1,2}[ \t]*+-[^\r\n]*+)",
    _QUOTED,
    r"(?P<CONTINUATION>~[ \t]*+(?:\r\n|\n|\r)?)",
    rf"(?P<of_ASSIGNMENT>Q[LRS]?[0-9]++){_BLANK}*+={_BLANK}*+"
    rf"(?P<ASSIGNMENT>{NUMBER}|[^\s;~]++)",
    r"(?P<NAME>DR[-+](?![0-9.Q])|R[0LR](?![0-9.A-Z])|[A-Z]{2,}+(?![-+.0-9Q])"
    r"|[A-Z](?![-+.0-9A-Z])(?![ \t]*+(?:[-+.]?[0-9]|[-+]?Q[LRS]?[0-9])))",
    rf"(?P<of_MACRO>{_ADDRESS}){_BLANK}*+(?P<MACRO>[-+]?Q[LRS]?[0-9]++)",
    rf"(?P<of_WORD>{_ADDRESS}){_BLANK}*+(?P<WORD>{NUMBER})",
    r"(?P<NAME2>[A-Z][A-Z0-9_]*+)",
    rf"(?P<NUMBER>{NUMBER})",
)


def _compiled(*alternatives: str) -> re.Pattern[str]:
    return re.compile("|".join((*_COMMON, *alternatives, *_LAST)), re.DOTALL | re.IGNORECASE)


GRAMMARS = {
    Dialect.LINUXCNC: _compiled(_ROUND_COMMENT, _LINUXCNC_FLOW, *_ISO),
    Dialect.FANUC: _compiled(_ROUND_COMMENT, _FANUC_FLOW, *_ISO),
    Dialect.HAAS: _compiled(_ROUND_COMMENT, _FANUC_FLOW, *_ISO),
    Dialect.SINUMERIK: _compiled(*_SINUMERIK),
    Dialect.HEIDENHAIN: _compiled(*_HEIDENHAIN),
}
"""Pattern of all tokens by dialect; it matches at every place of every text."""

_KINDS: dict[str, TokenKind] = {
    group: TokenKind[group.rstrip("2")]
    for grammar in GRAMMARS.values()
    for group in grammar.groupindex
    if not group.startswith("of_")
}
_NAMES = {group: f"of_{group}" for group in _KINDS}
_NAMED = {
    grammar: {g for g in _KINDS if _NAMES[g] in grammar.groupindex}
    for grammar in GRAMMARS.values()
}
_BARE = {TokenKind.NAME, TokenKind.LABEL}


def tokens(text: str, dialect: Dialect) -> Iterator[Token]:
    """Split a block into tokens; their texts joined are the block.

    Examples
    --------
    >>> [t.name + t.value for t in tokens("N5 g1 X-1.5 (cut)", Dialect.FANUC)]
    ['N5', ' ', 'G1', ' ', 'X-1.5', ' ', '(cut)']
    """
    grammar = GRAMMARS[dialect]
    named = _NAMED[grammar]
    for found in grammar.finditer(text):
        group = found.lastgroup or "OTHER"
        kind = _KINDS[group]
        name, value = "", found[group]
        if group in named:
            name = found[_NAMES[group]].upper().replace(" ", "")
        elif kind in _BARE:
            name, value = value.upper().rstrip(":"), ""
        yield Token(kind, found.start(), found.end(), name, value)
