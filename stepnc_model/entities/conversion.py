"""Conversion of attribute values between Part 21 and Python, by the annotated types.

Annotations are read when an entity is first bound. Reading is tolerant and raises no errors:
a missing or invalid value becomes an empty list, an empty text or ``None``, with a remark that
describes the deviation.
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
    """Type of one attribute; several fields are set if it is a SELECT."""

    is_optional: bool = False
    references: tuple[type[Entity], ...] = ()
    plain: tuple[type, ...] = ()
    """Plain types: str, float, int, bool, and Typed where the type of a measure matters."""
    enumeration: type[StrEnum] | None = None
    items: "AttributeSlot | None" = None
    """Type of the items of a list."""

    def expected(self) -> str:
        """Description of the expected type, for messages."""
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
    """Slots of a class from its annotations, cached."""
    hints = get_type_hints(cls)
    return {name: _slot(hints[name]) for name in attributes(cls)}


def _slot(hint: object) -> AttributeSlot:
    """Slot for one annotation."""
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
    """Members of a union; any other annotation is its only member."""
    return get_args(hint) if get_origin(hint) in {Union, UnionType} else (hint,)


_TRUTH = {"T": True, "F": False}


@dataclass(frozen=True, slots=True)
class ConversionRemark:
    """Remark on a converted value, with its severity."""

    severity: Severity
    message: str


Taken = tuple[object, ConversionRemark | None]
"""Python value, and a remark if the Part 21 value deviates from its type."""


def take(slot: AttributeSlot, value: Value) -> Taken:
    """Convert a parameter to Python; an empty value if the slot does not accept it."""
    taken, remark = _take(slot, value)
    return _stand_in(slot) if taken is None else taken, remark


def take_missing(slot: AttributeSlot) -> Taken:
    """Empty value for a parameter that is missing at the end of an instance."""
    if slot.is_optional or slot.items is not None:
        text = "missing at the end of the instance, as in older editions"
        return _stand_in(slot), ConversionRemark(Severity.NOTE, text)
    return _stand_in(slot), ConversionRemark(
        Severity.ERROR, "missing at the end of the instance"
    )


def give(slot: AttributeSlot, value: object) -> Value:
    """Convert an attribute value to Part 21: the inverse of :func:`take`.

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
    raise TypeError(f"{value!r} is not a valid attribute value")


def _stand_in(slot: AttributeSlot) -> object:
    """Empty value of a type, so that readers can rely on lists and texts."""
    if slot.is_optional:
        return None
    if slot.items is not None:
        return ()
    return "" if str in slot.plain else None


def _take(slot: AttributeSlot, value: Value) -> Taken:
    """Convert a parameter to Python; ``None`` if the slot does not accept it."""
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
            Severity.NOTE, "$ where a list is required: read as an empty list"
        )
    if str in slot.plain:
        return ConversionRemark(
            Severity.NOTE, "$ where a text is required: read as an empty text"
        )
    return ConversionRemark(Severity.WARNING, f"$ where {slot.expected()} is required")


def _take_list(slot: AttributeSlot, value: tuple[Value, ...]) -> Taken:
    """Convert all items of a list, or none: a gap would shift coordinates."""
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
        Severity.ERROR, remark.message if remark else "items are missing"
    )


def _first_remark(remarks: list[ConversionRemark | None]) -> ConversionRemark | None:
    """First remark on the items of a list, with the item's position."""
    for place, remark in enumerate(remarks, 1):
        if remark is not None:
            return ConversionRemark(remark.severity, f"item {place}: {remark.message}")
    return None


def _take_single(slot: AttributeSlot, value: Value) -> Taken:
    """Convert a value whose list brackets are missing."""
    items, remark = _take_list(slot, (value,))
    if remark is not None:
        return items, remark
    return items, ConversionRemark(Severity.WARNING, "a list of one item lacks its brackets")


def _take_typed(slot: AttributeSlot, value: Typed) -> Taken:
    """Convert a measure; its type is kept where it matters, else dropped."""
    inner = value.value
    while isinstance(inner, Typed):
        inner = inner.value
    if Typed in slot.plain and isinstance(inner, Real) and isfinite(inner):
        return value, None
    return _take(slot, inner)


def _take_enumeration(slot: AttributeSlot, value: Enumeration) -> Taken:
    """Convert a member of the slot's enumeration, or a truth value."""
    name = value.upper()
    if slot.enumeration is not None and name in set(slot.enumeration):
        return slot.enumeration(name), None
    if bool in slot.plain and name in _TRUTH:
        return _TRUTH[name], None
    if bool in slot.plain or slot.enumeration is not None:
        return None, ConversionRemark(Severity.WARNING, f".{value}. is not {slot.expected()}")
    return _refused(slot, value)


def _take_number(slot: AttributeSlot, value: int | Real) -> Taken:
    """Convert a finite number, which must be whole where an integer is required."""
    if float not in slot.plain and int not in slot.plain:
        return _refused(slot, value)
    if isinstance(value, int):
        return _take_integer(value) if float in slot.plain else (value, None)
    if not isfinite(value):
        return None, ConversionRemark(Severity.ERROR, f"{value:g} is not a finite number")
    if float in slot.plain:
        return value, None
    if value.is_integer():
        return int(value), ConversionRemark(
            Severity.NOTE, "a real where an integer is required"
        )
    return None, ConversionRemark(Severity.ERROR, f"{value:g} where an integer is required")


def _take_integer(value: int) -> Taken:
    """Convert an integer where a real is required, unless it is too large."""
    try:
        return float(value), None
    except OverflowError:
        return None, ConversionRemark(Severity.ERROR, "the integer is too large for a real")


def _refused(slot: AttributeSlot, value: object) -> Taken:
    """Remark on a value of the wrong kind."""
    shown = f".{value}." if isinstance(value, Enumeration) else repr(value)
    return None, ConversionRemark(
        Severity.ERROR, f"{shown} where {slot.expected()} is required"
    )
