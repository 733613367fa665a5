"""Cutting of a height map by a rotating cutter: the lowest height reached over each cell.

Over a cell at the distance u along a line and v beside it, the tool reaches down to the minimum
of ``z(s) + f(√((u − s)² + v²))``, where f is the profile. f is convex and never falls, so this
is convex in s. Level lines use the nearest point; flat and ball tools have a closed form on any
slope; Newton's method finds where the corner of a bull-nose touches last; for cones, tapers and
places beside the flat it is a bisection along the line, to 1e-4 mm. On level arcs the nearest
point decides as well, and a flat tool on a helix has a closed form. All other cases
(arcs out of XY; ball, bull-nose, cone and taper on a helix) are cut along chords that deviate
from the arc by at most ``CHORD_SHARE`` of a cell. Units mm and rad.
"""

from math import ceil, floor, hypot, inf, sqrt
from typing import NamedTuple

from simulator.kernels.kernel import kernel
from simulator.motion.segments import Floats
from simulator.removal.cutter import CutterProfile, is_plain, rise, steepness
from simulator.removal.tip_move import (
    LEAST,
    LEVEL,
    TipMove,
    arc_distance,
    bounds,
    helix_height,
    is_abreast,
    place,
    way_between,
)
from simulator.removal.zmap import HeightGrid

CHORD_SHARE = 0.01
"""Greatest deviation of chords from an arc without a closed form, as a share of a cell."""

UNDER = 1.0 - 1e-9
"""Share of the flat's radius of which rounding leaves no doubt that a cell lies under it."""

MEASURE = -1
"""Move number that requests measuring only: no cell is cut."""

_NUDGE = 1e-7
"""Offset, mm, at which cells are sampled beside their middles, so that of the two walls of a
slot that run through cell middles only one removes its cells."""

_PLACE = 1e-4
"""Tolerance, mm, of the position of the contact point found by bisection; the error of the
height is its square over the corner radius."""

_SETTLED = 1e-5
"""Error, mm, of the distance of a contact from the axis that is small enough; that of the
height is about its square over the corner radius."""

_REPETITIONS = 8


@kernel
def carve_part(
    grid: HeightGrid,
    profile: CutterProfile,
    row: Floats,
    span: tuple[float, float],
    number: int,
    goes_on: bool,
) -> tuple[float, float, float, float]:
    """Lower the cells under a part of a row, at most a quarter turn of an arc.

    Parameters
    ----------
    grid : HeightGrid
        Changed, unless the number is ``MEASURE``.
    row : (13,) array
    span : (float, float)
        Begin and end of the part, as shares of the row's length.
    number : int
        Number of the move, stored in the cells that it cuts.
    goes_on : bool
        Whether the tool has just cut where the part begins, so that its first position
        needs no check.

    Returns
    -------
    volume : float, mm³
    deepest : float, mm
        Greatest height that a cell loses.
    x, y : float, mm
        Position of the cell that loses most.
    """
    way = way_between(row, span[0], span[1])
    if row[11] == 0.0:
        return _line(grid, profile, way, number, goes_on)
    level = abs(way.end_z - way.z) <= LEVEL
    if row[12] == 2.0 and (level or is_plain(profile)):
        return _arc(grid, profile, way, number)
    sagitta = CHORD_SHARE * max(grid.dx, grid.dy)
    turn = abs(row[11]) * (span[1] - span[0])
    chords = max(1, ceil(turn * sqrt(row[9] / (8.0 * sagitta))))
    step = (span[1] - span[0]) / chords
    volume, deepest, x, y = 0.0, 0.0, way.x, way.y
    for index in range(chords):
        begin = span[0] + index * step
        start, stop = place(row, begin), place(row, begin + step)
        chord = TipMove(
            start[0], start[1], start[2], stop[0], stop[1], stop[2], 0.0, 0.0, 0.0, 0.0, 0.0
        )
        lost, depth, at_x, at_y = _line(grid, profile, chord, number, goes_on or index > 0)
        volume += lost
        if depth > deepest:
            deepest, x, y = depth, at_x, at_y
    return volume, deepest, x, y


@kernel
def _range(low: float, high: float, origin: float, size: float, count: int) -> tuple[int, int]:
    """Range of the cells whose middles lie between two coordinates: first, last + 1."""
    if low > high:
        return 0, 0
    first = ceil((low - origin - _NUDGE) / size - 0.5)
    last = floor((high - origin - _NUDGE) / size - 0.5)
    return max(first, 0), min(last + 1, count)


