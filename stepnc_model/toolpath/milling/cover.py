"""Contour-parallel passes over an area: nested rings, and passes over what they leave uncut.

Rings are offsets of the wall. With a step above the cutter's radius they leave islands, in the
corners where ``s > R·(1 + sin(θ/2))`` and in the middle; these get extra passes, so that the
area is swept completely whatever the overlap is.

Areas that a milling feature removes: walls and floor in the setup, level by level.

The walls of an area surround it, with the area on their left. A wall may be inclined or meet
the floor with a radius, so the area shrinks with depth: each wall has an inset by height.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from math import inf, sqrt, tan

import shapely
from shapely import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.milling.contour import (
    REMEMBERED,
    TINY,
    Chain,
    Loop,
    area,
    line,
    rotated_to,
    shape,
    vertices,
)
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


@dataclass(frozen=True, slots=True)
class LeaningWall:
    """Inset of a wall that leans and meets the floor with a fillet; equal by its numbers."""

    depth: float
    slope: float
    """Tangent of the angle from the vertical."""
    fillet: float

    def __call__(self, height: float) -> float:
        """Inset at a height above the floor, mm."""
        return max(self.depth - height, 0.0) * self.slope + rounding(height, self.fillet)


def leaning(*, depth: float, slope_deg: float | None, fillet: float = 0.0) -> Inset:
    """Inset of a wall with a slope angle that meets the floor with a fillet radius."""
    slope = tan(rad_from_deg(slope_deg)) if slope_deg else 0.0
    if slope == 0.0 and fillet == 0.0:
        return upright
    return LeaningWall(depth=depth, slope=slope, fillet=fillet)


def chord(radius: float, height: float) -> float:
    """Half width of a circle at a height above its lowest point, up to its middle, mm."""
    up = min(max(height, 0.0), radius)
    return sqrt(max(radius**2 - (radius - up) ** 2, 0.0))


def rounding(height: float, radius: float) -> float:
    """Inset of a fillet that is tangent to a vertical wall and to the floor, mm."""
    return radius - chord(radius, height)


@lru_cache(maxsize=REMEMBERED)
def extra(inset: Inset, cutter: EndMillShape, *, bottom: float, top: float) -> float:
    """Distance beyond its radius that a cutter must keep from a wall, mm.

    The largest sum of the wall's inset and the cutter's reach over the heights from its tip,
    ``bottom``, up to ``top``, minus the radius. Remembered, as levels come again: in another
    number of passes the last one ends at the same floor.
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


CHORD = 2e-3
"""Chord tolerance where areas are compared as polygons, mm."""

NEGLIGIBLE = 2.0 * CHORD
"""Half thickness below which a remaining part is an error of the chords, mm."""

MOST_RINGS = 2000


@dataclass(frozen=True, slots=True)
class MillingPass:
    """Milling cut at constant depth: a loop, or a chain with two ends."""

    chain: Chain
    is_closed: bool

    def from_near(self, point: complex | None) -> "MillingPass":
        """Pass that starts nearest to a point, if it is a loop; else unchanged."""
        if point is None or not self.is_closed:
            return self
        return MillingPass(rotated_to(self.chain, point), is_closed=True)

    @property
    def start(self) -> complex:
        """First point of the pass."""
        return self.chain[0].start

    @property
    def end(self) -> complex:
        """Last point of the pass."""
        return self.chain[-1].end


@dataclass(slots=True)
class _Node:
    """Part of the area at one offset level, with the parts inside it."""

    polygon: Polygon
    loops: list[Loop]
    children: list["_Node"] = field(default_factory=list)


def rings(
    walls: Sequence[Loop], *, distance: float, radius: float, step: float
) -> tuple[MillingPass, ...]:
    """Contour-parallel passes that clear an area, from the inside out.

    Parameters
    ----------
    walls : sequence of Loop
        The area lies on the left of each wall.
    distance : float, mm
        Distance of the outermost passes from the walls.
    radius : float, mm
        Radius of the cutter.
    step : float, mm
        Distance between neighbouring passes.

    Returns
    -------
    tuple of MillingPass
        Outer passes counter-clockwise, passes around islands clockwise. Empty if the cutter
        does not fit.
    """
    return _rings(tuple(walls), distance, radius, step)


