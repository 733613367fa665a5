import pytest

from docs.hooks.express.cursor import Cursor
from docs.hooks.express.datatypes import MAX_NESTING, attribute_type, underlying_type
from docs.hooks.express.lexer import tokens
from docs.hooks.express.schema import (
    AggregateKind,
    AggregateType,
    EnumerationType,
    NamedType,
    SelectType,
    Underlying,
)
from stepnc_model.errors import SchemaError


def of(source: str) -> Underlying:
    return underlying_type(Cursor(tokens(source)))


def test_simple_types_are_capitals_and_names_are_not() -> None:
    assert of("real") == NamedType(name="REAL")
    assert of("Length_Measure") == NamedType(name="length_measure")


def test_string_keeps_its_width() -> None:
    assert of("STRING (n + 1) FIXED") == NamedType(name="STRING", width="(n + 1) FIXED")


def test_aggregate_keeps_its_bounds() -> None:
    assert of("LIST [2:?] OF UNIQUE direction") == AggregateType(
        kind=AggregateKind.LIST,
        element=NamedType(name="direction"),
        lower="2",
        upper="?",
        is_unique=True,
    )


def test_bounds_left_out_are_none_at_all() -> None:
    assert of("SET OF a") == AggregateType(
        kind=AggregateKind.SET, element=NamedType(name="a"), lower="0", upper="?"
    )


def test_bounds_may_be_expressions() -> None:
    found = of("ARRAY [f(a[1]):2 * (n + 1)] OF OPTIONAL REAL")
    assert isinstance(found, AggregateType)
    assert (found.lower, found.upper, found.is_optional) == ("f(a[1])", "2 * (n + 1)", True)


def test_aggregates_nest_in_the_order_written() -> None:
    outer = of("LIST OF SET OF BAG OF REAL")
    assert isinstance(outer, AggregateType)
    assert isinstance(outer.element, AggregateType)
    assert isinstance(outer.element.element, AggregateType)
    kinds = (outer.kind, outer.element.kind, outer.element.element.kind)
    assert kinds == (AggregateKind.LIST, AggregateKind.SET, AggregateKind.BAG)
    assert outer.element.element.element == NamedType(name="REAL")


def test_enumeration_and_select() -> None:
    assert of("ENUMERATION OF (CW, ccw)") == EnumerationType(items=("cw", "ccw"))
    assert of("SELECT (a, B)") == SelectType(items=("a", "b"))


def test_extensible_types_of_the_second_edition() -> None:
    assert of("EXTENSIBLE GENERIC_ENTITY SELECT BASED_ON base WITH (a)") == SelectType(
        items=("a",), based_on="base", is_extensible=True
    )
    assert of("EXTENSIBLE ENUMERATION") == EnumerationType(items=(), is_extensible=True)


def test_depth_is_bounded() -> None:
    within = attribute_type(Cursor(tokens("LIST OF " * MAX_NESTING + "REAL")))
    assert isinstance(within, AggregateType)
    with pytest.raises(SchemaError, match="within one another"):
        attribute_type(Cursor(tokens("LIST OF " * (MAX_NESTING + 1) + "REAL")))


@pytest.mark.parametrize(
    "source", ["", "LIST [0:?] direction", "LIST [1] OF a", "STRING (3", "5"]
)
def test_half_a_type_is_refused(source: str) -> None:
    with pytest.raises(SchemaError):
        of(source)