class _Line(NamedTuple):
    """A straight move prepared for cutting cells: direction, length and slope."""

    way: TipMove
    along_x: float
    along_y: float
    """Y component of the unit vector of the move in the XY plane."""
    length: float
    """Length of the move in the XY plane, mm."""
    slope: float
    low: float
    """Height of the lower end of the move, mm."""
    fresh: float
    """Distance along the line, mm, behind which the earlier cut at the start is final."""
    skips_start: bool
    """Whether nothing under the tool at the start is left to cut."""


@kernel
def _line(
    grid: HeightGrid, profile: CutterProfile, way: TipMove, number: int, goes_on: bool
) -> tuple[float, float, float, float]:
    """Cut the cells along a straight move of any direction."""
    line = _lined(profile, way, goes_on)
    heights = grid.heights
    volume, deepest, found_x, found_y = 0.0, 0.0, way.x, way.y
    low, high = min(way.x, way.end_x) - profile.radius, max(way.x, way.end_x) + profile.radius
    first, last = _range(low, high, grid.x, grid.dx, heights.shape[0])
    if line.low >= grid.top:
        return volume, deepest, found_x, found_y
    for column in range(first, last):
        x = grid.x + (column + 0.5) * grid.dx + _NUDGE
        low, high = _outline(line, profile.radius, x)
        begin, end = _range(low, high, grid.y, grid.dy, heights.shape[1])
        low, high = _under_flat(line, profile, x)
        under, above = _range(low, high, grid.y, grid.dy, heights.shape[1])
        done, undone = end, end
        if line.skips_start:
            half = sqrt(max(profile.radius**2 - (x - way.x) ** 2, 0.0))
            done, undone = _range(way.y - half, way.y + half, grid.y, grid.dy, heights.shape[1])
        for row in range(begin, end):
            height = heights[column, row]
            if height <= line.low or done <= row < undone:
                continue
            y = grid.y + (row + 0.5) * grid.dy + _NUDGE
            new = line.low
            if row < under or row >= above:
                new = _over(line, profile, x, y, height)
            new = max(new, grid.bottom)
            lost = height - new
            if lost > LEAST:
                volume += lost
                if lost > deepest:
                    deepest, found_x, found_y = lost, x, y
                if number >= 0:
                    heights[column, row] = new
                    grid.owner[column, row] = number
    return volume * grid.dx * grid.dy, deepest, found_x, found_y


@kernel
def _lined(profile: CutterProfile, way: TipMove, goes_on: bool) -> _Line:
    """Prepare a straight move for cutting: direction, slope and start of uncut cells."""
    length = hypot(way.end_x - way.x, way.end_y - way.y)
    climb = way.end_z - way.z
    low = min(way.z, way.end_z)
    skips = goes_on and is_plain(profile) and climb >= -LEVEL
    if length <= LEAST:
        return _Line(way, 1.0, 0.0, 0.0, 0.0, low, -inf, skips)
    along_x, along_y = (way.end_x - way.x) / length, (way.end_y - way.y) / length
    slope = climb / length if abs(climb) > LEVEL else 0.0
    fresh = _fresh(profile, slope) if goes_on else -inf
    return _Line(way, along_x, along_y, length, slope, low, fresh, skips)


@kernel
def _over(line: _Line, profile: CutterProfile, x: float, y: float, height: float) -> float:
    """Lowest height that the tool reaches over a cell, mm; infinite if not below its top."""
    if line.slope == 0.0 and is_plain(profile):
        return line.low
    x, y = x - line.way.x, y - line.way.y
    u = x * line.along_x + y * line.along_y
    v = y * line.along_x - x * line.along_y
    beyond = u - min(max(u, 0.0), line.length)
    square = beyond * beyond + v * v
    if square > profile.radius**2:
        return inf
    if line.slope == 0.0:
        return line.low + rise(profile, sqrt(square))
    if profile.slope == 0.0 and 0.0 < profile.corner < profile.radius:
        if line.slope < 0.0:
            return line.way.z + corner_lowest(profile, u, v, line.length, -line.slope)
        return line.way.end_z + corner_lowest(
            profile, line.length - u, v, line.length, line.slope
        )
    # The nearest point of the path at its lowest height gives a lower bound for any tool.
    least = line.low + rise(profile, sqrt(square))
    if height - least <= LEAST:
        return least
    return line.way.z + lowest(profile, u, v, line.length, line.slope)