@lru_cache(maxsize=REMEMBERED)
def _rings(
    walls: tuple[Loop, ...], distance: float, radius: float, step: float
) -> tuple[MillingPass, ...]:
    """Contour-parallel passes, cached; implementation of ``rings``."""
    levels = list(_levels(walls, distance, step))
    if not levels:
        return ()
    nodes = _tree(levels)
    ordered = [
        MillingPass(loop, is_closed=True) for node in nodes for loop in _inside_out(node)
    ]
    if step <= radius * (1.0 + TINY):
        return tuple(ordered)
    between = (erode(walls, distance + (i + 0.5) * step) for i in range(len(levels)))
    extra = _uncut(levels, between, radius)
    return tuple(_interleaved(ordered, extra))


def swept(
    passes: Sequence[MillingPass], radius: float, *, tolerance: float = CHORD
) -> BaseGeometry:
    """Area swept by a cutter along passes, as polygons."""
    return shapely.union_all([
        LineString(_coordinates(each.chain, tolerance)).buffer(radius, quad_segs=32)
        for each in passes
    ])


def area_of(loops: Sequence[Loop], *, tolerance: float = CHORD) -> BaseGeometry:
    """Area bounded by rings, as polygons: outer rings minus clockwise ones."""
    outer = [shape(loop, tolerance=tolerance) for loop in loops if area(loop) > 0.0]
    holes = [shape(loop, tolerance=tolerance) for loop in loops if area(loop) <= 0.0]
    return shapely.difference(shapely.union_all(outer), shapely.union_all(holes))


def _levels(walls: Sequence[Loop], distance: float, step: float) -> Iterator[tuple[Loop, ...]]:
    """Rings at growing distance from the walls, until there is no room."""
    for index in range(MOST_RINGS):
        loops = erode(walls, distance + index * step)
        if not loops:
            return
        yield loops
    raise ValueError(
        f"steps of {step:g} mm need more than {MOST_RINGS} rings: increase the step"
    )


def _tree(levels: Sequence[tuple[Loop, ...]]) -> list[_Node]:
    """Tree of the area's parts, each with its parts at the next offset level."""
    roots: list[_Node] = []
    above: list[_Node] = []
    for loops in levels:
        nodes = _nodes(loops)
        for node in nodes:
            if not above:
                roots.append(node)
                continue
            inside = node.polygon.representative_point()
            parent = min(above, key=lambda other: other.polygon.distance(inside))
            parent.children.append(node)
        above = nodes
    return roots


def _nodes(loops: Sequence[Loop]) -> list[_Node]:
    """Outer rings of one level, each with the rings around islands within it."""
    nodes = [
        _Node(_valid(shape(loop, tolerance=0.1)), [loop]) for loop in loops if area(loop) > 0.0
    ]
    for loop in loops:
        if area(loop) <= 0.0 and nodes:
            at = shapely.Point(loop[0].start.real, loop[0].start.imag)
            node = min(nodes, key=lambda other: other.polygon.distance(at))
            node.loops.append(loop)
    return nodes


def _valid(polygon: Polygon) -> Polygon:
    """Polygon repaired where coarse chords make it touch itself."""
    if polygon.is_valid:
        return polygon
    mended = polygon.buffer(0.0)
    if isinstance(mended, MultiPolygon):
        mended = max(mended.geoms, key=lambda part: part.area)
    return mended if not mended.is_empty else polygon.convex_hull


def _inside_out(node: _Node) -> Iterator[Loop]:
    """Loops of a part, after those of its inner parts; without recursion."""
    stack, found = [node], []
    while stack:
        top = stack.pop()
        found.append(top)
        stack.extend(top.children)
    for each in reversed(found):
        yield from reversed(each.loops)


