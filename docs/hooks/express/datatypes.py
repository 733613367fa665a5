"""Data types of EXPRESS (ISO 10303-11, clause 8): what attributes and defined types hold.

Aggregates within one another are built from the inside out, so nesting costs no stack.
"""

from dataclasses import replace

from docs.hooks.express.cursor import Cursor
from docs.hooks.express.schema import (
    SIMPLE_TYPES,
    AggregateKind,
    AggregateType,
    AttributeType,
    EnumerationType,
    NamedType,
    SelectType,
    Underlying,
)

MAX_NESTING = 64
"""aggregates within aggregates; no schema of ISO 10303 has more than three"""

_UNKNOWN = NamedType(name="")


def underlying_type(cursor: Cursor) -> Underlying:
    """Definition of a type."""
    is_extensible = cursor.skip("EXTENSIBLE")
    if is_extensible:
        cursor.skip("GENERIC_ENTITY")
    if cursor.skip("ENUMERATION"):
        items = cursor.names() if cursor.skip("OF") else ()
        based_on, more = _based_on(cursor)
        return EnumerationType(
            items=items + more, based_on=based_on, is_extensible=is_extensible
        )
    if cursor.skip("SELECT"):
        items = cursor.names() if cursor.next.text == "(" else ()
        based_on, more = _based_on(cursor)
        return SelectType(items=items + more, based_on=based_on, is_extensible=is_extensible)
    return attribute_type(cursor)


def _based_on(cursor: Cursor) -> tuple[str, tuple[str, ...]]:
    """BASED_ON a WITH (b, c)."""
    if not cursor.skip("BASED_ON"):
        return "", ()
    base = cursor.name("name of a type")
    return base, cursor.names() if cursor.skip("WITH") else ()


def attribute_type(cursor: Cursor) -> AttributeType:
    """Type of an attribute; aggregates are built from the inside out."""
    outer: list[AggregateType] = []
    while cursor.next.word in AggregateKind.__members__:
        if len(outer) == MAX_NESTING:
            cursor.fail(f"at most {MAX_NESTING} aggregates within one another")
        outer.append(_aggregate(cursor))
    found: AttributeType = _named_type(cursor)
    for each in reversed(outer):
        found = replace(each, element=found)
    return found


def _aggregate(cursor: Cursor) -> AggregateType:
    """LIST [2:?] OF UNIQUE; what it holds is read later."""
    kind = AggregateKind(cursor.take().word)
    lower, upper = "0", "?"
    if cursor.skip("["):
        lower = cursor.text_until(":")
        cursor.expect(":")
        upper = cursor.text_until("]")
        cursor.expect("]")
    cursor.expect("OF")
    is_optional = cursor.skip("OPTIONAL")
    return AggregateType(
        kind=kind,
        element=_UNKNOWN,
        lower=lower,
        upper=upper,
        is_unique=cursor.skip("UNIQUE"),
        is_optional=is_optional,
    )


def _named_type(cursor: Cursor) -> NamedType:
    """REAL, STRING (20) FIXED, or the name of a declaration."""
    name = cursor.name("a type")
    if name.upper() not in SIMPLE_TYPES:
        return NamedType(name=name)
    width = ""
    if cursor.skip("("):
        width = f"({cursor.text_until(')')})"
        cursor.expect(")")
        width += " FIXED" if cursor.skip("FIXED") else ""
    return NamedType(name=name.upper(), width=width)
