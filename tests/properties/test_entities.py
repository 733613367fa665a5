"""Any entity is the same after it was written and read again."""

from functools import cache
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Typed, Value
from stepnc_model.part21.writer import format_value
from stepnc_model.programs.binding import Model, bind, to_parameters

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=12)
PLAIN: dict[type, st.SearchStrategy[Any]] = {
    str: TEXTS,
    bool: st.booleans(),
    int: st.integers(-(10**9), 10**9),
    float: NUMBERS,
    Typed: NUMBERS.map(lambda number: Typed("SOME_MEASURE", Real(number))),
}
ENTITIES = sorted(set(classes().values()), key=lambda cls: cls.keyword)

VALUES: st.SearchStrategy[Value] = st.recursive(
    st.none()
    | st.integers(-99, 99)
    | st.floats().map(Real)
    | TEXTS
    | st.sampled_from(["T", "U", "TCP", "LEFT", "CW"]).map(Enumeration)
    | st.integers(1, 5).map(Ref[object]),
    lambda inner: (
        st.lists(inner, max_size=3).map(tuple)
        | inner.map(lambda value: Typed("SOME_MEASURE", value))
    ),
    max_leaves=4,
)


def values_of(slot: AttributeSlot) -> st.SearchStrategy[Any]:
    choices = [PLAIN[kind] for kind in slot.plain]
    if slot.references:
        choices.append(st.integers(2, 99).map(Ref[object]))
    if slot.enumeration is not None:
        choices.append(st.sampled_from(slot.enumeration))
    if slot.items is not None:
        choices.append(st.lists(values_of(slot.items), max_size=3).map(tuple))
    if slot.is_optional:
        choices.append(st.none())
    return st.one_of(choices)


@cache
def entities_of(keyword: str) -> st.SearchStrategy[Entity]:
    cls = classes()[keyword]
    attributes = {name: values_of(slot) for name, slot in slots_of(cls).items()}
    return st.fixed_dictionaries(attributes).map(lambda found: cls(**found))


any_entity = st.sampled_from([cls.keyword for cls in ENTITIES]).flatmap(entities_of)


@given(any_entity)
@settings(max_examples=300, deadline=None)
def test_entity_survives_writing_and_reading(entity: Entity) -> None:
    text = entity.keyword.encode() + format_value(to_parameters(entity))
    data = b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=" + text
    data += b";\nENDSEC;\nEND-ISO-10303-21;\n"
    assert Model(Part21File.from_bytes(data)).entity(1) == entity


@given(st.sampled_from(ENTITIES), st.lists(VALUES, max_size=20).map(tuple))
@settings(max_examples=500, deadline=None)
def test_no_parameters_are_fatal(cls: type[Entity], values: tuple[Value, ...]) -> None:
    bound = bind(cls, values)
    assert isinstance(bound.entity, cls)
    assert bind(cls, to_parameters(bound.entity)).entity == bound.entity
