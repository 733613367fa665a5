"""What a milling feature asks to be removed: walls and floor in the setup, level by level.

The walls of an area stand around it, the area on their left. A wall may lean, or run into the
floor with a radius, so the area shrinks with depth: each wall knows its inset at a height.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.contour import Chain, Loop
from stepnc_model.toolpath.cutter import Cutter
from stepnc_model.toolpath.offset import erode
from stepnc_model.units import rad_from_deg

SAMPLES = 24
"""heights at which a cutter that is not flat is held against a wall that is not straight"""

Inset = Callable[[float], float]
"""how far a wall stands in the area at a height above the floor, mm; 0 at the top"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """One boundary of an area, as it is at the top."""

    loop: Loop
    inset: Inset


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
    solid: Loop | None = None
    """the material of an area with open sides, without what the tool needs to run out"""
    outside: Chain = ()
    """edges of the walls that are none, beyond an open side"""
    dish: Callable[[float], Loop] | None = None
    """boundary of a round floor at a z"""

    @property
    def depth(self) -> float:
        """Mm"""
        return self.top - self.bottom

    def boundaries(self, z: float, cutter: Cutter) -> tuple[Loop, ...]:
        """Walls for a flat cutter of the same radius that has its tip at z."""
        loops: list[Loop] = []
        for wall in self.walls:
            inset = extra(wall.inset, cutter, bottom=z - self.bottom, top=self.depth)
            loops += erode([wall.loop], inset) if inset > 0.0 else (wall.loop,)
        if self.dish is not None:
            loops.append(self.dish(z))
        return tuple(loops)

    def between(self, top: float, bottom: float) -> "Area":
        """The same area from another height, down to another floor."""
        raised = bottom - self.bottom
        walls = tuple(
            Wall(loop=wall.loop, inset=_raised(wall.inset, raised)) for wall in self.walls
        )
        return replace(self, top=top, bottom=bottom, walls=walls)


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
    """mm to be removed beside it, where the feature says so"""

    @property
    def depth(self) -> float:
        """Mm"""
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


def rounding(height: float, radius: float) -> float:
    """Inset of a radius that is tangent to a straight wall above and to the floor."""
    if height >= radius:
        return 0.0
    return radius - sqrt(max(radius**2 - (radius - max(height, 0.0)) ** 2, 0.0))


def extra(inset: Inset, cutter: Cutter, *, bottom: float, top: float) -> float:
    """How much further than its radius a cutter must stay from a wall, mm.

    The largest sum of the wall's inset and the cutter's reach over the heights from its tip,
    ``bottom``, up to ``top``, less the radius.
    """
    if inset is upright and cutter.taper == 0.0:
        return 0.0
    span = max(top - bottom, 0.0)
    heights = [span * (index / SAMPLES) ** 2 for index in range(SAMPLES + 1)]
    heights.append(min(cutter.corner, span))
    most = max(inset(bottom + above) + cutter.reach(above) for above in heights)
    return max(0.0, most - cutter.radius)


def corners(loops: Sequence[Loop]) -> list[complex]:
    """Points where edges of loops meet."""
    return [edge.start for loop in loops for edge in loop]


def _raised(inset: Inset, by: float) -> Inset:
    """The same wall over a floor that lies higher."""
    if inset is upright or by == 0.0:
        return inset
    return lambda height: inset(height + by)
