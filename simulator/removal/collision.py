"""Collisions with the stock. Units mm."""

from dataclasses import dataclass

MOST = 10_000
"""of one kind that a stock remembers"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """A rapid through material, a holder or shank in it, or a tool that stood in it."""

    block: int
    """from which the move comes"""
    position: tuple[float, float, float]
    """Position, mm, where"""
    segment: int = 0
    """row in its stretch"""
    depth: float = 0.0
    """Depth, mm, deepest; 0: not told"""
    volume: float = 0.0
    """Volume, mm³ removed; 0: not told"""
