import pytest

from docs.hooks.express.reader import read_schemas
from docs.hooks.express.schema import Schema, attributes_in_order
from stepnc_model.errors import SchemaError


def schema(body: str) -> Schema:
    return read_schemas(f"SCHEMA s; {body} END_SCHEMA;")[0]


def names(found: Schema, entity: str) -> list[str]:
    return [attribute.name for attribute in attributes_in_order(found, entity)]


def test_supertypes_come_first() -> None:
    found = schema(
        "ENTITY a; x : REAL; END_ENTITY;"
        "ENTITY b SUBTYPE OF (a); y : REAL; END_ENTITY;"
        "ENTITY c SUBTYPE OF (b); z : REAL; END_ENTITY;"
    )
    assert names(found, "c") == ["x", "y", "z"]


def test_supertype_of_both_supertypes_comes_once() -> None:
    found = schema(
        "ENTITY root; r : REAL; END_ENTITY;"
        "ENTITY left SUBTYPE OF (root); l : REAL; END_ENTITY;"
        "ENTITY right SUBTYPE OF (root); q : REAL; END_ENTITY;"
        "ENTITY both SUBTYPE OF (left, right); b : REAL; END_ENTITY;"
    )
    assert names(found, "both") == ["r", "l", "q", "b"]


def test_narrowed_attribute_keeps_the_place_of_the_supertype() -> None:
    found = schema(
        "ENTITY a; x, y : REAL; END_ENTITY;"
        "ENTITY b SUBTYPE OF (a); SELF\\a.x : INTEGER; z : REAL; END_ENTITY;"
    )
    assert names(found, "b") == ["x", "y", "z"]


def test_supertype_of_another_schema_is_refused() -> None:
    found = schema("ENTITY b SUBTYPE OF (elsewhere); z : REAL; END_ENTITY;")
    with pytest.raises(SchemaError, match="no entity 'elsewhere'"):
        attributes_in_order(found, "b")


def test_entity_above_itself_is_refused() -> None:
    found = schema("ENTITY a SUBTYPE OF (b); END_ENTITY; ENTITY b SUBTYPE OF (a); END_ENTITY;")
    with pytest.raises(SchemaError, match="its own supertype"):
        attributes_in_order(found, "a")


def test_chain_of_supertypes_costs_no_stack() -> None:
    chain = "".join(
        f"ENTITY e{i} SUBTYPE OF (e{i + 1}); x{i} : REAL; END_ENTITY;" for i in range(5000)
    )
    found = schema(chain + "ENTITY e5000; x5000 : REAL; END_ENTITY;")
    assert names(found, "e0") == [f"x{i}" for i in range(5000, -1, -1)]
