"""Parameter values of an ISO 10303-21 instance, as small immutable types.

A value keeps what the text said: a :class:`Real` remembers its lexeme, so writing what was
read gives the same characters. ``$`` is ``None`` and a list is a ``tuple``.
"""

from dataclasses import dataclass
from typing import Generic, Self, TypeAlias, TypeVar

T_co = TypeVar("T_co", covariant=True)


class Ref(int, Generic[T_co]):
    """Reference ``#42`` to an instance; the type argument names the entity expected there."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"#{int(self)}"

    __str__ = __repr__


class Real(float):
    """A real number that remembers its characters.

    ``Real(0.5)`` makes its own lexeme; the reader passes the one found.
    """

    __slots__ = ("lexeme",)
    lexeme: str

    def __new__(cls, value: float, lexeme: str = "") -> Self:
        """Keep the characters beside the value."""
        real = super().__new__(cls, value)
        real.lexeme = lexeme
        return real


class Enumeration(str):
    """``.CLIMB.`` without its dots; ``.T.``, ``.F.`` and ``.U.`` too."""

    __slots__ = ()


class Binary(str):
    """``"0A3F"`` without its quotes: first digit = number of unused bits."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Typed:
    """``LENGTH_MEASURE(0.01)``: a value with its type named."""

    keyword: str
    value: "Value"


class Derived:
    """``*``: an attribute that a subtype derives."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "*"


DERIVED = Derived()

Value: TypeAlias = (
    "Derived | Ref[object] | int | Real | str | Enumeration | Binary | Typed"
    " | tuple[Value, ...] | None"
)
"""``None`` is ``$``; a plain ``str`` is a decoded string."""
