"""Record of a collision with the stock. Units mm."""

from dataclasses import dataclass

MOST = 10_000
"""Largest number of collisions of one kind that a stock records."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """Rapid move through material, holder or shank in material, or tool standing in it."""

    block: int
    """Number of the program block that contains the move."""
    position: tuple[float, float, float]
    """Position of the collision, mm."""
    segment: int = 0
    """Row of the move in its list of segments."""
    depth: float = 0.0
    """Greatest depth of the collision, mm; 0 if not known."""
    volume: float = 0.0
    """Volume removed by the collision, mm³; 0 if not known."""
