"""Areas that a milling feature removes: walls and floor in the setup, level by level.

The walls of an area stand around it, the area on their left. A wall may lean, or run into the
floor with a radius, so the area shrinks with depth: each wall knows its inset at a height.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.milling.contour import TINY, Chain, Loop
from stepnc_model.toolpath.milling.offset import erode
from stepnc_model.toolpath.milling.strategy import EndMillShape
from stepnc_model.units import rad_from_deg

SAMPLES = 24
"""heights at which a cutter that is not flat is held against a wall that is not straight"""

THIRDS = 60
"""times that the place of the closest contact is narrowed to two thirds"""

Inset = Callable[[float], float]
"""how far a wall stands in the area at a height above the floor, mm; 0 at the top"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """One boundary of an area, as it is at the top."""

    loop: Loop
    inset: Inset
    top: float = inf
    """z in the setup; the cutter passes over an island that is lower than the area"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TeeSlotUndercut:
    """The wide part of a tee slot, at its floor."""

    width: float
    """Width, mm"""
    depth: float
    """Depth, mm, its height above the floor"""
    is_open: bool
    """at both ends"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """Area to be cleared down to a floor."""

    ref: Ref[Entity]
    """the feature"""
    walls: tuple[Wall, ...]
    top: float
    """z in the setup"""
    bottom: float
    face: Loop | None = None
    """a face without walls: what is to be swept, the tool running over its edge"""
    middle: Chain | None = None
    """centre line of a slot"""
    ends: tuple[float, float] = (0.0, 0.0)
    """how far the slot goes on beyond the ends of its centre line, mm"""
    rises: tuple[Inset, Inset] | None = None
    """how much of each end of a slot stands in it at a height above the floor, mm"""
    bar: TeeSlotUndercut | None = None
    """Bar of a tee slot"""
    solid: Loop | None = None
    """the material of an area with open sides, without what the tool needs to run out"""
    outside: Chain = ()
    """edges of the walls that are none, beyond an open side"""

    @property
    def depth(self) -> float:
        """From the top to the floor, mm."""
        return self.top - self.bottom

    def boundaries(self, z: float, cutter: EndMillShape) -> tuple[Loop, ...]:
        """Walls for a flat cutter of the same radius that has its tip at z.

        Empty where the walls leave no room, or where there are none.
        """
        loops: list[Loop] = []
        for wall in self.walls:
            if z > wall.top - TINY:
                continue
            top = min(self.top, wall.top) - self.bottom
            inset = extra(wall.inset, cutter, bottom=z - self.bottom, top=top)
            moved = erode([wall.loop], inset) if inset > 0.0 else (wall.loop,)
            if not moved:
                return ()
            loops += moved
        return tuple(loops)

    @property
    def terraces(self) -> list[float]:
        """Tops of the islands that the cutter passes over, the highest first."""
        return sorted({wall.top for wall in self.walls if wall.top < self.top}, reverse=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Flank:
    """Wall that is cut along, the free side on its left: outside profiles, bosses, steps."""

    ref: Ref[Entity]
    chain: Chain
    is_closed: bool
    inset: Inset
    top: float
    bottom: float
    width: float | None = None
    """Width, mm to be removed beside it, where the feature says so"""

    @property
    def depth(self) -> float:
        """From the top to the floor, mm."""
        return self.top - self.bottom


def upright(_height: float) -> float:
    """A wall that stands straight."""
    return 0.0


def leaning(*, depth: float, slope_deg: float | None, fillet: float = 0.0) -> Inset:
    """A wall that leans by an angle to the vertical and meets the floor in a radius."""
    slope = tan(rad_from_deg(slope_deg)) if slope_deg else 0.0
    if slope == 0.0 and fillet == 0.0:
        return upright

    def inset(height: float) -> float:
        return max(depth - height, 0.0) * slope + rounding(height, fillet)

    return inset


def chord(radius: float, height: float) -> float:
    """Half width of a circle at a height above its lowest point, up to its middle."""
    up = min(max(height, 0.0), radius)
    return sqrt(max(radius**2 - (radius - up) ** 2, 0.0))


def rounding(height: float, radius: float) -> float:
    """Inset of a radius that is tangent to a straight wall above and to the floor."""
    return radius - chord(radius, height)


def extra(inset: Inset, cutter: EndMillShape, *, bottom: float, top: float) -> float:
    """Distance beyond its radius that a cutter must keep from a wall, mm.

    The largest sum of the wall's inset and the cutter's reach over the heights from its tip,
    ``bottom``, up to ``top``, less the radius.
    """
    if inset is upright and cutter.taper == 0.0:
        return 0.0
    span = max(top - bottom, 0.0)
    heights = sorted(
        {span * (index / SAMPLES) ** 2 for index in range(SAMPLES + 1)}
        | {min(cutter.corner, span)}
    )

    def sum_at(above: float) -> float:
        return inset(bottom + above) + cutter.reach(above)

    sums = [sum_at(above) for above in heights]
    last, most = len(heights) - 1, max(sums)
    for at, own in enumerate(sums):
        # Fillet and corner may each make a peak; the greater one may lie between samples.
        low, high = max(at - 1, 0), min(at + 1, last)
        if own >= sums[low] and own >= sums[high]:
            most = max(most, _greatest(sum_at, heights[low], heights[high]))
    return max(0.0, most - cutter.radius)


def _greatest(function: Callable[[float], float], low: float, high: float) -> float:
    """Maximum of a function that rises and then falls, by thirds."""
    for _ in range(THIRDS):
        third = (high - low) / 3.0
        if function(low + third) < function(high - third):
            low += third
        else:
            high -= third
    return function(0.5 * (low + high))
