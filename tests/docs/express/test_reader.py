import re
from importlib.resources import files

import pytest
from hypothesis import given
from hypothesis import strategies as st

from docs.hooks.express.reader import read_schemas
from docs.hooks.express.schema import (
    AggregateType,
    EnumerationType,
    NamedType,
    Schema,
    SelectType,
    attributes_in_order,
)
from stepnc_model.errors import SchemaError

OPTIMISATION = files("stepnc_model").joinpath("schemas/optimisation.exp").read_text("utf-8")

DRILL = """
(* everything a schema may hold *)
SCHEMA drill_schema;
USE FROM support (label AS name, length);
REFERENCE FROM other;
CONSTANT
  most : INTEGER := 7;
END_CONSTANT;
TYPE hand = ENUMERATION OF (left, right); END_TYPE;
TYPE body = SELECT (drill, reamer); END_TYPE;
TYPE ratio = REAL; WHERE wr1: {0.0 <= SELF <= 1.0}; END_TYPE;
ENTITY tool ABSTRACT SUPERTYPE OF (ONEOF (drill, reamer) ANDOR coated);
  its_id : label;  -- of the shop
  teeth, flutes : OPTIONAL INTEGER;
END_ENTITY;
ENTITY drill SUBTYPE OF (tool);
  SELF\\tool.teeth : INTEGER;
  steps : LIST [1:most] OF UNIQUE length;
DERIVE
  point : REAL := steps[1] * 2;
INVERSE
  users : SET [0:?] OF operation FOR its_tool;
UNIQUE
  ur1: its_id, steps;
  teeth;
WHERE
  wr1: teeth > 0;
  SIZEOF (QUERY (s <* steps | s <= 0.0)) = 0;
  wr3: its_id <> 'a;b';
END_ENTITY;
FUNCTION twice (x : REAL) : REAL;
  FUNCTION inner (y : REAL) : REAL; RETURN (y); END_FUNCTION;
  RETURN (inner (x) * 2);
END_FUNCTION;
RULE all_named FOR (tool); WHERE wr1: TRUE; END_RULE;
END_SCHEMA;
"""


@pytest.fixture(scope="module")
def drill() -> Schema:
    (found,) = read_schemas(DRILL)
    return found


def test_interfaces_know_both_names(drill: Schema) -> None:
    use, reference = drill.interfaces
    assert (use.keyword, use.schema, dict(use.names)) == (
        *("USE", "support"),
        {"name": "label", "length": "length"},
    )
    assert (reference.keyword, dict(reference.names)) == ("REFERENCE", {})


def test_types_are_read(drill: Schema) -> None:
    assert drill.types["hand"].underlying == EnumerationType(items=("left", "right"))
    assert drill.types["body"].underlying == SelectType(items=("drill", "reamer"))
    assert drill.types["ratio"].where[0].text == "{0.0 <= SELF <= 1.0}"


def test_abstract_supertype_keeps_its_constraint(drill: Schema) -> None:
    tool = drill.entities["tool"]
    assert tool.is_abstract
    assert tool.subtypes == "(ONEOF (drill, reamer) ANDOR coated)"
    assert drill.entities["drill"].supertypes == ("tool",)


def test_attributes_that_share_a_type_stand_alone(drill: Schema) -> None:
    _, teeth, flutes = drill.entities["tool"].attributes
    assert (teeth.name, flutes.name, teeth.type) == ("teeth", "flutes", flutes.type)
    assert teeth.is_optional


def test_rules_keep_their_text(drill: Schema) -> None:
    entity = drill.entities["drill"]
    assert [(each.label, each.text) for each in entity.where] == [
        ("wr1", "teeth > 0"),
        ("", "SIZEOF (QUERY (s <* steps | s <= 0.0)) = 0"),
        ("wr3", "its_id <> 'a;b'"),
    ]
    assert [(each.label, each.text) for each in entity.unique] == [
        ("ur1", "its_id, steps"),
        ("", "teeth"),
    ]
    assert entity.derived[0].text == "REAL := steps[1] * 2"
    assert entity.inverse[0].text == "SET [0:?] OF operation FOR its_tool"


