"""Cutting of a bar by a turning insert: the lowest height over each cell, in closed form.

The insert is the region above a convex curve: the arc of its nose (for a blade, two corners and
the flat between them), and on each side a straight edge that rises at its angle without end.
Moved along a line or an arc, it reaches over a place z down to the minimum of
``x(s) + g(z − z(s))``, where g is the curve and (z, x)(s) the nose centre. On a line this
is convex in s, and the minimum lies where the slope of g equals that of the path, or at an end.
On an arc every stationary point is checked: the two ends, the nose on the circles of radius
R ± r, the flat, and either edge where it touches the path. The result is the exact lower
envelope of all positions of the insert.

A bore is cut as its mirror image: heights are negative radii. Units mm and rad.
"""

from math import acos, atan2, ceil, cos, floor, inf, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats

LEAST = 1e-9
"""Thickness, mm, below which material counts as rounding error and is not cut."""

BLOCK = 64
"""Number of cells per block whose greatest height is stored, so that blocks which an edge
does not touch are skipped quickly."""


class InsertOutline(NamedTuple):
    """Outline of an insert about the centre of its nose; upright edges have infinite slope."""

    nose: float
    """Nose radius, mm."""
    flat: float
    """Distance between the centres of the corners of a blade, mm."""
    back_slope: float
    """Slope of the edge towards −z."""
    back_foot: float
    """Distance before the centre at which the edge towards −z leaves the nose, mm."""
    front_slope: float
    """Slope of the edge towards +z."""
    front_foot: float
    """Distance behind the other corner's centre where the edge towards +z begins, mm."""


class AxialGrid(NamedTuple):
    """Cells along the axis, sampled in their middles."""

    start: float
    """Position z at which the first cell begins, mm."""
    cell: float
    """Length of a cell, mm."""


class NosePath(NamedTuple):
    """Line or arc along which the centre of the nose moves, mm and rad."""

    start_z: float
    start_x: float
    end_z: float
    end_x: float
    centre_z: float
    centre_x: float
    radius: float
    """Radius of the arc, mm; 0 for a line."""
    low: float
    """Smaller of the angles at the start and the end of the arc, rad."""
    span: float
    """Angle between the start and the end of the arc, rad."""


class RemovedAmounts(NamedTuple):
    """Area and volume that each of M paths removes."""

    areas: Floats
    """Area removed by each path in the ZX half plane, (M,), mm²."""
    volumes: Floats
    """Volume removed by each path, (M,), mm³."""


def carve(
    surface: Floats, bed: Floats, grid: AxialGrid, body: InsertOutline, ways: Floats
) -> tuple[Floats, Floats]:
    """Lower a surface to where an insert reaches.

    Parameters
    ----------
    surface : (C,) array, mm
        Heights over the cells; lowered in place.
    bed : (C,) array, mm
        Heights below which there is no material.
    ways : (M, 9) array
        Rows of :class:`NosePath`, one after another.

    Returns
    -------
    (M,) array, mm²
        Area that each path removes in the half plane.
    (M,) array, mm³
        Volume that each path removes.
    """
    areas, volumes = np.zeros(len(ways)), np.zeros(len(ways))
    tops = np.empty(ceil(len(surface) / BLOCK))
    _carve((surface, bed), grid, body, ways, tops, RemovedAmounts(areas, volumes))
    return areas, volumes


