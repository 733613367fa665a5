"""Check of AP238 files against the EXPRESS long form, apart from the code that writes them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Derived, Enumeration, Ref, Typed, Value

_ENTITY = re.compile(r"\bENTITY (\w+)\b(.*?)END_ENTITY;", re.DOTALL)
_TYPE = re.compile(r"\bTYPE (\w+) = (.*?)END_TYPE;", re.DOTALL)
_PARTS = re.compile(r"\b(?:DERIVE|WHERE|INVERSE)\b|\bUNIQUE\b(?=\s*\w+\s*:)")
_ATTRIBUTE = re.compile(r"\s*(\w+(?:\s*,\s*\w+)*)\s*:\s*(.*)", re.DOTALL)
_AGGREGATE = re.compile(r"(?:SET|LIST|BAG|ARRAY)\b(?:\s*\[[^\]]*\])?\s*OF\s*(?:UNIQUE\s*)?")


@dataclass(slots=True)
class Schema:
    """Entities and types of an EXPRESS schema, as far as the check needs them."""

    supertypes: dict[str, list[str]] = field(default_factory=dict)
    attributes: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)

    def lineage(self, name: str) -> list[str]:
        """Supertypes of an entity, then itself, each once."""
        above = [each for parent in self.supertypes[name] for each in self.lineage(parent)]
        return list(dict.fromkeys([*above, name]))

    def slots(self, name: str) -> list[tuple[str, str]]:
        """All attributes of an entity with their types, in the order of the parameters."""
        return [slot for each in self.lineage(name) for slot in self.attributes[each]]

    def members(self, name: str) -> set[str]:
        """Entities and simple types that a named type stands for."""
        if name in self.supertypes:
            return {name}
        body = self.types.get(name, "")
        select = re.search(r"SELECT\s*(?:BASED_ON \w+ WITH)?\s*\((.*?)\)", body, re.DOTALL)
        if select is None:
            return {name}
        inner = (each.strip() for each in select[1].split(","))
        return {member for each in inner for member in self.members(each)}


@cache
def schema(path: Path) -> Schema:
    """Read the entities and types of a long form."""
    text = re.sub(r"\(\*.*?\*\)|--[^\n]*", "", path.read_text("latin-1"), flags=re.DOTALL)
    found = Schema()
    for match in _TYPE.finditer(text):
        found.types[match[1].lower()] = match[2]
    for match in _ENTITY.finditer(text):
        head, _, body = match[2].partition(";")
        supers = re.search(r"SUBTYPE OF \((.*?)\)\s*$", head.strip(), re.DOTALL)
        name = match[1].lower()
        found.supertypes[name] = (
            [each.strip() for each in supers[1].split(",")] if supers else []
        )
        found.attributes[name] = [
            (attribute.strip(), " ".join(attributes[2].split()))
            for part in _PARTS.split(body)[0].split(";")
            if (attributes := _ATTRIBUTE.fullmatch(part)) is not None
            for attribute in attributes[1].split(",")
        ]
    return found


def deviations(file: Part21File, long_form: Schema) -> Iterator[str]:
    """Deviations of all instances of a file from the long form."""
    for id in file.ids():
        parts = file.parts(id)
        names = [keyword.lower() for keyword, _ in parts]
        unknown = [name for name in names if name not in long_form.supertypes]
        if unknown:
            yield f"#{id}: {unknown[0]} is not in the schema"
            continue
        if len(parts) > 1:
            expected = {each for name in names for each in long_form.lineage(name)}
            if expected != set(names) or names != sorted(names):
                yield f"#{id}: parts {names} instead of {sorted(expected)}"
        for name, (_, values) in zip(names, parts, strict=True):
            slots = long_form.slots(name) if len(parts) == 1 else long_form.attributes[name]
            if len(values) != len(slots):
                yield f"#{id} {name}: {len(values)} parameters instead of {len(slots)}"
            for (attribute, kind), value in zip(slots, values, strict=False):
                for text in _faults(file, long_form, kind, value):
                    yield f"#{id} {name}.{attribute}: {text}"


def _faults(file: Part21File, long_form: Schema, kind: str, value: Value) -> Iterator[str]:
    """Faults of one value."""
    needed = kind.removeprefix("OPTIONAL ").strip()
    aggregate = _AGGREGATE.match(needed)
    if value is None:
        if needed == kind:
            yield "$ where a value is required"
    elif isinstance(value, Derived):
        return
    elif aggregate is not None:
        if not isinstance(value, tuple):
            yield "no list"
            return
        for item in value:
            yield from _faults(file, long_form, needed[aggregate.end() :], item)
    elif isinstance(value, Typed):
        inner = value.value if isinstance(value.value, tuple) else ()
        yield from (
            f"{item} does not exist"
            for item in inner
            if isinstance(item, Ref) and int(item) not in file
        )
    elif isinstance(value, Ref):
        yield from _reference_faults(file, long_form, needed, value)
    else:
        yield from _plain_faults(long_form, needed, value)


def _plain_faults(long_form: Schema, kind: str, value: Value) -> Iterator[str]:
    """Faults of a text or a number."""
    is_text = isinstance(value, str) and not isinstance(value, Enumeration)
    if kind in ("label", "text", "identifier") and not is_text:
        yield f"{value!r} where a text is required"
    elif kind in long_form.supertypes:
        yield f"{value!r} where a reference to {kind} is required"


def _reference_faults(
    file: Part21File, long_form: Schema, kind: str, ref: Ref[object]
) -> Iterator[str]:
    """Faults of a reference."""
    if int(ref) not in file:
        yield f"{ref} does not exist"
        return
    names = [keyword.lower() for keyword, _ in file.parts(int(ref))]
    known = {
        each
        for name in names
        if name in long_form.supertypes
        for each in long_form.lineage(name)
    }
    if not known & long_form.members(kind):
        yield f"{ref} is {' and '.join(names)} where {kind} is required"
