"""Base class of all ISO 14649 entities: a frozen, slotted, keyword-only dataclass.

The order of the fields, supertypes first, is the order of the parameters in a Part 21 file.
Attributes that point to an instance hold a :class:`~stepnc_model.part21.values.Ref`, never the
entity itself, so that circular and dangling references cause no problems; they are resolved by
:class:`stepnc_model.programs.binding.Model`.

Plain ``@dataclass`` is not used because it generates and compiles five methods per class,
which takes half a millisecond each, and about three hundred classes are loaded before
``--help``. Here all classes share one ``__init__``, ``__repr__``, ``__eq__`` and ``__hash__``,
driven by the fields, and annotations stay strings (``from __future__ import annotations``)
until they are needed. ``dataclasses.fields``, ``replace`` and ``asdict`` work as usual.
"""

from __future__ import annotations

import re
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from typing import TYPE_CHECKING, dataclass_transform

if TYPE_CHECKING:
    from dataclasses import Field
    from typing import Any, ClassVar, NoReturn

_WORD = re.compile(r"(?<=.)(?=[A-Z])|(?<=[a-z])(?=[0-9][a-z])")


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(field,))
class EntityType(type):
    """Metaclass that makes each entity a dataclass and derives its keyword from its name."""

    def __new__(
        cls,
        name: str,
        bases: tuple[type, ...],
        namespace: dict[str, Any],
        *,
        abstract: bool = False,
    ) -> Any:
        """Create the class; an ``abstract`` class has no instances in a file."""
        made: Any = super().__new__(cls, name, bases, namespace)
        if "__slots__" in namespace:
            return made  # the dataclass makes its class once more, with slots
        made = dataclass(init=False, repr=False, eq=False, slots=True, kw_only=True)(made)
        if not abstract:
            made.keyword = _WORD.sub("_", name).upper()
        return made


class Entity(metaclass=EntityType, abstract=True):
    """Base of all entities of ISO 14649: immutable, equal by value."""

    keyword = ""
    """Name in a Part 21 file; an abstract class has the one of the entity above it, or none."""

    if TYPE_CHECKING:
        __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @classmethod
    def express_name(cls) -> str:
        """Name in the standard's spelling, such as ``plane_rough_milling``."""
        return _WORD.sub("_", cls.__name__).lower()

    def __init__(self, **attributes: object) -> None:
        missing = []
        for name, attribute in self.__dataclass_fields__.items():
            value = attributes.pop(name, attribute.default)
            if value is MISSING:
                missing.append(name)
            object.__setattr__(self, name, value)
        if missing:
            raise TypeError(f"{type(self).__name__} requires {', '.join(missing)}")
        if attributes:
            raise TypeError(f"{type(self).__name__} has no {', '.join(attributes)}")

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise FrozenInstanceError(f"cannot assign to {type(self).__name__}.{name}")

    def __delattr__(self, name: str) -> NoReturn:
        raise FrozenInstanceError(f"cannot delete {type(self).__name__}.{name}")

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and values(other) == values(self)

    def __hash__(self) -> int:
        return hash((type(self), values(self)))

    def __repr__(self) -> str:
        shown = (f"{name}={getattr(self, name)!r}" for name in self.__dataclass_fields__)
        return f"{type(self).__name__}({', '.join(shown)})"

    def __setstate__(self, state: tuple[None, dict[str, object]]) -> None:
        for name, value in state[1].items():
            object.__setattr__(self, name, value)


def apart() -> Any:
    """Field that the EXPRESS entity does not have: no Part 21 position, absent by default."""
    return field(default=None, metadata={"express": False})


def attributes(cls: type[Entity] | Entity) -> tuple[str, ...]:
    """EXPRESS names of the explicit attributes, in the order of the Part 21 parameters."""
    return tuple(each.name for each in fields(cls) if each.metadata.get("express", True))


def values(instance: Entity) -> tuple[object, ...]:
    """Values of all fields, in field order."""
    return tuple(getattr(instance, name) for name in instance.__dataclass_fields__)
