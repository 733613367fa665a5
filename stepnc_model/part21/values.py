"""Parameter values of an ISO 10303-21 instance, as small immutable types.

A value keeps its text: a :class:`Real` remembers its characters, so that unchanged values are
written as they were read. ``$`` is ``None`` and a list is a ``tuple``.
"""

from dataclasses import dataclass
from typing import Generic, Self, TypeAlias, TypeVar

T_co = TypeVar("T_co", covariant=True)


class Ref(int, Generic[T_co]):
    """Reference ``#42`` to an instance; the type argument names the expected entity."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"#{int(self)}"

    __str__ = __repr__


class Real(float):
    """Real number that remembers its characters in the file.

    ``Real(0.5)`` has no characters of its own; the reader passes those found.
    """

    __slots__ = ("lexeme",)
    lexeme: str

    def __new__(cls, value: float, lexeme: str = "") -> Self:
        """Create a number with the characters it was read from."""
        real = super().__new__(cls, value)
        real.lexeme = lexeme
        return real


class Enumeration(str):
    """Enumeration value ``.CLIMB.`` without its dots; also ``.T.``, ``.F.`` and ``.U.``."""

    __slots__ = ()


class Binary(str):
    """Binary value ``"0A3F"`` without its quotes; its first digit counts unused bits."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Typed:
    """Value with an explicit type, such as ``LENGTH_MEASURE(0.01)``."""

    keyword: str
    value: "Value"


class Derived:
    """The value ``*``: an attribute that a subtype derives."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "*"


DERIVED = Derived()

Value: TypeAlias = (
    "Derived | Ref[object] | int | Real | str | Enumeration | Binary | Typed"
    " | tuple[Value, ...] | None"
)
"""Any parameter value; ``None`` is ``$``, and a plain ``str`` is a decoded string."""
