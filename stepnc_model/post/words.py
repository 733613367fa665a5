"""Words of NC code: numbers, texts, modal words, and the G codes of ISO 6983.

A line of G-code consists of letters with numbers, each used once. The actions of G codes have
names here; codes that most dialects share are listed in tables.
"""

import unicodedata


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


LARGEST = 1e9
"""Greatest value accepted in a word of NC code."""

LONGEST = 60
"""Greatest number of characters of a line that a message shows."""


def shown(text: str) -> str:
    """Beginning of a line, as shown in messages."""
    plain = " ".join(text.split())
    return plain if len(plain) <= LONGEST else f"{plain[:LONGEST]}…"
