"""What each attribute of an entity takes: annotations, read when an entity is first bound."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from types import NoneType, UnionType
from typing import Any, Union, cast, get_args, get_origin, get_type_hints

from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.part21.values import Ref, Typed


@dataclass(frozen=True, slots=True, kw_only=True)
class Slot:
    """What one attribute takes; several fields are filled when it is a SELECT."""

    is_optional: bool = False
    references: tuple[type[Entity], ...] = ()
    plain: tuple[type, ...] = ()
    """of str, float, int and bool, and of Typed where the type of a measure matters"""
    enumeration: type[StrEnum] | None = None
    items: "Slot | None" = None
    """of a list"""

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


def slots_of(cls: type[Entity]) -> dict[str, Slot]:
    """Slots of an entity by attribute, in the order of the Part 21 parameters."""
    return _slots_of(cast("Any", cls))


@cache
def _slots_of(cls: Any) -> dict[str, Slot]:
    """Read all annotations of a class, once."""
    hints = get_type_hints(cls)
    return {name: _slot(hints[name]) for name in attributes(cls)}


def _slot(hint: object) -> Slot:
    """Read one annotation."""
    choices = _members(hint)
    classes = [choice for choice in choices if isinstance(choice, type)]
    lists = [get_args(choice)[0] for choice in choices if get_origin(choice) is tuple]
    targets = [get_args(choice)[0] for choice in choices if get_origin(choice) is Ref]
    return Slot(
        is_optional=NoneType in choices,
        references=tuple(member for target in targets for member in _members(target)),
        plain=tuple(choice for choice in classes if choice in _NOUNS),
        enumeration=next((each for each in classes if issubclass(each, StrEnum)), None),
        items=_slot(lists[0]) if lists else None,
    )


def _members(hint: object) -> tuple[Any, ...]:
    """Members of a union; anything else is its only member."""
    return get_args(hint) if get_origin(hint) in {Union, UnionType} else (hint,)