@kernel
def _fresh(profile: CutterProfile, slope: float) -> float:
    """Distance along a line from which its cells may still need cutting, mm.

    A level or climbing tool has finished everything behind its axis; a descending ball touches
    behind its axis no farther than where its surface is as steep as the line.
    """
    if slope >= 0.0:
        return 0.0
    if profile.flat == 0.0 and profile.corner == profile.radius:
        return profile.radius * slope / sqrt(1.0 + slope * slope)
    return -profile.radius


@kernel
def _under_flat(line: _Line, profile: CutterProfile, x: float) -> tuple[float, float]:
    """Lowest and highest y at which the flat passes over a column at the lowest height, mm."""
    if profile.slope > 0.0:
        return inf, -inf
    reach = UNDER * profile.flat
    if line.slope == 0.0:
        return _outline(line, reach, x)
    low_x, low_y = line.way.x, line.way.y
    if line.slope < 0.0:
        low_x, low_y = line.way.end_x, line.way.end_y
    square = reach * reach - (x - low_x) ** 2
    if square < 0.0:
        return inf, -inf
    half = sqrt(square)
    return low_y - half, low_y + half


@kernel
def _outline(line: _Line, reach: float, x: float) -> tuple[float, float]:
    """Lowest and highest y at which a column of cells crosses the sweep of a line, mm."""
    way, low, high = line.way, inf, -inf
    for end_x, end_y in ((way.x, way.y), (way.end_x, way.end_y)):
        square = reach * reach - (x - end_x) ** 2
        if square > 0.0:
            half = sqrt(square)
            low, high = min(low, end_y - half), max(high, end_y + half)
    if line.along_x != 0.0:
        for side in (-reach, reach):
            part = (x - way.x + side * line.along_y) / line.along_x
            if 0.0 <= part <= line.length:
                y = way.y + side * line.along_x + part * line.along_y
                low, high = min(low, y), max(high, y)
    least = line.fresh - (x - way.x) * line.along_x
    if line.along_y > LEAST:
        return max(low, way.y + least / line.along_y - LEAST), high
    if line.along_y < -LEAST:
        return low, min(high, way.y + least / line.along_y + LEAST)
    return (low, high) if least <= LEAST else (inf, -inf)


@kernel
def lowest(profile: CutterProfile, u: float, v: float, length: float, slope: float) -> float:
    """Lowest height of the tool over a cell, relative to the start of a sloping line.

    Parameters
    ----------
    u, v : float, mm
        Position of the cell along the line and beside it, in the plane.
    length : float, mm
        Length of the line in the plane.
    slope : float
        Rise of the line per mm in the plane, not 0.

    Returns
    -------
    float, mm
        Infinite outside the sweep of the line.
    """
    square = profile.radius**2 - v * v
    if square < 0.0:
        return inf
    half = sqrt(square)
    low, high = max(-u, -half), min(length - u, half)
    if low > high:
        return inf
    if is_plain(profile):
        return slope * (u + (low if slope > 0.0 else high))
    if profile.flat == 0.0 and profile.corner == profile.radius:
        best = min(max(-slope * half / sqrt(1.0 + slope * slope), low), high)
        return slope * (u + best) + profile.radius - sqrt(max(square - best * best, 0.0))
    touch = _bisected(profile, v, slope, low, high)
    distance = min(sqrt(touch * touch + v * v), profile.radius)
    return slope * (u + touch) + rise(profile, distance)


@kernel
def corner_lowest(
    profile: CutterProfile, u: float, v: float, length: float, fall: float
) -> float:
    """Lowest height over a cell of a flat tool with a corner, relative to the higher end.

    Parameters
    ----------
    u, v : float, mm
        Position of the cell in the sweep: along the line from its higher end, and beside it.
    length : float, mm
        Length of the line in the plane.
    fall : float
        Fall of the line per mm in the plane, positive.

    Returns
    -------
    float, mm
    """
    flat, ahead = profile.flat, length - u
    square = ahead * ahead + v * v
    if ahead <= 0.0 or square <= flat * flat:
        # The corner has not passed: the cell touches the tool at the lower end.
        return rise(profile, sqrt(square)) - fall * length
    if u < 0.0:
        distance = sqrt(u * u + v * v)
        over = distance - flat
        if over > 0.0:
            lean = fall * distance
            if (over * u) ** 2 >= lean * lean * (profile.corner**2 - over * over):
                # The tool moves away from the cell faster than it descends.
                return rise(profile, distance)
    if abs(v) < flat:
        distance = corner_contact(profile, v, fall)
        if distance < profile.tangent:
            touch = sqrt(distance * distance - v * v)
            if touch <= ahead:
                return rise(profile, distance) - fall * (u + touch)
            return rise(profile, sqrt(square)) - fall * length
    half = sqrt(max(profile.radius**2 - v * v, 0.0))
    touch = _bisected(profile, v, -fall, max(-u, 0.0), min(ahead, half))
    return rise(profile, sqrt(touch * touch + v * v)) - fall * (u + touch)


