"""Conversion of mechanical to electrical power of a drive, and a type for floats and arrays.

Functions that take a :class:`FloatOrArray` use arithmetic only and accept a float as well as an
array of any library; several arrays broadcast. Power in W.
"""

from typing import Any, Protocol, TypeVar


class FloatOrArray(Protocol):
    """Float or array of floats."""

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
    """Positive part ``max(x, 0)`` of a float or of every element."""
    part: Value = 0.5 * (value + abs(value))
    return part


def electrical_power(mechanical: Value, *, efficiency: float, regeneration: float) -> Value:
    """Electrical power that a motor draws from the mains.

    ``P = P_mech/η`` when driving; ``η_reg·P_mech`` when braking: a share is fed back, the rest
    is dissipated in a resistor. Dividing by η in this case would return more than is available.

    Parameters
    ----------
    mechanical : float or array, W
        Power at the motor shaft, negative when braking.
    efficiency : float
        Efficiency η, 0 < η ≤ 1.
    regeneration : float
        Regenerated share η_reg, 0 ≤ η_reg ≤ 1.

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
