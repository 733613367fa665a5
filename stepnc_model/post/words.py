"""Words of NC code: numbers, texts, modal words, and the G codes of ISO 6983.

A line of G-code consists of letters with numbers, each used once. The actions of G codes have
names here; codes that most dialects share are listed in tables.
"""

import re
import unicodedata
from collections.abc import Iterator
from enum import Enum, auto

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import RateMode, SpindleDirection
from stepnc_model.toolpath.path import ArcPlane, CycleKind


class Modal:
    """Modal words of a writer: a word is written only when its value changes."""

    def __init__(self) -> None:
        self._words: dict[str, str] = {}

    def word(self, group: str, text: str) -> str:
        """Return the text if it is new in its group, else an empty string."""
        if self._words.get(group) == text:
            return ""
        self._words[group] = text
        return text

    def set(self, group: str, text: str) -> None:
        """Record what is in force without writing it."""
        self._words[group] = text

    def forget(self, *groups: str) -> None:
        """Forget the current words of some groups."""
        for group in groups:
            self._words.pop(group, None)


def decimal(value: float, places: int) -> str:
    """Format a number in its shortest form: ``10``, ``-0.5``."""
    text = f"{value:.{places}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def pointed(value: float, places: int) -> str:
    """Format a number always with a decimal point, as old controls need: ``10.``, ``-0.5``."""
    text = decimal(value, places)
    return text if "." in text else text + "."


def ascii_text(text: str) -> str:
    """Text in printable ASCII: accents are dropped, other characters become ``?``."""
    plain = unicodedata.normalize("NFKD", text.replace("ß", "ss").replace("Ø", "D"))
    kept = (c for c in plain if not unicodedata.combining(c))
    return "".join(c if " " <= c <= "~" else "?" for c in kept)


def bracketed(text: str, longest: int) -> str:
    """Comment in round brackets; brackets in the text become square."""
    inner = ascii_text(text).replace("(", "[").replace(")", "]")
    return f"({inner[:longest]})"


NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
WORD = re.compile(rf"\s*([A-Z])\s*({NUMBER})")

LARGEST = 1e9
"""Greatest value accepted in a word of NC code."""

UNSIGNED = frozenset("DFHNPQST")
"""Letters of words that are never negative: feeds, speeds, tools, dwells."""

LONGEST = 60
"""Greatest number of characters of a line that a message shows."""


class LineWords:
    """Words of one line of G-code; each word is removed when it is used."""

    def __init__(self, pairs: Iterator[tuple[str, str]]) -> None:
        self.codes: list[str] = []
        """G words in short form, such as ``G1``."""
        self.functions: list[str] = []
        """M words in short form, such as ``M3``."""
        self.pointless: set[str] = set()
        """Letters of numbers without a decimal point: some controls count them in µm or ms."""
        self._values: dict[str, float] = {}
        for letter, text in pairs:
            value = number_of(letter, text)
            if "." not in text:
                self.pointless.add(letter)
            if letter in {"G", "M"}:
                kind = self.codes if letter == "G" else self.functions
                kind.append(f"{letter}{value:g}")
            elif letter in self._values:
                raise PostError(f"word {letter}{text}: {letter} appears twice in one block")
            elif letter in UNSIGNED and value < 0.0:
                raise PostError(f"word {letter}{text}: must not be negative")
            else:
                self._values[letter] = value

    def __contains__(self, letter: str) -> bool:
        return letter in self._values

    def take(self, letter: str) -> float | None:
        """Take the value of a word, or None if the line does not have it."""
        return self._values.pop(letter, None)

    def need(self, letter: str, purpose: str) -> float:
        """Take the value of a word that must be present."""
        value = self.take(letter)
        if value is None:
            raise PostError(f"{purpose}: the word {letter} is missing")
        return value

    def finish(self) -> None:
        """Raise an error if any word was not used."""
        if self._values:
            words = " ".join(f"{letter}{value:g}" for letter, value in self._values.items())
            raise PostError(f"word {words}: not used by this block")


def pairs(text: str) -> Iterator[tuple[str, str]]:
    """Split a line without comments into letters and numbers.

    Raises
    ------
    PostError
        If part of the line is not a word of NC code.
    """
    at = 0
    end = len(text.rstrip())
    while at < end:
        found = WORD.match(text, at)
        if found is None:
            raise PostError(f"'{shown(text[at:end])}': not a word of NC code")
        yield found[1], found[2]
        at = found.end()


