"""Instances of an AP238 file: attributes by name, and references backwards.

Simple and complex instances look alike here: an attribute is found by the entity that defines
it, in whichever part of the instance that entity stands.

Attributes and supertypes of AIM entities, as far as the reference paths meet them.

References
----------
.. [1] ISO 10303-238, annex A (AIM EXPRESS expanded listing).
"""

from array import array
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TypeAlias

from stepnc_model.errors import Part21Error
from stepnc_model.part21.index import Part
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref, Typed, Value


@dataclass(frozen=True, slots=True, kw_only=True)
class AimEntity:
    """Entity of the AIM with its supertypes and its own attributes."""

    name: str
    supertypes: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


@cache
def dictionary() -> dict[str, AimEntity]:
    """Entities by name, as ``dictionary.txt`` lists them."""
    text = files("stepnc_model.ap238").joinpath("dictionary.txt").read_text("ascii")
    lines = (line for line in text.splitlines() if line and not line.startswith("#"))
    return {entity.name: entity for entity in map(_entity, lines)}


def _entity(line: str) -> AimEntity:
    """Entity of one line, ``NAME < supertypes : attributes``."""
    head, _, attributes = line.partition(":")
    name, _, supertypes = head.partition("<")
    return AimEntity(
        name=name.strip(),
        supertypes=tuple(supertypes.split()),
        attributes=tuple(attributes.split()),
    )


@cache
def lineage(name: str) -> tuple[str, ...]:
    """Supertypes of an entity before itself, each once, in the order of the attributes."""
    entity = dictionary().get(name)
    if entity is None:
        return (name,)
    above = (each for parent in entity.supertypes for each in lineage(parent))
    return (*dict.fromkeys(above), name)


@cache
def is_a(name: str, ancestor: str) -> bool:
    """True if an entity is another one or a subtype of it."""
    return ancestor in lineage(name)


@cache
def own_attributes(name: str) -> tuple[str, ...]:
    """Attributes that an entity adds to those of its supertypes."""
    entity = dictionary().get(name)
    return () if entity is None else entity.attributes


@cache
def attributes(name: str) -> tuple[str, ...]:
    """All attributes of an entity, in the order of the parameters of a simple instance."""
    return tuple(each for part in lineage(name) for each in own_attributes(part))


@cache
def subtypes(name: str) -> frozenset[str]:
    """Names of an entity and of all its subtypes."""
    return frozenset({name, *(each for each in dictionary() if is_a(each, name))})


Slot: TypeAlias = tuple[int, int]
"""Position of an attribute: number of the part, and place among its parameters."""


def references(value: Value) -> Iterator[Ref[object]]:
    """All references in a value, also in lists and typed values."""
    if isinstance(value, Ref):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from references(item)
    elif isinstance(value, Typed):
        yield from references(value.value)


def _items(value: Value) -> tuple[Value, ...]:
    """Items of a list; another value is the only one."""
    return value if isinstance(value, tuple) else (value,)


MOST_KEPT = 20_000
"""Greatest number of instances whose parameters are kept; large files would fill the memory."""


