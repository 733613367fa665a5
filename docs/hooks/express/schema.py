"""An EXPRESS schema as values: types, entities and the rules kept as text.

EXPRESS ignores case: all names here are lower case, but for the simple types (``REAL``).

References
----------
.. [1] ISO 10303-11:2004, clauses 8 (data types) and 9 (declarations).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from stepnc_model.errors import SchemaError

SIMPLE_TYPES = frozenset({
    "BINARY",
    "BOOLEAN",
    "INTEGER",
    "LOGICAL",
    "NUMBER",
    "REAL",
    "STRING",
    "GENERIC_ENTITY",
})


class AggregateKind(StrEnum):
    """Kind of aggregate."""

    ARRAY = "ARRAY"
    BAG = "BAG"
    LIST = "LIST"
    SET = "SET"


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedType:
    """A simple type, a defined type or an entity."""

    name: str
    width: str = ""
    """of a string or binary, ``(20) FIXED``"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AggregateType:
    """``LIST [2:?] OF UNIQUE length_measure``; a bound not given is ``0`` or ``?``."""

    kind: AggregateKind
    element: "NamedType | AggregateType"
    lower: str = "0"
    upper: str = "?"
    is_unique: bool = False
    is_optional: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class EnumerationType:
    """``ENUMERATION OF (cw, ccw)``."""

    items: tuple[str, ...]
    based_on: str = ""
    is_extensible: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectType:
    """``SELECT (toolpath_speed, positive_ratio_measure, speed_name)``."""

    items: tuple[str, ...]
    based_on: str = ""
    is_extensible: bool = False


AttributeType: TypeAlias = NamedType | AggregateType
Underlying: TypeAlias = NamedType | AggregateType | EnumerationType | SelectType


@dataclass(frozen=True, slots=True, kw_only=True)
class Attribute:
    """One explicit attribute of an entity."""

    name: str
    type: AttributeType
    is_optional: bool
    line: int
    redeclares: str = ""
    """supertype whose attribute is narrowed: it has no parameter of its own"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Clause:
    """One line of a DERIVE, INVERSE, UNIQUE or WHERE part; its meaning is not evaluated."""

    label: str
    """name of the attribute or rule, or empty"""
    text: str
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class EntityDefinition:
    """``ENTITY … END_ENTITY``."""

    name: str
    is_abstract: bool
    subtypes: str
    """supertype constraint as it stands, ``(ONEOF (a, b))``, or empty"""
    supertypes: tuple[str, ...]
    attributes: tuple[Attribute, ...]
    derived: tuple[Clause, ...]
    inverse: tuple[Clause, ...]
    unique: tuple[Clause, ...]
    where: tuple[Clause, ...]
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeDefinition:
    """``TYPE … END_TYPE``."""

    name: str
    underlying: Underlying
    where: tuple[Clause, ...]
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Interface:
    """``REFERENCE FROM`` or ``USE FROM`` another schema."""

    keyword: str
    schema: str
    names: Mapping[str, str]
    """name there by name here; empty for the whole schema"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Declaration:
    """A constant part, function, procedure, rule or subtype constraint, kept as text."""

    keyword: str
    name: str
    text: str
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Schema:
    """``SCHEMA … END_SCHEMA``."""

    name: str
    interfaces: tuple[Interface, ...]
    types: Mapping[str, TypeDefinition]
    entities: Mapping[str, EntityDefinition]
    declarations: tuple[Declaration, ...]


def attributes_in_order(schema: Schema, entity: str) -> tuple[Attribute, ...]:
    """Explicit attributes of an entity in the order of its Part 21 parameters.

    Those of the supertypes come first, each supertype once, in the order of the SUBTYPE OF
    list (ISO 10303-21, 12.2.5.2).

    Raises
    ------
    SchemaError
        If the entity or a supertype is not of this schema, or is its own supertype.
    """
    ordered: list[Attribute] = []
    done: set[str] = set()
    above: set[str] = set()
    stack = [(entity, False)]
    while stack:
        name, is_left = stack.pop()
        if name in done:
            continue
        definition = schema.entities.get(name)
        if definition is None:
            raise SchemaError(f"no entity {name!r} in {schema.name}", entity=entity)
        if is_left:
            done.add(name)
            ordered.extend(each for each in definition.attributes if not each.redeclares)
            continue
        if name in above:
            raise SchemaError("is its own supertype", entity=name, line=definition.line)
        above.add(name)
        stack.append((name, True))
        stack.extend((supertype, False) for supertype in reversed(definition.supertypes))
    return tuple(ordered)
