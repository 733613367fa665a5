"""AP238 programs for tests, and the same programs in other words."""

import re
from functools import cache
from pathlib import Path
from random import Random

import pytest

from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.catalogue import class_of
from stepnc_model.entities.conversion import slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref, Value

PARTS = Path(__file__).parents[3] / "examples" / "parts"
SHARED = Path(__file__).parents[4] / "shared"
CORPUS = SHARED / "corpus" / "ap238"
TWIN = SHARED / "corpus" / "iso14649" / "EXAMPLE1_original.stp"
LONG_FORM = SHARED / "ap238" / "aim_long_e3.exp"

MILLING = "ap238_cc3_14649-11_example1"
TURNING = "ap238_cc3_14649-12_example1_turning"
TOOLPATHS = "ap238_cc1"
PUBLIC = (MILLING, TURNING, TOOLPATHS)

OWN = ("bracket", "paper000", "paper002", "paper003_case1", "paper003_pocket", "shaft")
"""Sample programs of the project, of ISO 14649."""


def read(data: bytes) -> Part21File:
    """Read the bytes of a file."""
    return Part21File.from_bytes(data, name="program.238")


@cache
def public(name: str) -> bytes:
    """Read a public AP238 file; skip where it is absent."""
    path = CORPUS / f"{name}.stpnc"
    if not path.is_file():
        pytest.skip(f"{path.name} is not here")
    return path.read_bytes()


@cache
def long_form() -> Path:
    """Path of the EXPRESS long form; skip where it is absent."""
    if not LONG_FORM.is_file():
        pytest.skip(f"{LONG_FORM.name} is not here")
    return LONG_FORM


@cache
def own(name: str) -> Part21File:
    """Sample program of ISO 14649."""
    return Part21File.from_bytes((PARTS / f"{name}.stpnc").read_bytes(), name=name)


@cache
def exported(name: str) -> bytes:
    """Sample program converted to AP238."""
    return to_ap238(own(name)).data


def reworded(data: bytes, seed: int) -> bytes:
    """The same instances without comments, with other numbers and in another order."""
    file, random = read(data), Random(seed)
    ids = list(file.ids())
    numbers = random.sample(range(1, 10 * len(ids)), len(ids))
    renamed = dict(zip(ids, numbers, strict=True))
    lines = [_renamed(data[slice(*file.span(id))], renamed) for id in ids]
    random.shuffle(lines)
    head = data[: data.index(b"DATA;")] + b"DATA;\n"
    return b"".join([head, *(line + b"\n" for line in lines), b"ENDSEC;\nEND-ISO-10303-21;\n"])


_PIECE = re.compile(rb"'[^']*'|#(\d+)|/\*.*?\*/", re.DOTALL)


def _renamed(text: bytes, numbers: dict[int, int]) -> bytes:
    """Instance with other numbers, without comments."""

    def piece(match: re.Match[bytes]) -> bytes:
        if match[1]:
            return b"#%d" % numbers[int(match[1])]
        return b"" if match[0].startswith(b"/*") else match[0]

    return _PIECE.sub(piece, text)


UNORDERED = {"its_features", "its_operations", "its_workpieces", "its_cutting_edge"}
"""Attributes whose order AP238 does not give."""


EMPTY: tuple[Value, ...] = (None, "", ())
"""Values that mean that nothing is given."""


class Comparison:
    """Differences between two programs of ISO 14649, found from their projects on."""

    def __init__(self, one: Part21File, other: Part21File) -> None:
        self._one, self._other = one, other
        self._seen: set[tuple[int, int]] = set()
        self.found: dict[str, tuple[object, object]] = {}
        """Values that differ, by entity and attribute."""

    def run(self) -> dict[str, tuple[object, object]]:
        """Compare the programs; return the differences."""
        self._instances(self._one.ids_of("PROJECT")[0], self._other.ids_of("PROJECT")[0])
        return self.found

    def between(self, one: int, other: int) -> dict[str, tuple[object, object]]:
        """Compare an instance with one of the other program; return all differences."""
        self._instances(one, other)
        return self.found

    def _instances(self, one: int, other: int) -> None:
        if (one, other) in self._seen:
            return
        self._seen.add((one, other))
        first, second = _attributes(self._one, one), _attributes(self._other, other)
        keyword = self._one.keyword(one)
        for name in first.keys() & second.keys():
            self._values(first[name], second[name], f"{keyword}.{name}")

    def _values(self, one: Value, other: Value, place: str) -> None:
        if isinstance(one, Ref) and isinstance(other, Ref):
            self._instances(int(one), int(other))
        elif isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
            if place.rpartition(".")[2] in UNORDERED:
                one = tuple(sorted(one, key=lambda ref: _name(self._one, ref)))
                other = tuple(sorted(other, key=lambda ref: _name(self._other, ref)))
            for first, second in zip(one, other, strict=True):
                self._values(first, second, place)
        elif not _is_same(one, other):
            self.found[place] = one, other


def _attributes(file: Part21File, id: int) -> dict[str, Value]:
    """Attributes of an instance by name."""
    values = file.parameters(id)
    cls: type[Entity] | None = class_of(file.keyword(id), len(values))
    return {} if cls is None else dict(zip(slots_of(cls), values, strict=False))


def _name(file: Part21File, ref: Value) -> str:
    """Id of an instance, to bring instances into an order."""
    return str(_attributes(file, int(ref)).get("its_id", "")) if isinstance(ref, Ref) else ""


def _is_same(one: Value, other: Value) -> bool:
    """Whether two values are the same: numbers to 1e-9, texts but for blanks and case."""
    if isinstance(one, int | float) and isinstance(other, int | float):
        return abs(one - other) <= 1e-9 * max(1.0, abs(one))
    if isinstance(one, str) and isinstance(other, str):
        return one.casefold().split() == other.casefold().split()
    return (one in EMPTY and other in EMPTY) or one == other


def differences(one: bytes, other: bytes) -> dict[str, tuple[object, object]]:
    """Differences between two AP238 files, seen as programs of ISO 14649."""
    return Comparison(AimView.of(read(one)), AimView.of(read(other))).run()