class Instances:
    """Instances of one file, by the names of entities and attributes.

    The object has state: parts and backward references are cached once read.

    Parameters
    ----------
    file : Part21File
    """

    def __init__(self, file: Part21File) -> None:
        self.file = file
        self._parts: dict[int, tuple[Part, ...]] = {}
        self._referrers: dict[tuple[str, str], tuple[array[int], array[int]]] = {}
        self._complex: dict[str, list[int]] | None = None

    def __contains__(self, id: int) -> bool:
        return id in self.file

    def parts(self, id: int) -> tuple[Part, ...]:
        """Entities of an instance with their parameters.

        Raises
        ------
        Part21Error, SchemaError
            If the instance is malformed or does not exist: the program would silently lack it.
        """
        if id not in self._parts:
            if len(self._parts) >= MOST_KEPT:
                self._parts.clear()
            self._parts[id] = self.file.parts(id)
        return self._parts[id]

    def _readable(self, id: int) -> tuple[Part, ...]:
        """Entities of an instance that may have nothing to do with the program."""
        try:
            return self.parts(id)
        except Part21Error:  # a finding of the file
            return ()

    def is_a(self, id: int, name: str) -> bool:
        """True if an instance is of an entity or of a subtype."""
        if id not in self.file:
            return False
        keyword = self.file.keyword(id)
        if keyword:
            return is_a(keyword, name)
        return any(is_a(part, name) for part, _ in self._readable(id))

    def weights(self, id: int) -> tuple[Value, ...]:
        """Weights of a rational curve; empty where they are all the same."""
        if id not in self.file or "B_SPLINE_CURVE" not in self._complex_names(id):
            return ()
        weights = [w for each in self.values(id, "weights_data") for w in _items(each)]
        return tuple(weights) if len(set(weights)) > 1 else ()

    def _complex_names(self, id: int) -> tuple[str, ...]:
        """Entities of a complex instance; none of a simple one."""
        if self.file.keyword(id):
            return ()
        return tuple(name for name, _ in self._readable(id))

    def slots(self, id: int, attribute: str) -> tuple[Slot, ...]:
        """Positions of an attribute; several where supertypes share a name."""
        parts = self.parts(id)
        known = _places if len(parts) == 1 else _own_places
        return tuple(
            (number, place)
            for number, (keyword, values) in enumerate(parts)
            for place in known(keyword, attribute)
            if place < len(values)
        )

    def values(self, id: int, attribute: str) -> tuple[Value, ...]:
        """Values of an attribute; several where supertypes share its name."""
        keyword = self.file.keyword(id)
        if keyword and not _places(keyword, attribute):
            # Most instances are asked for attributes that they do not have: nothing is parsed.
            return ()
        parts = self.parts(id)
        if len(parts) == 1:
            keyword, values = parts[0]
            places = _places(keyword, attribute)
            if len(places) == 1:
                return values[places[0] : places[0] + 1]
            return tuple([values[place] for place in places if place < len(values)])
        return tuple(parts[part][1][place] for part, place in self.slots(id, attribute))

    def value(self, id: int, attribute: str) -> Value:
        """Value of an attribute: the last that is neither ``$`` nor empty, else None."""
        for value in reversed(self.values(id, attribute)):
            if value is not None and value != "":
                return value
        return None

    def of_entity(self, name: str) -> Iterator[int]:
        """Instances of an entity and its subtypes, in file order."""
        parts = [ids for keyword in subtypes(name) if len(ids := self.file.ids_of(keyword))]
        complexes = self._complexes()
        others = {id for keyword in subtypes(name) for id in complexes.get(keyword, ())}
        if len(parts) == 1 and not others:
            return iter(parts[0])
        found = [id for ids in parts for id in ids]
        return iter(sorted((*found, *others), key=self.file.span))

    def referrers(self, id: int, name: str, attribute: str) -> list[int]:
        """Instances of an entity whose attribute refers to an instance, in file order."""
        key = name, attribute
        if key not in self._referrers:
            self._referrers[key] = self._backwards(name, attribute)
        targets, others = self._referrers[key]
        first = bisect_left(targets, id)
        last = first
        while last < len(targets) and targets[last] == id:
            last += 1
        return others[first:last].tolist()

    def _backwards(self, name: str, attribute: str) -> "tuple[array[int], array[int]]":
        """Targets of an attribute in ascending order, and the instances that refer to them."""
        targets, others = array("q"), array("q")
        for other in self.of_entity(name):
            for target in self._targets(other, attribute):
                targets.append(target)
                others.append(other)
        order = sorted(range(len(targets)), key=targets.__getitem__)
        return (
            array("q", map(targets.__getitem__, order)),
            array("q", map(others.__getitem__, order)),
        )

    def _targets(self, id: int, attribute: str) -> Iterator[int]:
        """Instances that an attribute refers to, each once."""
        refs = (ref for value in self.values(id, attribute) for ref in references(value))
        return iter(dict.fromkeys(int(ref) for ref in refs))

    def _complexes(self) -> dict[str, list[int]]:
        """Complex instances by the entities of their parts."""
        if self._complex is None:
            found: dict[str, list[int]] = {}
            for id in self.file.ids_of(""):
                for keyword, _ in self._readable(id):
                    found.setdefault(keyword, []).append(id)
            self._complex = found
        return self._complex


@cache
def _places(keyword: str, attribute: str) -> tuple[int, ...]:
    """Places of an attribute among the parameters of a simple instance."""
    return tuple(i for i, name in enumerate(attributes(keyword)) if name == attribute)


@cache
def _own_places(keyword: str, attribute: str) -> tuple[int, ...]:
    """Places of an attribute among the parameters of one part of a complex instance."""
    return tuple(i for i, name in enumerate(own_attributes(keyword)) if name == attribute)
