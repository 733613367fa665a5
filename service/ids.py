"""Unique ids that sort by creation time and cannot be guessed.

As in [1]_: 48 bits of milliseconds, then 80 bits, in 26 letters of Crockford's base 32. The
first 12 of the 80 bits extend the clock, as in [2]_, section 6.2, method 3; 68 are random.

References
----------
.. [1] ULID, "Universally Unique Lexicographically Sortable Identifier", specification.
.. [2] RFC 9562, "Universally Unique IDentifiers (UUIDs)", 2024.
"""

import re
import secrets
import time

LETTERS = "0123456789abcdefghjkmnpqrstvwxyz"
LENGTH = 26
PATTERN = f"^[{LETTERS}]{{{LENGTH}}}$"
"""Regular expression of an id."""

_ID = re.compile(PATTERN)
_CLOCK_BITS = 12
_RANDOM_BITS = 68


def new_id() -> str:
    """Create an id that sorts after every id made at least 0.3 µs earlier."""
    ticks = (time.time_ns() << _CLOCK_BITS) // 1_000_000
    number = ticks << _RANDOM_BITS | secrets.randbits(_RANDOM_BITS)
    return "".join(LETTERS[(number >> shift) & 31] for shift in range(5 * (LENGTH - 1), -1, -5))


def is_id(word: str) -> bool:
    """True if a word has the form of an id; only such words may become part of a path."""
    return _ID.match(word) is not None and len(word) == LENGTH
