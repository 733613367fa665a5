"""Areas that a milling feature removes: walls and floor in the setup, level by level.

The walls of an area surround it, with the area on their left. A wall may be inclined or meet
the floor with a radius, so the area shrinks with depth: each wall has an inset by height.
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

SAMPLES = 40
"""Number of heights at which a non-flat cutter is compared with a non-straight wall."""

ROUNDS = 9
"""Number of times that the heights around the closest contact are sampled again."""

Inset = Callable[[float], float]
"""Inset of a wall at a height above the floor, mm; 0 at the top."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """Boundary of a milling area, with its outline at the top."""

    loop: Loop
    inset: Inset
    top: float = inf
    """Top z in the setup, mm; the cutter passes over an island lower than the area."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TeeSlotUndercut:
    """Wide part of a tee slot at its floor."""

    width: float
    """Width of the undercut, mm."""
    depth: float
    """Height of the undercut above the floor, mm."""
    is_open: bool
    """Whether the slot is open at both ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """Area to be cleared down to a floor."""

    ref: Ref[Entity]
    """Feature that the area belongs to."""
    walls: tuple[Wall, ...]
    top: float
    """Top z of the area in the setup, mm."""
    bottom: float
    face: Loop | None = None
    """Face without walls, to be swept with the tool running over its edge."""
    middle: Chain | None = None
    """Centre line of a slot."""
    ends: tuple[float, float] = (0.0, 0.0)
    """Extension of the slot beyond each end of its centre line, mm."""
    rises: tuple[Inset, Inset] | None = None
    """Inset of each slot end by height above the floor, mm."""
    bar: TeeSlotUndercut | None = None
    """Undercut of a tee slot."""
    solid: Loop | None = None
    """Material of an area with open sides, without the room for the tool to run out."""
    outside: Chain = ()
    """Boundary edges beyond an open side, where there is no wall."""

    @property
    def depth(self) -> float:
        """Depth from the top to the floor, mm."""
        return self.top - self.bottom

    def boundaries(self, z: float, cutter: EndMillShape) -> tuple[Loop, ...]:
        """Wall outlines for a flat cutter of the same radius with its tip at z.

        Empty where the walls leave no room, or where there are no walls.
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
        """Tops z of the islands that the cutter passes over, the highest first, mm."""
        return sorted({wall.top for wall in self.walls if wall.top < self.top}, reverse=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Flank:
    """Wall that is milled along, with the free side on its left: profiles, bosses, steps."""

    ref: Ref[Entity]
    chain: Chain
    is_closed: bool
    inset: Inset
    top: float
    bottom: float
    width: float | None = None
    """Width to be removed beside the wall, mm, where the feature gives it."""

    @property
    def depth(self) -> float:
        """Depth from the top to the floor, mm."""
        return self.top - self.bottom


def upright(_height: float) -> float:
    """Inset of a vertical wall: zero at every height."""
    return 0.0


def leaning(*, depth: float, slope_deg: float | None, fillet: float = 0.0) -> Inset:
    """Inset of a wall with a slope angle that meets the floor with a fillet radius."""
    slope = tan(rad_from_deg(slope_deg)) if slope_deg else 0.0
    if slope == 0.0 and fillet == 0.0:
        return upright

    def inset(height: float) -> float:
        return max(depth - height, 0.0) * slope + rounding(height, fillet)

    return inset


def chord(radius: float, height: float) -> float:
    """Half width of a circle at a height above its lowest point, up to its middle, mm."""
    up = min(max(height, 0.0), radius)
    return sqrt(max(radius**2 - (radius - up) ** 2, 0.0))


def rounding(height: float, radius: float) -> float:
    """Inset of a fillet that is tangent to a vertical wall and to the floor, mm."""
    return radius - chord(radius, height)


def extra(inset: Inset, cutter: EndMillShape, *, bottom: float, top: float) -> float:
    """Distance beyond its radius that a cutter must keep from a wall, mm.

    The largest sum of the wall's inset and the cutter's reach over the heights from its tip,
    ``bottom``, up to ``top``, minus the radius.
    """
    if inset is upright and cutter.taper == 0.0:
        return 0.0
    span = max(top - bottom, 0.0)
    shares = [index / SAMPLES for index in range(SAMPLES + 1)]
    round_end = min(cutter.corner, span)
    # Closely at the tip, and where the corner's round ends.
    heights = sorted({
        *(span * share**power for share in shares for power in (2, 4)),
        *(round_end * (1.0 - share**2) for share in shares),
    })

    def sum_at(above: float) -> float:
        return inset(bottom + above) + cutter.reach(above)

    sums = [sum_at(above) for above in heights]
    last, most = len(heights) - 1, max(sums)
    for at, own in enumerate(sums):
        # Fillet, corner and top may each make a peak; the greatest may lie between samples.
        low, high = max(at - 1, 0), min(at + 1, last)
        # Where a side runs along a wall the sum is level, and there is nothing to look for.
        is_level = own == sums[low] == sums[high]
        if own >= sums[low] and own >= sums[high] and not is_level:
            most = max(most, _greatest(sum_at, heights[low], heights[high]))
    return max(0.0, most - cutter.radius)


def _greatest(function: Callable[[float], float], low: float, high: float) -> float:
    """Maximum of a function in an interval, which is sampled ever more closely around it."""
    for _ in range(ROUNDS):
        places = [low + (high - low) * at / SAMPLES for at in range(SAMPLES + 1)]
        values = [function(place) for place in places]
        index = values.index(max(values))
        low, high = places[max(index - 1, 0)], places[min(index + 1, SAMPLES)]
    return max(values)
