"""Match of the material of a STEP-NC program with the library.

Programs name their material freely: a standard number, a grade of another country, a brand, or
just "steel". Names are compared without blanks, hyphens, dots, accents and case. An exact name
in any text takes precedence over every guess. A guess is reported as such, with its reason; if
no guess is possible, an error lists similar names.

The rules for guesses are in ``simulator/data/material_guesses.toml``.
"""

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import pairwise
from typing import Annotated

from simulator.errors import UnknownMaterial
from simulator.library import DATA, load_material, material_names, material_path
from simulator.material_file import MaterialHead
from simulator.spec import Certainty, MaterialMatch
from simulator.toml_file import FileTable, quantity, read_toml, read_toml_head

STANDARD_PREFIX = re.compile(r"(?:aisi|sae|ansi|din|jis|astm|uns|wnr|wnum|en)(?=.*\d)")
"""Names of standards that precede a material name and say nothing about the metal."""

SEPARATORS = re.compile(r"[\s,;:/()\[\]_]+")
"""Separators between the words of a text."""

GradeNumber = Annotated[float, quantity(1, 9_999)]
"""Range of the numbers by which families of materials are ordered."""

NEAR_NAMES = 5
"""Number of names listed if a material is unknown."""

SLIP = 0.85
"""Similarity above which a word that is no word of a kind is a misspelt one."""

LONGEST_NAME = 40
"""Number of characters of a text that are compared when searching similar names."""


class FamilyMember(FileTable, frozen=True, kw_only=True):
    """Material of a family, by its number."""

    number: GradeNumber
    material: str


class MaterialFamily(FileTable, frozen=True, kw_only=True):
    """One ``[[family]]`` row: names with a number that a pattern finds."""

    pattern: str
    meaning: str
    members: tuple[FamilyMember, ...]


class MetalKind(FileTable, frozen=True, kw_only=True):
    """One ``[[kind]]`` row: words for a kind of metal, and the material that stands for it."""

    equals: tuple[str, ...] = ()
    contains: tuple[str, ...] = ()
    meaning: str
    material: str


class GuessFile(FileTable, frozen=True, kw_only=True):
    """Guesses that names of materials allow."""

    spelt: tuple[str, ...] = ()
    family: tuple[MaterialFamily, ...]
    kind: tuple[MetalKind, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialGuess:
    """Guess of the material that a name may mean, with its reason."""

    material: str
    reason: str


def match_material(texts: Sequence[str]) -> MaterialMatch:
    """Find the material that a program's texts name.

    Parameters
    ----------
    texts : sequence of str
        What the program says about its material, the most specific first: standard
        identifier, material identifier, property names. Blank texts are ignored.

    Raises
    ------
    UnknownMaterial
        If not even a guess is possible from the texts.

    Examples
    --------
    >>> match = match_material(["ST-50", "STEEL"])
    >>> match.material.name, match.certainty.value
    ('st50', 'exact')
    """
    said = tuple(text.strip() for text in texts if text.strip())
    names = _known_names()
    for candidate in _candidates(said):
        if (name := _exact(candidate, names)) is not None:
            return _match(name, Certainty.EXACT, reason=f"'{candidate}' is one of its names")
    if said:
        guesses = read_toml(DATA / "material_guesses.toml", GuessFile)
        guess = _by_family(said, guesses) or _by_kind(said, guesses)
        if guess is not None:
            return _match(guess.material, Certainty.GUESS, reason=guess.reason)
    raise UnknownMaterial(" / ".join(said), _near(said, names))


def normalised(text: str) -> str:
    """Letters and digits of a text, without accents and in lower case."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    return "".join(character for character in plain if character.isalnum())


def _match(name: str, certainty: Certainty, *, reason: str) -> MaterialMatch:
    """Match with the material of a name, and a sentence for the user."""
    material = load_material(name)
    verb = "is read as" if certainty is Certainty.EXACT else "is guessed to be"
    return MaterialMatch(
        material=material,
        certainty=certainty,
        reason=f"the material {verb} {material.title}: {reason}",
    )


def _known_names() -> dict[str, str]:
    """File of every material by each of its normalised names."""
    names: dict[str, str] = {}
    for file in material_names():
        head = read_toml_head(material_path(file), MaterialHead)
        for text in (file, head.title, *head.title.split(" / "), *head.equivalents):
            names.setdefault(normalised(text), file)
            names.setdefault(_without_standard(text), file)
    return names


def _exact(text: str, names: Mapping[str, str]) -> str | None:
    """File of the material with exactly this name; None if there is none."""
    return names.get(normalised(text)) or names.get(_without_standard(text))


def _without_standard(text: str) -> str:
    """Normalised name without a preceding name of a standard."""
    return STANDARD_PREFIX.sub("", normalised(text), count=1)


def _candidates(texts: tuple[str, ...]) -> Iterator[str]:
    """Parts of the texts that may be names, the longest first."""
    yield from texts
    for first, second in pairwise(texts):
        yield f"{first} {second}"
    for text in texts:
        words = [word for word in SEPARATORS.split(text) if word]
        yield from words
        for first, second in pairwise(words):
            yield f"{first} {second}"


def _by_family(texts: tuple[str, ...], guesses: GuessFile) -> MaterialGuess | None:
    """Guess by family: its material with the nearest number; None if no family matches."""
    for candidate in _candidates(texts):
        for family in guesses.family:
            found = re.fullmatch(family.pattern, normalised(candidate))
            if found is not None:
                return _nearest(candidate, family, number=int(found[1]))
    return None


def _nearest(candidate: str, family: MaterialFamily, *, number: int) -> MaterialGuess:
    """Guess the material of a family whose number is nearest."""
    nearest = min(family.members, key=lambda row: abs(row.number - number))
    return MaterialGuess(
        material=nearest.material,
        reason=f"'{candidate}' is not in the library; the nearest of the family "
        f"{family.meaning} is used",
    )


def _by_kind(texts: tuple[str, ...], guesses: GuessFile) -> MaterialGuess | None:
    """The material that stands for a kind of metal which the texts name, if spelt rightly."""
    for text in texts:
        whole = normalised(text)
        words = {normalised(word) for word in SEPARATORS.split(text)}
        if any(_is_misspelt(word, guesses.spelt) for word in words):
            continue
        for kind in guesses.kind:
            if words.intersection(kind.equals) or any(part in whole for part in kind.contains):
                return MaterialGuess(
                    material=kind.material,
                    reason=f"'{text}' says no more than {kind.meaning}, for which this "
                    "one stands",
                )
    return None


def _is_misspelt(word: str, spelt: Sequence[str]) -> bool:
    """Whether a word is nearly one of a kind of metal, but none, nor its plural."""
    start = word[:LONGEST_NAME]
    if start in spelt or start.removesuffix("s") in spelt:
        return False
    return bool(get_close_matches(start, spelt, n=1, cutoff=SLIP))


def _near(texts: tuple[str, ...], names: Mapping[str, str]) -> tuple[str, ...]:
    """Files of the materials with the most similar names; all if there are no texts."""
    near: dict[str, None] = {}
    for text in texts:
        start = normalised(text)[:LONGEST_NAME]
        for name in get_close_matches(start, names, n=NEAR_NAMES, cutoff=0.0):
            near[names[name]] = None
    return tuple(near)[:NEAR_NAMES] or material_names()