def _uncut(
    levels: Sequence[tuple[Loop, ...]],
    between: Iterable[tuple[Loop, ...]],
    radius: float,
) -> list[MillingPass]:
    """Passes through what the rings leave: rings half way between levels, then strokes."""
    passes = [MillingPass(loop, is_closed=True) for loops in levels for loop in loops]
    left = _parts(area_of(levels[0]).difference(swept(passes, radius)))
    found: list[MillingPass] = []
    if not left:
        return found
    for loop in (loop for loops in between for loop in loops):
        trace = LineString(_coordinates(loop, CHORD))
        if any(trace.intersects(part) for part in left):
            reached = trace.buffer(radius, quad_segs=32)
            whole = [part for part in left if reached.covers(part)]
            # An extra ring is worth it only if at least half of it runs through what is left.
            if sum(part.length for part in whole) >= 0.5 * trace.length:
                found.append(MillingPass(loop, is_closed=True))
                left = [part for part in left if not reached.covers(part)]
    for part in left:
        found += _through(part, radius)
    return found


def _through(part: Polygon, radius: float) -> list[MillingPass]:
    """Stroke through a remaining part, or else passes along its edge and within it."""
    stroke = _axis(part)
    if stroke is not None and stroke.buffer(radius * 0.999).covers(part):
        (x0, y0), (x1, y1) = stroke.coords
        return [MillingPass((line(complex(x0, y0), complex(x1, y1)),), is_closed=False)]
    found: list[MillingPass] = []
    stack = [part]
    while stack:
        piece = stack.pop()
        # Anything within a radius of the path is cut: it need not follow the edge exactly.
        ring = piece.exterior.simplify(0.5 * radius)
        points = [complex(x, y) for x, y in ring.coords]
        edges = tuple(line(a, b) for a, b in pairwise(points) if abs(a - b) > TINY)
        if not edges:
            continue
        found.append(MillingPass(edges, is_closed=True))
        stack += _parts(piece.difference(ring.buffer(radius * 0.97)))
    return found


def _axis(part: Polygon) -> LineString | None:
    """Longest axis of the narrowest box around a part, clipped to the part; or None."""
    box = part.minimum_rotated_rectangle
    if not isinstance(box, Polygon):
        return None
    corners = [complex(x, y) for x, y in box.exterior.coords][:4]
    if len(corners) < 4:
        return None
    if abs(corners[1] - corners[0]) > abs(corners[2] - corners[1]):
        corners = [*corners[1:], corners[0]]
    ends = [0.5 * (corners[0] + corners[1]), 0.5 * (corners[2] + corners[3])]
    if abs(ends[0] - ends[1]) < CHORD:
        return None
    axis = LineString([(end.real, end.imag) for end in ends])
    inner = axis.intersection(part)
    if isinstance(inner, LineString) and inner.length > CHORD:
        start, end = inner.coords[0], inner.coords[-1]
        return LineString([start, end])
    return None


def _interleaved(ordered: list[MillingPass], extra: list[MillingPass]) -> Iterator[MillingPass]:
    """Insert each extra pass after the ring that runs closest to it."""
    if not extra:
        yield from ordered
        return
    traces = [LineString(_coordinates(each.chain, 0.1)) for each in ordered]
    places: dict[int, list[MillingPass]] = {}
    for each in extra:
        trace = LineString(_coordinates(each.chain, 0.1))
        gaps = [trace.distance(other) for other in traces]
        places.setdefault(gaps.index(min(gaps, default=inf)), []).append(each)
    for index, each in enumerate(ordered):
        yield each
        yield from places.get(index, ())


def _parts(geometry: BaseGeometry) -> list[Polygon]:
    """Polygons of a geometry that are large enough for a pass."""
    parts = shapely.get_parts(geometry).tolist()
    return [
        part
        for part in parts
        if isinstance(part, Polygon) and not part.buffer(-NEGLIGIBLE).is_empty
    ]


def _coordinates(chain: Chain, tolerance: float) -> list[tuple[float, float]]:
    """Points of a chain including its last end, as coordinate pairs for shapely."""
    points = [*vertices(chain, tolerance=tolerance), chain[-1].end]
    return [(point.real, point.imag) for point in points]
