"""Contact of a cutter with the stock: its rim against the height map, in horizontal slices.

For each slice, a ring of samples one cell outside the rim tells what is solid; closer to the
rim, cells cut by the tool's own last step would read as air. Each free sample names the move
that cleared it. If that move has an exact outline, the outline decides and the map serves only
as an index; otherwise (a rounded tool on a slope, a move no longer remembered) the sample
itself decides, to within about a cell.

Slices of flat cutters lie between the heights found on the ring; those of rounded cutters
divide the depth. Mean chip thickness over feed per tooth is ``∫∫ sin φ dφ dz / ∫∫ dφ dl`` with
l along the edge, which is ``sin κ·(cos φ_st − cos φ_ex)/(φ_ex − φ_st)`` for one arc. Units mm
and rad.
"""

from math import acos, asin, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import kernel
from simulator.motion.segments import Floats, Ints
from simulator.removal.arcs import (
    RECORD,
    Intervals,
    ToolCircle,
    add_free,
    contact_arcs,
    free_by_move,
    free_by_outline,
)
from simulator.removal.cutter import CutterProfile, is_plain, is_upright, radius_at, rise
from simulator.removal.ring import (
    CORNER_SLICES,
    MOST_CANDIDATES,
    NEAR,
    Pose,
    RimBuffers,
    RimTool,
    Ring,
    cell_at,
    circle_of,
    levels,
    read_ring,
)
from simulator.removal.tip_move import LEAST, LEVEL
from simulator.removal.zmap import OUTSIDE, HeightGrid

FLANK_SLICES = 4

FORGETTING = 32_768
"""Number of recent moves whose outlines are remembered."""

SLIVERS = 0.05
"""Share of the section that may lie above the axial depth, so that slivers left on a wall do
not increase the depth."""

TRACE = 1e-3
"""Contact angle, rad, below which contact is neglected."""

INSIDE_SAMPLES = 8
"""Number of samples inside the rim for each contact arc."""

RECENT = 3
"""Number of the last moves whose outlines are always used, even if no cell names them."""


class RecentOutlines(NamedTuple):
    """Outlines of the last moves that cut; a ring buffer."""

    records: Floats
    """Row and tool profile of each remembered move, (FORGETTING, RECORD)."""
    next: Ints
    """Number of the next move, (1,)."""
    last: Floats
    """Position at which the tool cut last, (3,), mm; NaN after a jump."""


AREA, DEPTH, ENTRY, EXIT, CONTACT, CHIP, DIAMETER, EXACT = range(8)
"""Columns of an engagement: section in mm², greatest depth in mm, angles in rad, mean chip
thickness over feed per tooth, greatest cutting diameter in mm, and EXACT: 1 if all outlines are
exact on a level move of an upright tool, FLANK if such a tool descends and its end cuts too,
else 0."""

FLANK = 0.5
"""Value of EXACT for a section that includes the flank of the tool but not its end."""

ENGAGEMENT = 8


def past() -> RecentOutlines:
    """Create an empty memory of move outlines."""
    return RecentOutlines(
        np.zeros((FORGETTING, RECORD)), np.zeros(1, dtype=np.int64), np.full(3, np.nan)
    )


@kernel
def look(
    grid: HeightGrid,
    before: RecentOutlines,
    tool: RimTool,
    work: RimBuffers,
    pose: Pose,
    into: Floats,
) -> None:
    """Determine the engagement of a tool at a position, before it cuts there.

    Parameters
    ----------
    into : (ENGAGEMENT,) array
        Receives the engagement.
    """
    into[:] = 0.0
    into[EXACT] = 1.0
    profile = tool.profile
    plain, is_known = is_plain(profile), True
    upright = plain or is_upright(profile)
    gap = max(grid.dx, grid.dy)
    base = max(pose.z, grid.bottom)
    if plain:
        read_ring(grid, work.wide, work.turns, circle_of(pose, profile.radius, tool.side), gap)
        slices = levels(work, base)
    else:
        slices = _slices(grid, work, tool, pose, base, upright)
    area, across, edges, widest, most = 0.0, 0.0, 0.0, 0.0, 0.0
    count_all, ring_radius = int(np.int64(0)), -1.0
    for index in range(slices):
        work.areas[index] = 0.0
        low, high = work.bounds[index], work.bounds[index + 1]
        middle = 0.5 * (low + high)
        radius = radius_at(profile, middle - pose.z)
        circle = circle_of(pose, radius, tool.side)
        ring = work.wide if radius >= profile.radius else work.inner
        if radius < profile.radius and radius != ring_radius:
            read_ring(grid, work.inner, work.turns, circle, gap)
        ring_radius = radius
        found, known = _slice(grid, before, work, (ring, circle), middle, index > 0)
        if not plain and pose.climb > 0.0:
            found = _leading(work, found, profile, middle - pose.z, pose.climb)
        is_known = is_known and known
        if found == 0:
            continue
        sines, angle = 0.0, 0.0
        for arc in range(found):
            begin, end = work.arcs.contact[arc, 0], work.arcs.contact[arc, 1]
            sines += 2.0 * sin(0.5 * (begin + end)) * sin(0.5 * (end - begin))
            angle += end - begin
            count_all = add_free(work.total, count_all, begin, end)
        most = max(most, angle)
        work.areas[index] = (high - low) * radius * sines
        area += work.areas[index]
        across += (high - low) * sines
        edges += _edge(profile, low - pose.z, high - pose.z, tool.sine) * angle
        widest = 2.0 * radius_at(profile, high - pose.z)
    into[EXACT] = _exactness(upright and is_known, pose.climb)
    if count_all == 0 or most < TRACE:
        return
    top, above = slices, 0.0
    while top > 1 and above + work.areas[top - 1] <= SLIVERS * area:
        top -= 1
        above += work.areas[top]
    into[AREA], into[DEPTH] = area, work.bounds[top] - base
    into[CHIP], into[DIAMETER] = across / edges, widest
    _hull(work.total, contact_arcs(work.total, count_all), into)