def number_of(word: str, text: str) -> float:
    """Value of a word of NC code.

    Raises
    ------
    PostError
        If the value is too large.
    """
    value = float(text)
    if not abs(value) <= LARGEST:
        raise PostError(f"word {word}{shown(text)}: value exceeds {LARGEST:g}")
    return value


def shown(text: str) -> str:
    """Beginning of a line, as shown in messages."""
    plain = " ".join(text.split())
    return plain if len(plain) <= LONGEST else f"{plain[:LONGEST]}…"


def whole(value: float, word: str) -> int:
    """Convert a value to a positive whole number, as needed for tools and turns."""
    if value != int(value) or value < 1.0:
        raise PostError(f"word {word}{value:g}: must be a whole number above 0")
    return int(value)


class GCodeAction(Enum):
    """Actions that G codes stand for."""

    NOTHING = auto()
    """No effect, because it is the assumed state: metric, absolute, no cutter compensation."""
    RAPID = auto()
    LINEAR = auto()
    CLOCKWISE = auto()
    COUNTERCLOCKWISE = auto()
    THREAD = auto()
    TAP = auto()
    LEFT_TAP = auto()
    TAP_OUT = auto()
    """Retract of a tap, where it is a separate block."""
    DWELL = auto()
    SURFACE_SPEED = auto()
    SPINDLE_SPEED = auto()
    SPEED_LIMIT = auto()
    LENGTH = auto()
    DIAMETER = auto()
    CANCEL = auto()
    TO_RETRACT = auto()
    TO_START = auto()
    PATH_MODE = auto()
    """Exact stops, or how far corners may be rounded; the path is the same."""


GCode = GCodeAction | ArcPlane | RateMode | CycleKind
"""Meaning of a G code: an action, a plane, a feed mode or a drilling cycle."""


COMMON: dict[str, GCode] = {
    "G0": GCodeAction.RAPID,
    "G1": GCodeAction.LINEAR,
    "G2": GCodeAction.CLOCKWISE,
    "G3": GCodeAction.COUNTERCLOCKWISE,
    "G4": GCodeAction.DWELL,
    "G17": ArcPlane.XY,
    "G18": ArcPlane.ZX,
    "G19": ArcPlane.YZ,
    "G40": GCodeAction.NOTHING,
    "G54": GCodeAction.NOTHING,
    "G96": GCodeAction.SURFACE_SPEED,
    "G97": GCodeAction.SPINDLE_SPEED,
}
EXACT_OR_CUTTING: dict[str, GCode] = {
    "G61": GCodeAction.PATH_MODE,
    "G64": GCodeAction.PATH_MODE,
}
PER_TIME: dict[str, GCode] = {
    "G94": RateMode.PER_MINUTE,
    "G95": RateMode.PER_REVOLUTION,
}
CANNED: dict[str, GCode] = {
    "G73": CycleKind.CHIP_BREAK,
    "G80": GCodeAction.CANCEL,
    "G81": CycleKind.DRILL,
    "G82": CycleKind.DWELL,
    "G83": CycleKind.PECK,
    "G85": CycleKind.BORE,
    "G86": CycleKind.BORE_STOP,
    "G98": GCodeAction.TO_START,
    "G99": GCodeAction.TO_RETRACT,
}
LENGTHS: dict[str, GCode] = {
    "G21": GCodeAction.NOTHING,
    "G43": GCodeAction.LENGTH,
    "G49": GCodeAction.NOTHING,
    "G90": GCodeAction.NOTHING,
}

MOTIONS = frozenset({
    GCodeAction.RAPID,
    GCodeAction.LINEAR,
    GCodeAction.CLOCKWISE,
    GCodeAction.COUNTERCLOCKWISE,
    GCodeAction.THREAD,
    GCodeAction.TAP,
    GCodeAction.LEFT_TAP,
    GCodeAction.TAP_OUT,
    *CycleKind,
})
TAPS = frozenset({GCodeAction.TAP, GCodeAction.LEFT_TAP, GCodeAction.TAP_OUT})
SENSES = {"M3": SpindleDirection.CLOCKWISE, "M4": SpindleDirection.COUNTERCLOCKWISE}
