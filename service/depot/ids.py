"""Names that sort by the time they were made, and that nobody guesses.

As in [1]_: 48 bits of milliseconds, then 80 random bits, in 26 letters of Crockford's base 32.

References
----------
.. [1] ULID, "Universally Unique Lexicographically Sortable Identifier", specification.
"""

import re
import secrets
import time

LETTERS = "0123456789abcdefghjkmnpqrstvwxyz"
LENGTH = 26
PATTERN = f"^[{LETTERS}]{{{LENGTH}}}$"
"""regular expression of an id"""

_ID = re.compile(PATTERN)
_RANDOM_BITS = 80


def new_id() -> str:
    """An id later than all that were made before this millisecond."""
    number = (time.time_ns() // 1_000_000) << _RANDOM_BITS | secrets.randbits(_RANDOM_BITS)
    return "".join(LETTERS[(number >> shift) & 31] for shift in range(5 * (LENGTH - 1), -1, -5))


def is_id(word: str) -> bool:
    """Whether this could be an id; nothing else ever becomes part of a path."""
    return _ID.match(word) is not None and len(word) == LENGTH
