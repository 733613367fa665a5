"""Bounds of a TOML text, checked in one linear scan before the parser reads it.

The parser's time and memory grow with the square of the parts of a dotted key, and its calls
nest as brackets do: 64 KB of ``a.a.a`` cost it 4 GB. Within these bounds its cost is in
proportion to the size. Strings and comments are passed over; what stands in them never counts.
The scan has to agree with the parser only up to the first fault of a text, where the parser
stops.
"""

import re
from pathlib import Path

from simulator.errors import LibraryError

MOST_BYTES = 1 << 19
"""of a file; the library's have 3 KB, a tool table of 400 tools has 100 KB"""

MOST_PARTS = 20
"""of a dotted key or table header; the library's have 2"""

MOST_NESTED = 20
"""arrays and inline tables within one another; the library's nest 2 deep"""

LONGEST_WORD = 400
"""letters of a key without quotes, or digits of a number: the largest float has 309"""

_TOKEN = re.compile(
    r'"""(?>(?:[^"\\]++|\\.|"(?!""))*)(?:"{3,5})?'
    r"|'''.*?(?:'{3,5}|\Z)"
    r'|"(?>(?:[^"\\\n]++|\\.)*)"?'
    r"|'[^'\n]*+'?"
    r"|\#[^\n]*+"
    r"|(?P<word>[A-Za-z0-9_+-]++)"
    r"|(?P<dot>\.)|(?P<open>[\[{])|(?P<close>[\]}])|(?P<next>[\n=,])",
    re.DOTALL,
)


def require_bounded(text: str, path: Path) -> None:
    """Refuse a text that may cost the parser more than in proportion to its size.

    Raises
    ------
    LibraryError
        With the line, the value and the bound.
    """
    parts, nested = 1, 0
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup
        if kind == "dot":
            parts += 1
            if parts > MOST_PARTS:
                _refuse(text, match, path, f"a key of more than {MOST_PARTS} dotted parts")
        elif kind == "word":
            if len(match[0]) > LONGEST_WORD:
                what = f"a key or number of {len(match[0])} letters; at most {LONGEST_WORD}"
                _refuse(text, match, path, what)
        elif kind is not None:
            parts = 1
            nested += (kind == "open") - (kind == "close")
            if nested > MOST_NESTED:
                what = f"arrays and tables nested more than {MOST_NESTED} deep"
                _refuse(text, match, path, what)


def _refuse(text: str, match: re.Match[str], path: Path, what: str) -> None:
    """Raise the error at a token."""
    line = text.count("\n", 0, match.start()) + 1
    raise LibraryError(what, path=str(path), line=line)
