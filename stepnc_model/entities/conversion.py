"""One attribute: Part 21 value to Python value and back.

Reading is tolerant. What a value lacks becomes an empty list, an empty text or ``None``, and
what is odd about it a remark; nothing is raised.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import cast

from stepnc_model.entities.slots import Slot
from stepnc_model.errors import Severity
from stepnc_model.part21.values import Binary, Derived, Enumeration, Real, Ref, Typed, Value

_TRUTH = {"T": True, "F": False}


@dataclass(frozen=True, slots=True)
class Remark:
    """What is odd about one value."""

    severity: Severity
    message: str


Taken = tuple[object, Remark | None]
"""a Python value, and what is odd about it"""


def take(slot: Slot, value: Value) -> Taken:
    """Python value of one parameter, or its stand-in when the slot does not take it."""
    taken, remark = _take(slot, value)
    return _stand_in(slot) if taken is None else taken, remark


def take_missing(slot: Slot) -> Taken:
    """Stand-in for a parameter that the instance is too short for."""
    if slot.is_optional or slot.items is not None:
        text = "is missing at the end, as in older editions"
        return _stand_in(slot), Remark(Severity.NOTE, text)
    return _stand_in(slot), Remark(Severity.ERROR, "is missing at the end")


def give(slot: Slot, value: object) -> Value:
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


def _stand_in(slot: Slot) -> object:
    """What comes nearest to nothing: readers may rely on lists and texts."""
    if slot.is_optional:
        return None
    if slot.items is not None:
        return ()
    return "" if str in slot.plain else None


def _take(slot: Slot, value: Value) -> Taken:
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


def _unset(slot: Slot) -> Remark | None:
    """What to say about ``$``."""
    if slot.is_optional:
        return None
    if slot.items is not None:
        return Remark(Severity.NOTE, "$ where a list is required: read as an empty one")
    if str in slot.plain:
        return Remark(Severity.NOTE, "$ where a text is required: read as an empty one")
    return Remark(Severity.WARNING, f"$ where {slot.expected()} is required")


def _take_list(slot: Slot, value: tuple[Value, ...]) -> Taken:
    """Every item, or none: a list with a hole would shift coordinates."""
    if slot.items is None:
        return None, Remark(Severity.ERROR, f"a list where {slot.expected()} is required")
    taken = [_take(slot.items, item) for item in value]
    items = tuple(item for item, _ in taken)
    remark = _first_remark([each for _, each in taken])
    if None not in items:
        return items, remark
    if slot.items.references:
        return tuple(item for item in items if item is not None), remark
    return (), Remark(Severity.ERROR, remark.message if remark else "items are left out")


def _first_remark(remarks: list[Remark | None]) -> Remark | None:
    """The first thing that is odd about a list."""
    for place, remark in enumerate(remarks, 1):
        if remark is not None:
            return Remark(remark.severity, f"item {place}: {remark.message}")
    return None


def _take_single(slot: Slot, value: Value) -> Taken:
    """A value without the brackets of its list."""
    items, remark = _take_list(slot, (value,))
    if remark is not None:
        return items, remark
    return items, Remark(Severity.WARNING, "a list of one item lacks its brackets")


def _take_typed(slot: Slot, value: Typed) -> Taken:
    """A measure: the type is kept where it matters, unwrapped where the slot implies it."""
    inner = value.value
    while isinstance(inner, Typed):
        inner = inner.value
    if Typed in slot.plain and isinstance(inner, Real) and isfinite(inner):
        return value, None
    return _take(slot, inner)


def _take_enumeration(slot: Slot, value: Enumeration) -> Taken:
    """A member of the slot's enumeration, or a truth value."""
    name = value.upper()
    if slot.enumeration is not None and name in set(slot.enumeration):
        return slot.enumeration(name), None
    if bool in slot.plain and name in _TRUTH:
        return _TRUTH[name], None
    if bool in slot.plain or slot.enumeration is not None:
        return None, Remark(Severity.WARNING, f".{value}. is not {slot.expected()}")
    return _refused(slot, value)


def _take_number(slot: Slot, value: int | Real) -> Taken:
    """A finite number, whole where an integer is required."""
    if float not in slot.plain and int not in slot.plain:
        return _refused(slot, value)
    if isinstance(value, int):
        return _take_integer(value) if float in slot.plain else (value, None)
    if not isfinite(value):
        return None, Remark(Severity.ERROR, f"{value:g} is no finite number")
    if float in slot.plain:
        return value, None
    if value.is_integer():
        return int(value), Remark(Severity.NOTE, "a real where an integer is required")
    return None, Remark(Severity.ERROR, f"{value:g} where an integer is required")


def _take_integer(value: int) -> Taken:
    """An integer where a real is required, unless it is beyond all reals."""
    try:
        return float(value), None
    except OverflowError:
        return None, Remark(Severity.ERROR, "an integer beyond all reals")


def _refused(slot: Slot, value: object) -> Taken:
    """A value of the wrong kind."""
    shown = f".{value}." if isinstance(value, Enumeration) else repr(value)
    return None, Remark(Severity.ERROR, f"{shown} where {slot.expected()} is required")
