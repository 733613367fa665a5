"""Difference between two remaining stocks, beyond what their maps resolve.

A map knows a wall to one cell: of two paths along the same wall, one may free a cell that the
other leaves, because its middle lies on the wall. So a place differs only where one surface
lies above or below all that the other has within the resolution of the map. Units mm.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from math import ceil, pi

import numpy as np

from simulator.motion.segments import Floats
from simulator.removal.lathe import BarRadii

SAME_HEIGHT = 1e-3
"""Distance of two surfaces that counts as none, mm: heights follow from the path, not from
the cells."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StockDifference:
    """Stock that is left, compared with another stock."""

    volume: float = 0.0
    """Volume that is left in addition, mm³; negative where less is left."""
    deviation: float = 0.0
    """Greatest distance of the surfaces beyond the resolution, mm; negative: less is left, 0:
    nothing differs."""

    @property
    def is_seen(self) -> bool:
        """True if the stocks differ beyond the resolution of their maps."""
        return self.deviation != 0.0

    @property
    def words(self) -> str:
        """The difference as part of a sentence: 'up to 0.8 mm more (3.7 cm³ more in all)'."""
        more = "more" if self.deviation > 0.0 else "less"
        whole = "more" if self.volume > 0.0 else "less"
        return (
            f"up to {abs(self.deviation):.3g} mm {more} "
            f"({abs(self.volume) * 1e-3:.3g} cm³ {whole} in all)"
        )


def height_difference(
    one: Floats, other: Floats, *, cells: tuple[float, float], within: float
) -> StockDifference:
    """Difference of one height map from another on the same cells.

    Parameters
    ----------
    one, other : (X, Y) arrays, mm
        Heights of the stock.
    cells : tuple of float, mm
        Sizes of a cell in x and y.
    within : float, mm
        Resolution in the plane; at least one cell.
    """
    reach = [_cells(within, size) for size in cells]
    volume = float((one - other).sum()) * cells[0] * cells[1]
    return StockDifference(volume=volume, deviation=_deviation(one, other, reach))


def bar_difference(
    one: BarRadii, other: BarRadii, *, cell: float, within: float
) -> StockDifference:
    """Difference of one turned bar from another on the same cells, which are ``cell`` long."""
    reach = [_cells(within, cell)]
    outside = _deviation(one.outer, other.outer, reach)
    # A wider bore leaves less.
    inside = -_deviation(one.inner, other.inner, reach)
    volume = pi * cell * float((_squares(one) - _squares(other)).sum())
    return StockDifference(volume=volume, deviation=max(outside, inside, key=abs))


def _squares(bar: BarRadii) -> Floats:
    """Cross section of a bar over π, mm²."""
    squares: Floats = bar.outer**2 - bar.inner**2
    return squares


def _cells(within: float, size: float) -> int:
    """Number of cells that a resolution spans, at least one."""
    return max(1, ceil(within / size - 1e-9))


def _deviation(one: Floats, other: Floats, reach: list[int]) -> float:
    """Greatest signed distance of two surfaces beyond the resolution; 0 if they are alike."""
    if not one.size or np.array_equal(one, other):
        return 0.0
    above = max(_beyond(one, other, reach), _beyond(-other, -one, reach))
    below = max(_beyond(other, one, reach), _beyond(-one, -other, reach))
    if max(above, below) <= SAME_HEIGHT:
        return 0.0
    return above if above >= below else -below


def _beyond(one: Floats, other: Floats, reach: list[int]) -> float:
    """Greatest height of one surface above all that the other has nearby."""
    return float((one - _highest(other, reach)).max())


def _highest(heights: Floats, reach: list[int]) -> Floats:
    """Greatest height within some cells along each axis, for every cell."""
    for axis, count in enumerate(reach):
        width = [(count, count) if each == axis else (0, 0) for each in range(heights.ndim)]
        padded = np.pad(heights, width, mode="edge")
        size = heights.shape[axis]
        shifted = [
            np.take(padded, range(first, first + size), axis=axis)
            for first in range(2 * count + 1)
        ]
        greater: Callable[[Floats, Floats], Floats] = np.maximum
        heights = reduce(greater, shifted)
    return heights
