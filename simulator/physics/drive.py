"""From the mechanical to the electrical power of a drive, and numbers that may be arrays.

Functions that take a :class:`FloatOrArray` consist of arithmetic alone and serve a float as
well as an array of any library; several arrays broadcast. Power in W.
"""

from typing import Any, Protocol, TypeVar


class FloatOrArray(Protocol):
    """A float or an array of floats."""

    def __abs__(self) -> Any: ...
    def __add__(self, other: Any, /) -> Any: ...
    def __radd__(self, other: Any, /) -> Any: ...
    def __sub__(self, other: Any, /) -> Any: ...
    def __mul__(self, other: Any, /) -> Any: ...
    def __rmul__(self, other: Any, /) -> Any: ...
    def __truediv__(self, other: Any, /) -> Any: ...
    def __pow__(self, other: Any, /) -> Any: ...
    def __gt__(self, other: Any, /) -> Any: ...
    def __lt__(self, other: Any, /) -> Any: ...


Value = TypeVar("Value", bound=FloatOrArray)


def positive_part(value: Value) -> Value:
    """``max(x, 0)`` of a float or of every element."""
    part: Value = 0.5 * (value + abs(value))
    return part


def electrical_power(mechanical: Value, *, efficiency: float, regeneration: float) -> Value:
    """Power that a motor draws from the mains.

    ``P = P_mech/η`` when it drives; when it brakes, ``η_reg·P_mech``: a share returns, the rest
    is burnt in a resistor. Dividing by η there too would return more than there is.

    Parameters
    ----------
    mechanical : float or array, W
        At the motor's shaft, negative when braking.
    efficiency : float
        η, 0 < η ≤ 1.
    regeneration : float
        η_reg, 0 ≤ η_reg ≤ 1.

    Returns
    -------
    float or array, W

    Examples
    --------
    >>> electrical_power(93.0, efficiency=0.93, regeneration=0.0)
    100.0
    >>> electrical_power(-100.0, efficiency=0.93, regeneration=0.6)
    -60.0
    """
    driving = positive_part(mechanical)
    power: Value = driving / efficiency + regeneration * (mechanical - driving)
    return power