@kernel
def _exactness(is_known: bool, climb: float) -> float:
    """Exactness of the section, from the outlines and the slope of the path."""
    if not is_known or climb > LEVEL:
        return 0.0
    return FLANK if climb < -LEVEL else 1.0


@kernel
def _slices(
    grid: HeightGrid, work: RimBuffers, tool: RimTool, pose: Pose, base: float, upright: bool
) -> int:
    """Divide a rounded tool into slices up to the highest point it touches ahead.

    Above the corner of an upright tool, slices lie between the heights found on its ring.
    Returns the number of slices.
    """
    profile = tool.profile
    top = _top(grid, work, tool, pose, base)
    if top <= base:
        return 0
    shoulder = min(max(pose.z + profile.shoulder, base), top)
    above = 0
    if upright and top > shoulder + LEAST:
        above = levels(work, shoulder)
        for index in range(above, 0, -1):
            work.bounds[index + CORNER_SLICES] = work.bounds[index]
    count = _divided(work, 0, base, shoulder, CORNER_SLICES)
    if above == 0:
        return _divided(work, count, shoulder, top, FLANK_SLICES)
    for index in range(1, above + 1):
        work.bounds[count + index] = work.bounds[CORNER_SLICES + index]
    return count + above


@kernel
def _divided(work: RimBuffers, count: int, low: float, high: float, parts: int) -> int:
    """Add slices that divide a height range evenly; return the number of slices."""
    work.bounds[count] = low
    if high <= low + LEAST:
        return count
    for index in range(1, parts + 1):
        work.bounds[count + index] = low + (high - low) * index / parts
    return count + parts


@kernel
def _top(grid: HeightGrid, work: RimBuffers, tool: RimTool, pose: Pose, base: float) -> float:
    """Greatest height at which a rounded tool touches material ahead, mm."""
    profile, gap = tool.profile, max(grid.dx, grid.dy)
    samples = len(work.turns)
    step, top = pi / samples, base
    for third in range(1, 4):
        radius = profile.radius * third / 3.0
        circle = circle_of(pose, radius, tool.side)
        ring = work.inner if third < 3 else work.wide
        read_ring(grid, ring, work.turns, circle, gap)
        reach = pose.z + rise(profile, radius) - LEAST
        for index in range(samples):
            height = ring.heights[index]
            if height <= top:
                continue
            # Material lower than the tool there may extend inward to where the tool is as low.
            nearer = radius_at(profile, height - pose.z) + gap
            if height > reach or (
                cell_at(grid, circle, nearer, (index + 0.5) * step)[0] > height - LEAST
            ):
                top = height
    return top


@kernel
def _recent(before: RecentOutlines, work: RimBuffers, circle: ToolCircle, level: float) -> int:
    """Register the last moves as candidates; return the number of intervals they cleared."""
    latest, free = before.next[0], int(np.int64(0))
    for index in range(min(latest, RECENT)):
        number = max(latest - RECENT, 0) + index
        work.candidates[index] = number
        record = before.records[number % FORGETTING]
        free = max(free_by_move(work.arcs, free, circle, record, level), free)
    return free