def test_narrowed_attribute_names_its_supertype(drill: Schema) -> None:
    assert drill.entities["drill"].attributes[0].redeclares == "tool"


def test_functions_and_rules_are_kept_as_text(drill: Schema) -> None:
    assert [(each.keyword, each.name) for each in drill.declarations] == [
        ("CONSTANT", ""),
        ("FUNCTION", "twice"),
        ("RULE", "all_named"),
    ]
    assert "END_FUNCTION" in drill.declarations[1].text


def test_lines_are_those_of_the_text(drill: Schema) -> None:
    assert drill.entities["tool"].line == 12
    assert drill.entities["drill"].where[2].line == 29


def test_schemas_of_one_text_stay_apart() -> None:
    first, second = read_schemas("SCHEMA a; END_SCHEMA; SCHEMA b '{1 2}'; END_SCHEMA;")
    assert (first.name, second.name) == ("a", "b")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no SCHEMA"),
        ("ISO-10303-21;", "SCHEMA expected, found ISO"),
        ("SCHEMA s; ENTITY e; x : REAL; END_SCHEMA;", "expected"),
        ("SCHEMA s; ENTITY e; x REAL; END_ENTITY; END_SCHEMA;", ": expected, found REAL"),
        ("SCHEMA s; ENTITY e; x, x : REAL; END_ENTITY; END_SCHEMA;", "e.x: is declared twice"),
        ("SCHEMA s; TYPE e = REAL; END_TYPE; ENTITY e; END_ENTITY; END_SCHEMA;", "twice"),
        ("SCHEMA s; FUNCTION f; RETURN (1);", "FUNCTION f has no END_FUNCTION"),
        ("SCHEMA s; ENTITY e; WHERE w: (1;", "; expected"),
        ("SCHEMA s;", "a declaration or END_SCHEMA expected"),
    ],
)
def test_what_is_no_schema_is_refused(text: str, words: str) -> None:
    with pytest.raises(SchemaError, match=words):
        read_schemas(text)


def test_every_type_of_our_schema_is_declared() -> None:
    (schema,) = read_schemas(OPTIMISATION)
    known = {*schema.types, *schema.entities}.union(*(each.names for each in schema.interfaces))
    for entity in schema.entities.values():
        assert set(entity.supertypes) <= known
        for attribute in attributes_in_order(schema, entity.name):
            found = attribute.type
            while isinstance(found, AggregateType):
                found = found.element
            assert found.name in known or found == NamedType(name=found.name.upper())


def test_everything_our_schema_borrows_is_used() -> None:
    (schema,) = read_schemas(OPTIMISATION)
    words = re.findall(r"\w+", OPTIMISATION)
    for interface in schema.interfaces:
        assert [name for name in interface.names if words.count(name) < 2] == []


def test_schema_of_thousands_of_entities_is_read() -> None:
    entity = (
        "ENTITY e{0} SUBTYPE OF (e); a, b : LIST [0:?] OF REAL; WHERE w: (a > b); END_ENTITY;\n"
    )
    text = "SCHEMA s;\n" + "".join(map(entity.format, range(3000))) + "END_SCHEMA;"
    assert len(read_schemas(text)[0].entities) == 3000


WORDS = sorted({*OPTIMISATION.split()[:400], "(*", "*)", "--", "'", "LIST OF", "\\", "?", "\0"})


@given(st.lists(st.sampled_from(WORDS), max_size=60).map(" ".join))
def test_shuffled_words_raise_nothing_but_schema_error(text: str) -> None:
    try:
        read_schemas("SCHEMA s; " + text)
    except SchemaError:
        return


@given(st.integers(0, len(OPTIMISATION)), st.integers(0, 40), st.text(max_size=5))
def test_damaged_schema_raises_nothing_but_schema_error(
    start: int, length: int, patch: str
) -> None:
    try:
        read_schemas(OPTIMISATION[:start] + patch + OPTIMISATION[start + length :])
    except SchemaError:
        return


@given(st.text(max_size=200))
def test_any_text_raises_nothing_but_schema_error(text: str) -> None:
    try:
        read_schemas(text)
    except SchemaError:
        return
