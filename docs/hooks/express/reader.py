"""Read EXPRESS text (ISO 10303-11) into schemas.

Declarations are read, expressions are not: DERIVE, INVERSE, UNIQUE and WHERE lines keep their
text, and so do functions, rules and constants as a whole. Time is linear in the text, and
nesting costs no stack.
"""

from collections.abc import Container

from docs.hooks.express.cursor import Cursor
from docs.hooks.express.datatypes import attribute_type, underlying_type
from docs.hooks.express.lexer import TokenKind, tokens
from docs.hooks.express.schema import (
    Attribute,
    Clause,
    Declaration,
    EntityDefinition,
    Interface,
    Schema,
    TypeDefinition,
)
from stepnc_model.errors import SchemaError

_TEXT_BLOCKS = frozenset({"CONSTANT", "FUNCTION", "PROCEDURE", "RULE", "SUBTYPE_CONSTRAINT"})
_PARTS = ("DERIVE", "INVERSE", "UNIQUE", "WHERE")


def read_schemas(text: str) -> tuple[Schema, ...]:
    """All schemas of an EXPRESS text, in order.

    Raises
    ------
    SchemaError
        With the line, if the text is no EXPRESS.
    """
    cursor = Cursor(tokens(text))
    schemas: list[Schema] = []
    while cursor.next.kind is not TokenKind.END:
        schemas.append(_schema(cursor))
    if not schemas:
        raise SchemaError("no SCHEMA in the text")
    return tuple(schemas)


def _schema(cursor: Cursor) -> Schema:
    """SCHEMA … END_SCHEMA."""
    cursor.expect("SCHEMA")
    name = cursor.name("name of the schema")
    if cursor.next.kind is TokenKind.STRING:
        cursor.take()  # version of the schema, edition 2 of ISO 10303-11
    cursor.expect(";")
    interfaces: list[Interface] = []
    types: dict[str, TypeDefinition] = {}
    entities: dict[str, EntityDefinition] = {}
    declarations: list[Declaration] = []
    while not cursor.skip("END_SCHEMA"):
        match cursor.next.word:
            case "USE" | "REFERENCE":
                interfaces.append(_interface(cursor))
            case "TYPE":
                made = _type(cursor)
                _refuse_known(made.name, types, entities, line=made.line)
                types[made.name] = made
            case "ENTITY":
                entity = _entity(cursor)
                _refuse_known(entity.name, types, entities, line=entity.line)
                entities[entity.name] = entity
            case word if word in _TEXT_BLOCKS:
                declarations.append(_text_block(cursor))
            case _:
                cursor.fail("a declaration or END_SCHEMA")
    cursor.expect(";")
    return Schema(
        name=name,
        interfaces=tuple(interfaces),
        types=types,
        entities=entities,
        declarations=tuple(declarations),
    )


def _refuse_known(name: str, *known: Container[str], line: int) -> None:
    """Fail when a name is declared already."""
    if any(name in names for names in known):
        raise SchemaError("is declared twice", entity=name, line=line)


def _interface(cursor: Cursor) -> Interface:
    """USE or REFERENCE FROM schema (a, b AS c)."""
    keyword = cursor.take().word
    cursor.expect("FROM")
    schema = cursor.name("name of a schema")
    renamed = cursor.items(_renamed) if cursor.next.text == "(" else []
    cursor.expect(";")
    names = {here: there for there, here in renamed}
    return Interface(keyword=keyword, schema=schema, names=names)


def _renamed(cursor: Cursor) -> tuple[str, str]:
    """Name there and name here."""
    there = cursor.name("name of a declaration")
    return there, cursor.name("new name") if cursor.skip("AS") else there


def _text_block(cursor: Cursor) -> Declaration:
    """Text of a block up to the END_ that belongs to it."""
    line = cursor.next.line
    keyword = cursor.take().word
    name = "" if keyword == "CONSTANT" else cursor.name(f"name of the {keyword.lower()}")
    depth = 1
    words: list[str] = []
    while True:
        token = cursor.take()
        if token.kind is TokenKind.END:
            raise SchemaError(f"{keyword} {name} has no END_{keyword}", line=line)
        depth += (token.word == keyword) - (token.word == f"END_{keyword}")
        if depth == 0:
            break
        words.append(f" {token.text}" if token.is_apart else token.text)
    cursor.expect(";")
    return Declaration(keyword=keyword, name=name, text="".join(words).strip(), line=line)


