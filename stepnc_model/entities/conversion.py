"""Types of attributes, and one attribute: Part 21 value to Python value and back.

Annotations are read when an entity is first bound. Reading is tolerant. What a value lacks
becomes an empty list, an empty text or ``None``, and what is odd about it a remark; nothing is
raised.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Union, cast, get_args, get_origin, get_type_hints

from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.errors import Severity
from stepnc_model.part21.values import Binary, Derived, Enumeration, Real, Ref, Typed, Value


@dataclass(frozen=True, slots=True, kw_only=True)
class AttributeSlot:
    """Type of one attribute; several fields are filled when it is a SELECT."""

    is_optional: bool = False
    references: tuple[type[Entity], ...] = ()
    plain: tuple[type, ...] = ()
    """of str, float, int and bool, and of Typed where the type of a measure matters"""
    enumeration: type[StrEnum] | None = None
    items: "AttributeSlot | None" = None
    """Items of a list"""

    def expected(self) -> str:
        """Noun for messages."""
        names = [cls.express_name() for cls in self.references]
        names += dict.fromkeys(_NOUNS[kind] for kind in self.plain)
        if self.enumeration is not None:
            names.append(f"one of {', '.join(f'.{each.value}.' for each in self.enumeration)}")
        if self.items is not None:
            names.append("a list")
        return " or ".join(names)


_NOUNS = {
    str: "a text",
    bool: "a truth value",
    int: "an integer",
    float: "a number",
    Typed: "a number",
}


def slots_of(cls: type[Entity]) -> dict[str, AttributeSlot]:
    """Slots of an entity by attribute, in the order of the Part 21 parameters."""
    return _slots_of(cast("Any", cls))


@cache
def _slots_of(cls: Any) -> dict[str, AttributeSlot]:
    """Read all annotations of a class, once."""
    hints = get_type_hints(cls)
    return {name: _slot(hints[name]) for name in attributes(cls)}


def _slot(hint: object) -> AttributeSlot:
    """Read one annotation."""
    choices = _members(hint)
    classes = [choice for choice in choices if isinstance(choice, type)]
    lists = [get_args(choice)[0] for choice in choices if get_origin(choice) is tuple]
    targets = [get_args(choice)[0] for choice in choices if get_origin(choice) is Ref]
    return AttributeSlot(
        is_optional=NoneType in choices,
        references=tuple(member for target in targets for member in _members(target)),
        plain=tuple(choice for choice in classes if choice in _NOUNS),
        enumeration=next((each for each in classes if issubclass(each, StrEnum)), None),
        items=_slot(lists[0]) if lists else None,
    )


def _members(hint: object) -> tuple[Any, ...]:
    """Members of a union; anything else is its only member."""
    return get_args(hint) if get_origin(hint) in {Union, UnionType} else (hint,)


_TRUTH = {"T": True, "F": False}


@dataclass(frozen=True, slots=True)
class ConversionRemark:
    """Remark on one value."""

    severity: Severity
    message: str


Taken = tuple[object, ConversionRemark | None]
"""a Python value, and what is odd about it"""


def take(slot: AttributeSlot, value: Value) -> Taken:
    """Python value of one parameter, or its stand-in when the slot does not take it."""
    taken, remark = _take(slot, value)
    return _stand_in(slot) if taken is None else taken, remark


def take_missing(slot: AttributeSlot) -> Taken:
    """Stand-in for a parameter that the instance is too short for."""
    if slot.is_optional or slot.items is not None:
        text = "is missing at the end, as in older editions"
        return _stand_in(slot), ConversionRemark(Severity.NOTE, text)
    return _stand_in(slot), ConversionRemark(Severity.ERROR, "is missing at the end")


def give(slot: AttributeSlot, value: object) -> Value:
    """Part 21 value of one attribute: the inverse of :func:`take`.

    Raises
    ------
    TypeError
        If the value has no form in ISO 10303-21.
    """
    if isinstance(value, tuple):
        return tuple(give(slot.items or slot, item) for item in value)
    if isinstance(value, bool):
        return Enumeration("T" if value else "F")
    if isinstance(value, StrEnum):
        return Enumeration(value.value)
    if isinstance(value, Real | Ref):
        return cast("Value", value)
    if isinstance(value, float) or (isinstance(value, int) and int not in slot.plain):
        return Real(value)
    if value is None or isinstance(value, int | str | Typed | Derived):
        return value
    raise TypeError(f"{value!r} is no value of an attribute")


def _stand_in(slot: AttributeSlot) -> object:
    """Empty value of a type: readers may rely on lists and texts."""
    if slot.is_optional:
        return None
    if slot.items is not None:
        return ()
    return "" if str in slot.plain else None


def _take(slot: AttributeSlot, value: Value) -> Taken:
    """Python value of one parameter; ``None`` when the slot does not take it."""
    if value is None or isinstance(value, Derived):
        return None, None if isinstance(value, Derived) else _unset(slot)
    if isinstance(value, tuple):
        return _take_list(slot, value)
    if slot.items is not None:
        return _take_single(slot, value)
    if isinstance(value, Typed):
        return _take_typed(slot, value)
    if isinstance(value, Ref):
        return (value, None) if slot.references else _refused(slot, value)
    if isinstance(value, Enumeration):
        return _take_enumeration(slot, value)
    if isinstance(value, int | Real):
        return _take_number(slot, value)
    if isinstance(value, Binary) or str not in slot.plain:
        return _refused(slot, value)
    return value, None


def _unset(slot: AttributeSlot) -> ConversionRemark | None:
    """Remark on ``$`` for an attribute."""
    if slot.is_optional:
        return None
    if slot.items is not None:
        return ConversionRemark(
            Severity.NOTE, "$ where a list is required: read as an empty one"
        )
    if str in slot.plain:
        return ConversionRemark(
            Severity.NOTE, "$ where a text is required: read as an empty one"
        )
    return ConversionRemark(Severity.WARNING, f"$ where {slot.expected()} is required")


def _take_list(slot: AttributeSlot, value: tuple[Value, ...]) -> Taken:
    """Every item, or none: a list with a hole would shift coordinates."""
    if slot.items is None:
        return None, ConversionRemark(
            Severity.ERROR, f"a list where {slot.expected()} is required"
        )
    taken = [_take(slot.items, item) for item in value]
    items = tuple(item for item, _ in taken)
    remark = _first_remark([each for _, each in taken])
    if None not in items:
        return items, remark
    if slot.items.references:
        return tuple(item for item in items if item is not None), remark
    return (), ConversionRemark(
        Severity.ERROR, remark.message if remark else "items are left out"
    )


def _first_remark(remarks: list[ConversionRemark | None]) -> ConversionRemark | None:
    """The first thing that is odd about a list."""
    for place, remark in enumerate(remarks, 1):
        if remark is not None:
            return ConversionRemark(remark.severity, f"item {place}: {remark.message}")
    return None


def _take_single(slot: AttributeSlot, value: Value) -> Taken:
    """A value without the brackets of its list."""
    items, remark = _take_list(slot, (value,))
    if remark is not None:
        return items, remark
    return items, ConversionRemark(Severity.WARNING, "a list of one item lacks its brackets")


def _take_typed(slot: AttributeSlot, value: Typed) -> Taken:
    """A measure: the type is kept where it matters, unwrapped where the slot implies it."""
    inner = value.value
    while isinstance(inner, Typed):
        inner = inner.value
    if Typed in slot.plain and isinstance(inner, Real) and isfinite(inner):
        return value, None
    return _take(slot, inner)


def _take_enumeration(slot: AttributeSlot, value: Enumeration) -> Taken:
    """A member of the slot's enumeration, or a truth value."""
    name = value.upper()
    if slot.enumeration is not None and name in set(slot.enumeration):
        return slot.enumeration(name), None
    if bool in slot.plain and name in _TRUTH:
        return _TRUTH[name], None
    if bool in slot.plain or slot.enumeration is not None:
        return None, ConversionRemark(Severity.WARNING, f".{value}. is not {slot.expected()}")
    return _refused(slot, value)


def _take_number(slot: AttributeSlot, value: int | Real) -> Taken:
    """A finite number, whole where an integer is required."""
    if float not in slot.plain and int not in slot.plain:
        return _refused(slot, value)
    if isinstance(value, int):
        return _take_integer(value) if float in slot.plain else (value, None)
    if not isfinite(value):
        return None, ConversionRemark(Severity.ERROR, f"{value:g} is no finite number")
    if float in slot.plain:
        return value, None
    if value.is_integer():
        return int(value), ConversionRemark(
            Severity.NOTE, "a real where an integer is required"
        )
    return None, ConversionRemark(Severity.ERROR, f"{value:g} where an integer is required")


def _take_integer(value: int) -> Taken:
    """An integer where a real is required, unless it is beyond all reals."""
    try:
        return float(value), None
    except OverflowError:
        return None, ConversionRemark(Severity.ERROR, "an integer beyond all reals")


def _refused(slot: AttributeSlot, value: object) -> Taken:
    """A value of the wrong kind."""
    shown = f".{value}." if isinstance(value, Enumeration) else repr(value)
    return None, ConversionRemark(
        Severity.ERROR, f"{shown} where {slot.expected()} is required"
    )
