"""Machines, work materials and tool grades by name or from the user's own files.

The files are in ``simulator/data``, one per machine, material and kind of tool, with the unit
in each key and a source in each table. A value that is missing, misspelt or out of range raises
a :class:`simulator.errors.LibraryError` that names file, key, value and bound.

Match of the material of a STEP-NC program with the library.

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
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Annotated

from simulator.errors import LibraryError, UnknownMachine, UnknownMaterial
from simulator.files.grade_file import ANY_GROUP, read_allowances, read_grades, read_tools
from simulator.files.machine_file import read_machine
from simulator.files.machine_xml import read_machine_xml
from simulator.files.material_file import MaterialHead, read_material
from simulator.files.toml_file import FileTable, quantity, read_toml, read_toml_head
from simulator.spec import (
    Certainty,
    CuttingMaterial,
    CuttingWindow,
    Machine,
    MaterialMatch,
    ToolConstruction,
    ToolGrade,
    ToolKind,
    WorkMaterial,
)
from simulator.tool_windows import ReamingAllowance

DATA = Path(__file__).with_name("data")
"""Folder with the files of the library."""

SOLID_TOOLS = frozenset({
    ToolKind.ENDMILL,
    ToolKind.DRILL,
    ToolKind.CENTER_DRILL,
    ToolKind.COUNTERSINK,
    ToolKind.REAMER,
    ToolKind.TAP,
})
"""Kinds of tools whose edges are part of a solid body; all others hold inserts."""


def machine_names() -> tuple[str, ...]:
    """Names of the machines in the library."""
    return _names("machines")


def material_names() -> tuple[str, ...]:
    """Names of the work materials in the library."""
    return _names("materials")


def material_path(name: str) -> Path:
    """Path of the file of a material in the library."""
    return DATA / "materials" / f"{name}.toml"


def load_machine(name_or_path: str) -> Machine:
    """Load a machine from the library or from the user's own file.

    Parameters
    ----------
    name_or_path : str
        ``vmc15``, or a file ``my.toml``, or a file ``my.xml`` in the format of
        :mod:`simulator.files.machine_xml`.

    Raises
    ------
    UnknownMachine
        If the library has no machine of that name.
    LibraryError
        If the file cannot be read or a value in it is invalid.

    Examples
    --------
    >>> load_machine("paper002").spindle.efficiency
    0.9
    """
    path = Path(name_or_path)
    if path.suffix.lower() == ".xml":
        return read_machine_xml(path)
    if _is_path(name_or_path):
        return read_machine(path)
    name = name_or_path.strip().lower()
    if name not in machine_names():
        raise UnknownMachine(name_or_path, _nearest_first(name, machine_names()))
    return read_machine(DATA / "machines" / f"{name}.toml")


def load_material(name_or_path: str) -> WorkMaterial:
    """Load a work material from the library or from the user's own file.

    Parameters
    ----------
    name_or_path : str
        ``c45``, or a file ``my.toml``. For catalogue names, standard numbers and texts of
        STEP-NC programs use :func:`simulator.library.match_material`.

    Raises
    ------
    UnknownMaterial
        If the library has no material of that name.
    LibraryError
        If the file cannot be read or a value in it is invalid.

    Examples
    --------
    >>> load_material("paper002").kienzle
    Kienzle(k_c11=1000.0, m_c=0.0, rake_angle=None)
    """
    if _is_path(name_or_path):
        return read_material(Path(name_or_path))
    name = name_or_path.strip().lower()
    if name not in material_names():
        raise UnknownMaterial(name_or_path, _nearest_first(name, material_names()))
    return read_material(material_path(name))


def find_window(
    material: WorkMaterial, tool_kind: ToolKind, cutting_material: CuttingMaterial
) -> CuttingWindow | None:
    """Cutting-speed window of a tool in a material; ``None`` if the source gives none.

    Carbide has two windows in most materials, for solid tools and for inserts. If the source
    gives only one of them, it is used for both.
    """
    body = ToolConstruction.SOLID if tool_kind in SOLID_TOOLS else ToolConstruction.INDEXABLE
    windows = [
        window for window in material.windows if window.cutting_material is cutting_material
    ]
    fitting = [window for window in windows if window.tool_body in {body, None}]
    return next(iter(fitting or windows), None)


def find_grade(
    tool_kind: ToolKind, cutting_material: CuttingMaterial, iso_group: str
) -> ToolGrade:
    """Grade of a kind of tool for an ISO group, or else the grade for all groups.

    Parameters
    ----------
    iso_group : str
        P, M, K, N, S or H.

    Raises
    ------
    LibraryError
        If the library has no such grade, for example HSS in hardened steel.
    """
    grades = [
        grade for grade in _grades(tool_kind) if grade.cutting_material is cutting_material
    ]
    for group in (iso_group, ANY_GROUP):
        for grade in grades:
            if grade.iso_group == group:
                return grade
    raise LibraryError(
        f"no {cutting_material} grade for ISO group '{iso_group}'",
        path=str(_grade_path(tool_kind)),
    )


def bare_tool(tool_kind: ToolKind, cutting_material: CuttingMaterial) -> ToolGrade | None:
    """Stiffness, strength and geometry of a kind of tool, without windows; None if unknown."""
    tools = _tools(tool_kind)
    return next((each for each in tools if each.cutting_material is cutting_material), None)


@cache
def reaming_allowances() -> tuple[ReamingAllowance, ...]:
    """Allowances of reamers by diameter, the smallest first."""
    return read_allowances(_grade_path(ToolKind.REAMER))


@cache
def _tools(kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Tools of one kind without windows, one of each cutting material."""
    return read_tools(_grade_path(kind), kind)


@cache
def _grades(kind: ToolKind) -> tuple[ToolGrade, ...]:
    """Grades of one kind of tool; cached, because they are needed for every workingstep."""
    return read_grades(_grade_path(kind), kind)


def _grade_path(kind: ToolKind) -> Path:
    """Path of the file with the grades of one kind of tool."""
    return DATA / "tools" / f"{kind}.toml"


def _names(folder: str) -> tuple[str, ...]:
    """Names of the TOML files, without suffix, in a folder of the library."""
    return tuple(sorted(path.stem for path in (DATA / folder).glob("*.toml")))


def _is_path(name_or_path: str) -> bool:
    """True if the user gave a path rather than a name."""
    return name_or_path.lower().endswith(".toml") or "/" in name_or_path or "\\" in name_or_path


def _nearest_first(name: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Known names, with those similar to ``name`` first."""
    near = get_close_matches(name, known, n=5, cutoff=0.4)
    return (*near, *(other for other in known if other not in near))


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


@cache
def _known_names() -> Mapping[str, str]:
    """File of every material by each of its normalised names; the library stays as it is."""
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
    """True if a word is nearly one of a kind of metal, but none, nor its plural."""
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
