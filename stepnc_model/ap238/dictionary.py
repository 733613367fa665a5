"""Attributes and supertypes of AIM entities, as far as the reference paths meet them.

References
----------
.. [1] ISO 10303-238, annex A (AIM EXPRESS expanded listing).
"""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files


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
    """Whether an entity is another one or a subtype of it."""
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