@kernel
def _slice(
    grid: HeightGrid,
    before: RecentOutlines,
    work: RimBuffers,
    rim: tuple[Ring, ToolCircle],
    level: float,
    is_above: bool,
) -> tuple[int, bool]:
    """Find the contact arcs of one slice: their number, and whether all outlines were exact."""
    ring, circle = rim
    latest = before.next[0]
    samples = len(ring.heights)
    step = pi / samples
    known, is_at_border = True, grid.radius > 0.0
    if _runs(ring.heights, work.solid, level) == 0:
        return 0, True
    free, candidates = _recent(before, work, circle, level), min(latest, RECENT)
    used = np.int64(OUTSIDE)
    for index in range(samples):
        if work.solid[index] == 0:
            continue
        owner = ring.owner[index]
        if owner == OUTSIDE:
            is_at_border = True
            continue
        if work.solid[index] > NEAR:
            free = add_free(work.arcs, free, index * step, (index + 1) * step)
            continue
        # Neighbours mostly have the same owner.
        if owner == used or _is_candidate(work, candidates, owner):
            used = owner
            continue
        if owner >= max(latest - FORGETTING, 0) and candidates < MOST_CANDIDATES:
            tried = free_by_move(
                work.arcs, free, circle, before.records[owner % FORGETTING], level
            )
            if tried >= 0:
                free = tried
                work.candidates[candidates] = owner
                candidates += 1
                used = owner
                continue
        known = False
        free = add_free(work.arcs, free, index * step, (index + 1) * step)
    if is_at_border:
        free = free_by_outline(work.arcs, free, circle, grid)
    if is_above:
        free = _named_inside(grid, before, work, circle, level, free)
    return contact_arcs(work.arcs, free), known


@kernel
def _is_candidate(work: RimBuffers, count: int, owner: int) -> bool:
    """True if the outline of a move has been used."""
    seen = count - 1
    while seen >= 0 and work.candidates[seen] != owner:
        seen -= 1
    return seen >= 0


@kernel
def _named_inside(
    grid: HeightGrid,
    before: RecentOutlines,
    work: RimBuffers,
    circle: ToolCircle,
    level: float,
    free: int,
) -> int:
    """Add intervals cleared by moves that only cells inside the rim name; return their count.

    A strip cleared by the arc of a corner in an earlier pass may be narrower than a cell.
    """
    inside = circle.radius - 0.5 * max(grid.dx, grid.dy)
    latest, last = before.next[0], -1
    for arc in range(contact_arcs(work.arcs, free)):
        begin, end = work.arcs.contact[arc, 0], work.arcs.contact[arc, 1]
        for part in range(INSIDE_SAMPLES):
            angle = begin + (end - begin) * (part + 0.5) / INSIDE_SAMPLES
            height, owner = cell_at(grid, circle, inside, angle)
            is_old = max(latest - FORGETTING, 0) <= owner < latest
            if is_old and height <= level and owner != last:
                record = before.records[owner % FORGETTING]
                free = max(free_by_move(work.arcs, free, circle, record, level), free)
                last = owner
    return free


@kernel
def _runs(heights: Floats, solid: Ints, level: float) -> int:
    """Write each sample's distance to the nearest solid one; return the number of solids."""
    away, count, last = NEAR + 1, 0, len(heights) - 1
    for index in range(last + 1):
        away = 0 if heights[index] > level else away + 1
        count += away == 0
        solid[index] = away
    for index in range(last - 1, -1, -1):
        solid[index] = min(solid[index], solid[index + 1] + 1)
    return count


@kernel
def _leading(
    work: RimBuffers, count: int, profile: CutterProfile, height: float, climb: float
) -> int:
    """Keep the parts of contact arcs on the leading side of a climbing tool, ``n·v > 0``."""
    radius = radius_at(profile, height)
    if profile.slope > 0.0 and radius < profile.radius:
        tangent = profile.slope
    elif height < profile.shoulder:
        tangent = (radius - profile.flat) / max(profile.corner - height, LEAST)
    elif profile.flank > 0.0:
        tangent = profile.flank
    else:
        return count
    if tangent <= climb:
        return 0
    least = asin(climb / tangent)
    kept = 0
    for index in range(count):
        begin = max(work.arcs.contact[index, 0], least)
        end = min(work.arcs.contact[index, 1], pi - least)
        if begin < end:
            work.arcs.contact[kept, 0], work.arcs.contact[kept, 1] = begin, end
            kept += 1
    return kept


@kernel
def _edge(profile: CutterProfile, low: float, high: float, sine: float) -> float:
    """Length of the cutting edge between two heights above the tip, mm."""
    if profile.slope > 0.0:
        return (high - low) * sqrt(1.0 + 1.0 / profile.slope**2)
    corner = 0.0
    if low < profile.shoulder:
        end = min(high, profile.shoulder)
        corner = profile.corner * (
            acos(max(1.0 - end / profile.corner, -1.0))
            - acos(max(1.0 - max(low, 0.0) / profile.corner, -1.0))
        )
    straight = max(high - max(low, profile.shoulder), 0.0)
    if profile.flank > 0.0:
        straight *= sqrt(1.0 + 1.0 / profile.flank**2)
    return corner + straight / sine


@kernel
def _hull(total: Intervals, gaps: int, into: Floats) -> None:
    """Compute entry angle, exit angle and total contact from the gaps between arcs."""
    into[EXIT], into[CONTACT] = pi, pi
    for index in range(gaps):
        begin, end = total.contact[index, 0], total.contact[index, 1]
        into[CONTACT] -= end - begin
        if begin == 0.0:
            into[ENTRY] = end
        if end == pi:
            into[EXIT] = begin
