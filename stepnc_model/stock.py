"""The raw part before anything is cut. Units mm."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Stock:
    """Raw part in the coordinates of the setup: a box, or a bar about an axis along z."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    radius: float | None = None
    """mm, of a bar; its axis is in the middle of the box"""