@kernel
def corner_contact(profile: CutterProfile, v: float, fall: float) -> float:
    """Distance from the axis at which the corner of a descending tool touches a cell last, mm.

    It is the root of ``flat + corner·s·d/√(d²·(1 + s²) − v²) − d`` with s = fall, which is
    convex and falls: Newton's method from the edge of the flat stays below the root.

    Parameters
    ----------
    v : float, mm
        Distance of the cell from the line, less than that of the edge of the flat.
    fall : float
        Fall of the line per mm in the plane, positive.
    """
    flat, lean, square = profile.flat, profile.corner * fall, v * v
    tilt = 1.0 + fall * fall
    distance = flat
    for _ in range(_REPETITIONS):
        inverse = 1.0 / sqrt(distance * distance * tilt - square)
        bend = lean * square * inverse**3
        change = (flat - distance + lean * distance * inverse) / (1.0 + bend)
        error = 1.5 * bend * distance * tilt * (inverse * change) ** 2
        distance += change
        if error <= _SETTLED:
            return distance
    return distance


@kernel
def _bisected(profile: CutterProfile, v: float, slope: float, low: float, high: float) -> float:
    """Position between two others at which a tool on a slope is lowest over a cell, mm."""
    while high - low > _PLACE:
        middle = 0.5 * (low + high)
        distance = max(sqrt(middle * middle + v * v), LEAST)
        if slope + steepness(profile, distance) * middle / distance > 0.0:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


@kernel
def _arc(
    grid: HeightGrid, profile: CutterProfile, way: TipMove, number: int
) -> tuple[float, float, float, float]:
    """Cut along an arc in XY of at most half a turn: level, or a helix of a flat tool."""
    floor_z = min(way.z, way.end_z)
    if floor_z >= grid.top:
        return 0.0, 0.0, way.x, way.y
    level = abs(way.end_z - way.z) <= LEVEL
    reach, outer = profile.radius, way.radius + profile.radius
    inner = max(way.radius - profile.radius, 0.0)
    flat = UNDER * profile.flat if profile.slope == 0.0 else 0.0
    near, far = max(way.radius - flat, 0.0) ** 2, (way.radius + flat) ** 2
    heights = grid.heights
    volume, deepest, found_x, found_y = 0.0, 0.0, way.x, way.y
    low_x, high_x, low_y, high_y = bounds(way, reach)
    first, last = _range(low_x, high_x, grid.x, grid.dx, heights.shape[0])
    for column in range(first, last):
        x = grid.x + (column + 0.5) * grid.dx + _NUDGE - way.centre_x
        half = sqrt(max(outer * outer - x * x, 0.0))
        low, high = max(low_y, way.centre_y - half), min(high_y, way.centre_y + half)
        begin, end = _range(low, high, grid.y, grid.dy, heights.shape[1])
        for row in range(begin, end):
            height = heights[column, row]
            if height <= floor_z:
                continue
            y = grid.y + (row + 0.5) * grid.dy + _NUDGE - way.centre_y
            square = x * x + y * y
            if square > outer * outer or square < inner * inner:
                continue
            new = floor_z
            if not level:
                new = helix_height(way, x, y, reach)
            elif square < near or square > far or not is_abreast(way, x, y):
                distance = arc_distance(way, x, y)
                if distance > reach:
                    continue
                new = floor_z + rise(profile, distance)
            new = max(new, grid.bottom)
            if height - new > LEAST:
                volume += height - new
                if height - new > deepest:
                    deepest = height - new
                    found_x, found_y = x + way.centre_x, y + way.centre_y
                if number >= 0:
                    heights[column, row] = new
                    grid.owner[column, row] = number
    return volume * grid.dx * grid.dy, deepest, found_x, found_y