@entry
def _carve(
    bar: tuple[Floats, Floats],
    grid: AxialGrid,
    body: InsertOutline,
    ways: Floats,
    tops: Floats,
    taken: RemovedAmounts,
) -> None:
    """Kernel of :func:`carve`; ``tops`` holds the greatest height of each block."""
    (surface, bed), areas, volumes = bar, taken.areas, taken.volumes
    for block in range(len(tops)):
        tops[block] = _top(surface, block)
    tallest = -inf
    for top in tops:
        tallest = max(tallest, top)
    for row in range(len(ways)):
        w = ways[row]
        way = NosePath(w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8])
        low, high, least = _extent(way)
        low, high, least = low - body.nose, high + body.flat + body.nose, least - body.nose
        if least >= tallest:
            continue
        first = _cell(grid, low - _reach(tallest - least, body.back_slope), len(surface))
        last = _cell(grid, high + _reach(tallest - least, body.front_slope), len(surface))
        for block in range(first // BLOCK, last // BLOCK + 1):
            begin, end = max(first, block * BLOCK), min(last, block * BLOCK + BLOCK - 1)
            nearest = min(max(0.5 * (low + high), _middle(grid, begin)), _middle(grid, end))
            # Beside the path the edges only rise, so the nearest cell has the lowest height.
            is_beside = nearest < low or nearest > high
            if is_beside and _height(body, way, nearest) >= tops[block]:
                continue
            for index in range(begin, end + 1):
                reached = max(_height(body, way, _middle(grid, index)), bed[index])
                old = surface[index]
                if old - reached > LEAST:
                    surface[index] = reached
                    areas[row] += (old - reached) * grid.cell
                    volumes[row] += pi * abs(old * old - reached * reached) * grid.cell
            tops[block] = _top(surface, block)


def bore(
    surface: Floats, bed: Floats, grid: AxialGrid, profile: Floats, tips: Floats
) -> tuple[Floats, Floats]:
    """Lower a surface to where a rotating tool on the axis reaches.

    Parameters
    ----------
    surface, bed : (C,) array, mm
        As in :func:`carve`, for a bore: negative radii.
    profile : (3,) array
        Radius in mm, cotangent of half the point angle, corner radius in mm.
    tips : (M,) array, mm
        Lowest z of the tip in each stretch.

    Returns
    -------
    (M,) array, mm²
    (M,) array, mm³
        As in :func:`carve`.
    """
    areas, volumes = np.zeros(len(tips)), np.zeros(len(tips))
    _bore(surface, bed, grid, profile, tips, RemovedAmounts(areas, volumes))
    return areas, volumes


@entry
def _bore(
    surface: Floats,
    bed: Floats,
    grid: AxialGrid,
    profile: Floats,
    tips: Floats,
    taken: RemovedAmounts,
) -> None:
    """Kernel of :func:`bore`; the removed amounts are added to ``taken``."""
    areas, volumes = taken.areas, taken.volumes
    for row in range(len(tips)):
        for index in range(_cell(grid, tips[row], len(surface)), len(surface)):
            above = _middle(grid, index) - tips[row]
            if above <= 0.0:
                continue
            reached = max(-_radius(profile, above), bed[index])
            old = surface[index]
            if old - reached > LEAST:
                surface[index] = reached
                areas[row] += (old - reached) * grid.cell
                volumes[row] += pi * abs(old * old - reached * reached) * grid.cell


@kernel
def _radius(profile: Floats, above: float) -> float:
    """Radius of a rotating tool at a height above its tip, mm."""
    radius, cotangent, corner = profile[0], profile[1], profile[2]
    if cotangent > 0.0:
        return min(radius, above / cotangent)
    if above < corner:
        return radius - corner + sqrt(above * (2.0 * corner - above))
    return radius


@kernel
def _top(surface: Floats, block: int) -> float:
    """Greatest height of the surface within a block, mm."""
    top = -inf
    for index in range(block * BLOCK, min((block + 1) * BLOCK, len(surface))):
        top = max(top, surface[index])
    return top


@kernel
def _middle(grid: AxialGrid, index: int) -> float:
    """Position of the middle of a cell, mm."""
    return grid.start + (index + 0.5) * grid.cell


@kernel
def _cell(grid: AxialGrid, z: float, count: int) -> int:
    """Index of the cell at z, or of the nearest cell."""
    return int(min(max(floor((z - grid.start) / grid.cell), 0.0), count - 1.0))


@kernel
def _reach(height: float, slope: float) -> float:
    """Distance along the axis over which an edge rises by a height, mm."""
    return height / slope if slope > 0.0 else inf


@kernel
def _extent(way: NosePath) -> tuple[float, float, float]:
    """Lowest and highest z and lowest x of a path, mm."""
    low, high = min(way.start_z, way.end_z), max(way.start_z, way.end_z)
    least = min(way.start_x, way.end_x)
    if way.radius > 0.0:
        if _is_passed(way, pi):
            low = way.centre_z - way.radius
        if _is_passed(way, 0.0):
            high = way.centre_z + way.radius
        if _is_passed(way, -0.5 * pi):
            least = way.centre_x - way.radius
    return low, high, least


@kernel
def _is_passed(way: NosePath, angle: float) -> bool:
    """True if an arc contains an angle."""
    return bool((angle - way.low) % (2.0 * pi) <= way.span)


@kernel
def _height(body: InsertOutline, way: NosePath, z: float) -> float:
    """Lowest height that the insert reaches over a place, mm."""
    if way.radius > 0.0:
        return _height_of_arc(body, way, z)
    return _height_of_line(body, way, z)


@kernel
def _curve(body: InsertOutline, t: float) -> float:
    """Height of the insert's outline at an axial distance t from the centre of its nose, mm."""
    if t < -body.back_foot - LEAST:
        foot = -sqrt(max(0.0, body.nose**2 - body.back_foot**2))
        return foot + (-body.back_foot - t) * body.back_slope
    beyond = t - body.flat
    if beyond > body.front_foot + LEAST:
        foot = -sqrt(max(0.0, body.nose**2 - body.front_foot**2))
        return foot + (beyond - body.front_foot) * body.front_slope
    beside = t if t < 0.0 else max(beyond, 0.0)
    return -sqrt(max(0.0, body.nose**2 - beside**2))


@kernel
def _height_of_line(body: InsertOutline, way: NosePath, z: float) -> float:
    """Lowest height that the insert reaches over a place along a line, mm."""
    run, rise = way.end_z - way.start_z, way.end_x - way.start_x
    if run == 0.0:
        return min(way.start_x, way.end_x) + _curve(body, z - way.start_z)
    slope = rise / run
    # If the path is steeper than an edge, the lowest height lies at an end.
    if -slope >= body.back_slope:
        touch = -inf
    elif slope >= body.front_slope:
        touch = inf
    else:
        touch = body.nose * slope / sqrt(1.0 + slope * slope)
        if slope > 0.0:
            touch += body.flat
    part = (z - way.start_z - touch) / run
    if 0.0 < part < 1.0:
        return way.start_x + part * rise + _curve(body, touch)
    if part <= 0.0:
        return way.start_x + _curve(body, z - way.start_z)
    return way.end_x + _curve(body, z - way.end_z)


@kernel
def _height_of_arc(body: InsertOutline, way: NosePath, z: float) -> float:
    """Lowest height over a place along an arc: over all stationary points and both ends, mm."""
    least = min(
        way.start_x + _curve(body, z - way.start_z), way.end_x + _curve(body, z - way.end_z)
    )
    for offset in (0.0, body.flat):
        for size in (way.radius + body.nose, way.radius - body.nose):
            along = z - way.centre_z - offset
            if abs(along) < abs(size):
                angle = acos(along / size)
                least = min(least, _at(body, way, angle, z), _at(body, way, -angle, z))
    back = atan2(1.0, body.back_slope)
    front = atan2(-1.0, body.front_slope)
    for angle in (back, back + pi, front, front + pi, 0.5 * pi, -0.5 * pi):
        least = min(least, _at(body, way, angle, z))
    return least


@kernel
def _at(body: InsertOutline, way: NosePath, angle: float, z: float) -> float:
    """Height over a place with the nose at an angle of an arc, mm; infinite off the arc."""
    if not _is_passed(way, angle):
        return inf
    x = way.centre_x + way.radius * sin(angle)
    return x + _curve(body, z - way.centre_z - way.radius * cos(angle))
