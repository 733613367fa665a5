"""Words of NC code: numbers, texts, and the memory of what is in force."""

import unicodedata


class Modal:
    """What is in force: a word is written when it says something new. Running state."""

    def __init__(self) -> None:
        self._words: dict[str, str] = {}

    def word(self, group: str, text: str) -> str:
        """The text when it is new in its group, else nothing."""
        if self._words.get(group) == text:
            return ""
        self._words[group] = text
        return text

    def set(self, group: str, text: str) -> None:
        """Know what is in force without writing it."""
        self._words[group] = text

    def forget(self, *groups: str) -> None:
        """Know nothing more of some groups."""
        for group in groups:
            self._words.pop(group, None)


def decimal(value: float, places: int) -> str:
    """A number in its shortest form: ``10``, ``-0.5``."""
    text = f"{value:.{places}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def pointed(value: float, places: int) -> str:
    """A number that always has its point, as old controls need it: ``10.``, ``-0.5``."""
    text = decimal(value, places)
    return text if "." in text else text + "."


def ascii_text(text: str) -> str:
    """A text in printable ASCII: accents fall, what is left unknown becomes ``?``."""
    plain = unicodedata.normalize("NFKD", text.replace("ß", "ss").replace("Ø", "D"))
    kept = (c for c in plain if not unicodedata.combining(c))
    return "".join(c if " " <= c <= "~" else "?" for c in kept)


def bracketed(text: str, longest: int) -> str:
    """A comment in round brackets, which it must not hold itself."""
    inner = ascii_text(text).replace("(", "[").replace(")", "]")
    return f"({inner[:longest]})"