def _type(cursor: Cursor) -> TypeDefinition:
    """TYPE … END_TYPE."""
    line = cursor.take().line
    name = cursor.name("name of the type")
    cursor.expect("=")
    underlying = underlying_type(cursor)
    cursor.expect(";")
    where = _clauses(cursor, "WHERE", until="END_TYPE")
    cursor.expect("END_TYPE", ";")
    return TypeDefinition(name=name, underlying=underlying, where=where, line=line)


def _entity(cursor: Cursor) -> EntityDefinition:
    """ENTITY … END_ENTITY."""
    line = cursor.take().line
    name = cursor.name("name of the entity")
    is_abstract = cursor.skip("ABSTRACT")
    subtypes = _subtypes(cursor)
    supertypes = cursor.names() if cursor.skip("SUBTYPE", "OF") else ()
    cursor.expect(";")
    attributes: list[Attribute] = []
    while cursor.next.word not in {*_PARTS, "END_ENTITY"}:
        attributes.extend(_attributes(cursor))
    _refuse_twins(attributes, entity=name)
    parts = {part: _clauses(cursor, part, until="END_ENTITY") for part in _PARTS}
    cursor.expect("END_ENTITY", ";")
    return EntityDefinition(
        name=name,
        is_abstract=is_abstract,
        subtypes=subtypes,
        supertypes=supertypes,
        attributes=tuple(attributes),
        derived=parts["DERIVE"],
        inverse=parts["INVERSE"],
        unique=parts["UNIQUE"],
        where=parts["WHERE"],
        line=line,
    )


def _subtypes(cursor: Cursor) -> str:
    """SUPERTYPE OF (…); a bare SUPERTYPE after ABSTRACT names none."""
    if not cursor.skip("SUPERTYPE") or not cursor.skip("OF"):
        return ""
    cursor.expect("(")
    text = cursor.text_until(")")
    cursor.expect(")")
    return f"({text})"


def _attributes(cursor: Cursor) -> list[Attribute]:
    """Attributes that share one type: a, b : OPTIONAL REAL;."""
    heads = [_head(cursor)]
    while cursor.skip(","):
        heads.append(_head(cursor))
    cursor.expect(":")
    is_optional = cursor.skip("OPTIONAL")
    shared = attribute_type(cursor)
    cursor.expect(";")
    return [
        Attribute(
            name=name, type=shared, is_optional=is_optional, line=line, redeclares=supertype
        )
        for name, supertype, line in heads
    ]


def _head(cursor: Cursor) -> tuple[str, str, int]:
    """Name, supertype whose attribute is narrowed, line."""
    line = cursor.next.line
    supertype = ""
    if cursor.skip("SELF", "\\"):
        supertype = cursor.name("name of a supertype")
        cursor.expect(".")
    name = cursor.name("an attribute")
    if supertype and cursor.skip("RENAMED"):
        name = cursor.name("new name")
    return name, supertype, line


def _refuse_twins(attributes: list[Attribute], *, entity: str) -> None:
    """Fail when two attributes bear one name."""
    seen: set[str] = set()
    for each in attributes:
        if each.name in seen:
            raise SchemaError(
                "is declared twice", entity=entity, attribute=each.name, line=each.line
            )
        seen.add(each.name)


def _clauses(cursor: Cursor, part: str, *, until: str) -> tuple[Clause, ...]:
    """Lines of one part, empty when the part is absent."""
    if not cursor.skip(part):
        return ()
    clauses: list[Clause] = []
    while cursor.next.word not in {*_PARTS, until}:
        line = cursor.next.line
        label = cursor.name("a label") if cursor.is_label() else ""
        if label:
            cursor.expect(":")
        text = cursor.text_until(";")
        cursor.expect(";")
        clauses.append(Clause(label=label, text=text, line=line))
    return tuple(clauses)
