"""Instances of an AP238 file: attributes by name, and references backwards.

Simple and complex instances look alike here: an attribute is found by the entity that defines
it, in whichever part of the instance that entity stands.
"""

from array import array
from bisect import bisect_left
from collections.abc import Iterator
from functools import cache
from typing import TypeAlias

from stepnc_model.ap238.dictionary import attributes, is_a, own_attributes, subtypes
from stepnc_model.errors import Part21Error
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.record import Part
from stepnc_model.part21.values import Ref, Typed, Value

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
        """Whether an instance is of an entity or of a subtype."""
        if id not in self.file:
            return False
        keyword = self.file.keyword(id)
        if keyword:
            return is_a(keyword, name)
        return any(is_a(part, name) for part, _ in self._readable(id))

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
