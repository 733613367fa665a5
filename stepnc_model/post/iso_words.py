"""One line of G-code as words: letters with numbers, each taken once."""

import re
from collections.abc import Iterator

from stepnc_model.errors import PostError

NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
WORD = re.compile(rf"\s*([A-Z])\s*({NUMBER})")

LARGEST = 1e9
"""no word of NC code means more: coordinates are mm"""

UNSIGNED = frozenset("DFHNPQST")
"""words that are never negative: feeds, speeds, tools, pauses"""

LONGEST = 60
"""characters of a line that a message shows"""


class Words:
    """The words of a line. Running state: what was taken is gone."""

    def __init__(self, pairs: Iterator[tuple[str, str]]) -> None:
        self.codes: list[str] = []
        """G words, shortened: ``G1``"""
        self.functions: list[str] = []
        """M words, shortened: ``M3``"""
        self.pointless: set[str] = set()
        """letters of numbers without a point: some controls count those in thousandths"""
        self._values: dict[str, float] = {}
        for letter, text in pairs:
            value = number_of(letter, text)
            if "." not in text:
                self.pointless.add(letter)
            if letter in {"G", "M"}:
                kind = self.codes if letter == "G" else self.functions
                kind.append(f"{letter}{value:g}")
            elif letter in self._values:
                raise PostError(f"word {letter}{text}: a second {letter} in one block")
            elif letter in UNSIGNED and value < 0.0:
                raise PostError(f"word {letter}{text}: must not be negative")
            else:
                self._values[letter] = value

    def __contains__(self, letter: str) -> bool:
        return letter in self._values

    def take(self, letter: str) -> float | None:
        """Value of a word, which is used up by this."""
        return self._values.pop(letter, None)

    def need(self, letter: str, purpose: str) -> float:
        """Value of a word that must be there."""
        value = self.take(letter)
        if value is None:
            raise PostError(f"{purpose}: the word {letter} is missing")
        return value

    def finish(self) -> None:
        """Nothing may be left over."""
        if self._values:
            words = " ".join(f"{letter}{value:g}" for letter, value in self._values.items())
            raise PostError(f"word {words}: nothing in this block uses it")


def pairs(text: str) -> Iterator[tuple[str, str]]:
    """Letters and numbers of a line without comments.

    Raises
    ------
    PostError
        At what is no word.
    """
    at = 0
    end = len(text.rstrip())
    while at < end:
        found = WORD.match(text, at)
        if found is None:
            raise PostError(f"'{shown(text[at:end])}': no word of NC code")
        yield found[1], found[2]
        at = found.end()


def number_of(word: str, text: str) -> float:
    """Value of a word.

    Raises
    ------
    PostError
        When no machine is so large.
    """
    value = float(text)
    if not abs(value) <= LARGEST:
        raise PostError(f"word {word}{shown(text)}: beyond {LARGEST:g}")
    return value


def shown(text: str) -> str:
    """What a message shows of a line: its beginning, on one line."""
    plain = " ".join(text.split())
    return plain if len(plain) <= LONGEST else f"{plain[:LONGEST]}…"


def whole(value: float, word: str) -> int:
    """A number that must be whole and positive, as tools and turns are."""
    if value != int(value) or value < 1.0:
        raise PostError(f"word {word}{value:g}: must be a whole number above 0")
    return int(value)
