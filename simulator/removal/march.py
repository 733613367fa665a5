"""March of a tool along its path: look at the rim at each station, then cut.

Lines are taken whole and arcs by quarter turns. Stations lie closer where the engagement
changes. Units mm and rad.
"""

from math import ceil, hypot, inf, pi

import numpy as np

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats, Ints
from simulator.removal.carve import MEASURE, carve_part
from simulator.removal.cutter import is_plain
from simulator.removal.rim import AREA, FLANK, FORGETTING, RecentOutlines, look
from simulator.removal.rim import CONTACT as CONTACT_SEEN
from simulator.removal.ring import Pose
from simulator.removal.sink import LIP_ERROR, hole, lip
from simulator.removal.stations import StationKind
from simulator.removal.tip_move import copy, place, raised
from simulator.removal.trial import DEEPEST, RemovalTask

STEEP = 0.1
"""Horizontal share of a move below which the tool plunges rather than mills."""

CHANGE_OF_ANGLE = 0.15
"""Largest difference in contact angle between two neighbouring stations, rad."""

CHANGE_OF_SECTION = 0.15
"""Largest relative difference in section between two neighbouring stations."""

POINTED = 0.4
"""Stretch length over the normal step for pointed tools, whose section keeps growing."""

MOST_STRETCHES = 4000
"""Largest number of stretches in a row; longer rows have longer stretches."""

THINNEST = 0.05
"""Thickness, mm, assigned to a thinner skin of material that a plunging tool meets."""

MOST_TURNS = 100.0
"""Largest number of turns in one arc."""

INSET = 2e-5
"""Distance, mm, from the ends of a part at which engagement is sampled: exactly on a corner
the tool's own circle bounds what it has cut, and the side is undefined."""

ROOM_FOR_ROW = 5 * MOST_STRETCHES
"""Number of stations that must be free before a row begins."""

(
    ROW,
    STATION,
    KIND,
    SECTION,
    AXIAL,
    ENTRY,
    EXIT,
    CONTACT,
    CHIP,
    DIAMETER,
    EXACT,
    LENGTH,
    GROWTH,
) = range(13)
"""Columns of the lines written by the march; EXACT: the section comes from exact arcs."""

COLUMNS = 13

VOLUME, DEPTH, SPOT_X, SPOT_Y, SPOT_Z, SHANK, HOLDER, HOLDER_X, HOLDER_Y = range(9)
"""Columns of the findings recorded for each row."""

FINDINGS = 9

_AIR, _MILLING, _DRILLING = (
    int(StationKind.AIR),
    int(StationKind.MILLING),
    int(StationKind.DRILLING),
)


Segment = tuple[Floats, float, int]
"""Row, length in mm and index of a segment."""

Span = tuple[float, float]
"""Begin and end of a part of a segment, as shares of its length."""


@entry
def march(
    task: RemovalTask,
    rows: Floats,
    lengths: Floats,
    out: Floats,
    findings: Floats,
    reached: Ints,
) -> None:
    """Cut row after row until there is no room for more stations.

    Parameters
    ----------
    rows : (N, 13) array
        Rows from :func:`rows_of`.
    lengths : (N,) array, mm
    out : (L, COLUMNS) array
        Lines written, from the first one on; L at least ``ROOM_FOR_ROW``.
    findings : (N, FINDINGS) array
        Findings, accumulated in place.
    reached : (2,) array of int
        Index of the first row; updated to the next row and the number of stations written.
    """
    count, row = int(np.int64(0)), reached[0]
    while row < len(rows) and count + ROOM_FOR_ROW <= len(out):
        count = _row(task, (rows[row], lengths[row], row), out, count, findings[row])
        row += 1
    reached[0], reached[1] = row, count


def marched(
    task: RemovalTask, rows: Floats, lengths: Floats, out: Floats, findings: Floats
) -> Floats:
    """Cut row after row to the last one, and return the lines of all stations.

    The parameters are those of :func:`march`.
    """
    parts: list[Floats] = []
    reached = np.zeros(2, dtype=np.int64)
    while reached[0] < len(rows):
        march(task, rows, lengths, out, findings, reached)
        parts.append(out[: reached[1]].copy())
    return np.concatenate(parts) if parts else np.empty((0, COLUMNS))


@kernel
def _row(task: RemovalTask, segment: Segment, out: Floats, count: int, findings: Floats) -> int:
    """Cut one row and return the number of stations so far."""
    row, length, index = segment
    if length <= 0.0:
        return _air(out, count, index, 0.0, 0.0)
    if row[11] == 0.0 and hypot(row[3] - row[0], row[4] - row[1]) < STEEP * length:
        return _sink(task, segment, out, count, findings)
    parts = max(1, ceil(abs(row[11]) / (0.5 * pi) - 1e-9))
    for part in range(parts):
        span = (part / parts, (part + 1) / parts)
        count = _mill(task, segment, span, out, count, findings)
    return count


@kernel
def _air(out: Floats, count: int, index: int, station: float, length: float) -> int:
    """Write a stretch of air, or lengthen the previous one; return the number of stations."""
    if count > 0 and out[count - 1, ROW] == index and out[count - 1, KIND] == _AIR:
        out[count - 1, STATION] = station
        out[count - 1, LENGTH] += length
        return count
    out[count] = 0.0
    out[count, ROW] = index
    out[count, STATION] = station
    out[count, LENGTH] = length
    out[count, EXACT] = 1.0
    return count + 1


@kernel
def _sink(
    task: RemovalTask, segment: Segment, out: Floats, count: int, findings: Floats
) -> int:
    """Cut a plunge by stretches, or what a retracting tool meets; return the station count."""
    row, length, index = segment
    grid = task.grid
    if min(row[2], row[5]) >= grid.top:
        _leave(task.past)
        return _air(out, count, index, length, length)
    profile = task.tool.profile
    step = task.how.step * (1.0 if is_plain(profile) else POINTED)
    stretches = min(max(1, ceil(length / step)), MOST_STRETCHES)
    bored = 0.0
    for stretch in range(stretches):
        span = (stretch / stretches, (stretch + 1) / stretches)
        x, y, z = place(row, span[1])
        inner, outer = lip(grid, profile, x, y, z)
        # Below the bottom of the stock the map does not tell the width of a pointed tool.
        middle = place(row, 0.5 * (span[0] + span[1]))
        bored = max(bored, hole(grid, task.past, middle))
        if abs(inner - bored) <= LIP_ERROR * profile.radius + max(grid.dx, grid.dy):
            inner = bored
        volume, depth = _cut(task, row, span, findings)
        long = length / stretches
        if volume <= 0.0:
            count = _air(out, count, index, span[1] * length, long)
            continue
        # A mill meets a skin over its thickness: the material lies at one end of a stretch.
        met = long if task.how.tip_sine < 1.0 else max(depth, THINNEST)
        met = met if met < long - INSET else long
        before = 0.0 if z < grid.bottom else long - met
        if before > 0.0:
            count = _air(out, count, index, span[0] * length + before, before)
        if outer <= inner:
            inner, outer = 0.0, profile.radius
        line = out[count]
        line[:] = 0.0
        end = span[0] * length + before + met
        line[ROW], line[STATION], line[KIND] = index, end, _DRILLING
        line[SECTION] = volume / met
        if is_plain(profile):
            ring = pi * (profile.radius**2 - bored**2)
            if abs(ring - line[SECTION]) <= pi * profile.radius * max(grid.dx, grid.dy):
                # A ring thinner than a cell: the drilled hole's diameter is more exact.
                inner, outer, line[SECTION] = bored, profile.radius, ring
        elif task.how.tip_sine < 1.0:
            # A point keeps growing: at the end of the stretch it cuts more than on average.
            more = pi * (outer**2 - inner**2) - line[SECTION]
            line[GROWTH] = 2.0 * min(max(more, 0.0), line[SECTION])
        line[AXIAL] = outer - inner
        line[CHIP] = task.how.tip_sine
        line[DIAMETER] = outer + inner
        line[LENGTH] = met
        count += 1
        if before + met < long:
            count = _air(out, count, index, span[1] * length, long - before - met)
    return count


@kernel
def _mill(
    task: RemovalTask, segment: Segment, span: Span, out: Floats, count: int, findings: Floats
) -> int:
    """Sample the engagement along a part, cut it, and share its volume among stretches."""
    row, length, index = segment
    begin = count
    if min(row[2], row[5]) - abs(row[9]) * (row[12] != 2.0) >= task.grid.top:
        _leave(task.past)
        return _air(out, count, index, span[1] * length, (span[1] - span[0]) * length)
    count = _stations(task, segment, span, out, count)
    volume, _ = _cut(task, row, span, findings)
    return _shared(task, out, begin, count, volume)


@kernel
def _leave(past: RecentOutlines) -> None:
    """Forget the position at which the tool cut last."""
    past.last[0] = np.nan


@kernel
def _stations(task: RemovalTask, segment: Segment, span: Span, out: Floats, count: int) -> int:
    """Write a line per stretch of a part, with its mean section and fuller end's engagement.

    The end of a stretch waits on a stack with the engagement found there; where it differs too
    much from that at the beginning, the middle of the stretch is pushed on top.
    """
    row, length, index = segment
    whole = (span[1] - span[0]) * length
    # All parts of a row share its room.
    most = max(4, int(MOST_STRETCHES * (span[1] - span[0])))
    stretches = min(max(1, ceil(whole / task.how.step - 1e-9)), most)
    limit = count + most
    inset = min(INSET / whole, 0.25) * (span[1] - span[0])
    parts, seen, left = task.desk.parts, task.desk.seen, task.desk.left
    last = span[0]
    _look(task, row, last + inset, left)
    for stretch in range(stretches):
        parts[0] = span[0] + (span[1] - span[0]) * (stretch + 1) / stretches
        _look(task, row, parts[0] - inset, seen[0])
        top = 0
        while top >= 0:
            part, right = parts[top], seen[top]
            long = (part - last) * length
            if top + 1 < DEEPEST and count < limit and _differs(task, left, right, long):
                top += 1
                parts[top] = 0.5 * (last + part)
                _look(task, row, parts[top], seen[top])
                continue
            fuller = right if right[AREA] >= left[AREA] else left
            line = out[count]
            line[ROW], line[STATION], line[KIND] = index, part * length, _MILLING
            line[SECTION] = 0.5 * (left[AREA] + right[AREA])
            for column in range(1, 7):
                line[AXIAL - 1 + column] = fuller[column]
            line[LENGTH] = long
            line[EXACT] = min(left[7], right[7])
            line[GROWTH] = right[AREA] - left[AREA] if line[EXACT] > 0.0 else 0.0
            count += 1
            last = part
            copy(right, left, 0)
            top -= 1
    return count


@kernel
def _look(task: RemovalTask, row: Floats, part: float, into: Floats) -> None:
    """Determine the engagement at a share of a row and write it to ``into``."""
    x, y, z = place(row, part)
    if row[11] == 0.0:
        ahead_x, ahead_y, climb = row[3] - row[0], row[4] - row[1], row[5] - row[2]
    elif row[12] == 2.0:
        ahead_x, ahead_y = -(y - row[7]) * row[11], (x - row[6]) * row[11]
        climb = row[5] - row[2]
    else:
        # The error of this small difference is of second order, and it serves both planes.
        one, other = place(row, part - 1e-5), place(row, part + 1e-5)
        ahead_x, ahead_y, climb = other[0] - one[0], other[1] - one[1], other[2] - one[2]
    flat = max(hypot(ahead_x, ahead_y), 1e-12)
    pose = Pose(x, y, z, ahead_x / flat, ahead_y / flat, climb / flat)
    look(task.grid, task.past, task.tool, task.desk.rim, pose, into)


@kernel
def _differs(task: RemovalTask, left: Floats, right: Floats, long: float) -> bool:
    """True if two stations differ so much that another is needed between them.

    Sections that come from the map are compared only over long stretches: they are noisy.
    """
    if left[7] * right[7] == 0.0:
        return (left[AREA] == 0.0) != (right[AREA] == 0.0) and long > 2.0 * task.how.coarse
    if long <= 2.0 * task.how.least:
        return False
    if abs(left[AREA] - right[AREA]) > CHANGE_OF_SECTION * max(left[AREA], right[AREA]):
        return True
    return bool(abs(left[CONTACT_SEEN] - right[CONTACT_SEEN]) > CHANGE_OF_ANGLE)


@kernel
def _cut(task: RemovalTask, row: Floats, span: Span, findings: Floats) -> tuple[float, float]:
    """Cut a part of a row and record the findings; return volume and greatest depth."""
    grid, past = task.grid, task.past
    start, end = place(row, span[0]), place(row, span[1])
    low = min(start[2], end[2]) - abs(row[9]) * (row[12] != 2.0)
    # A raised tool is equivalent to the tool on a raised row.
    if low + task.how.shank < grid.top:
        lost = carve_part(
            grid,
            task.how.neck,
            raised(row, task.how.shank, task.desk.raised),
            span,
            int(np.int64(MEASURE)),
            start[0] > inf,
        )
        findings[SHANK] = max(findings[SHANK], lost[1])
    last = past.last
    goes_on = last[0] == start[0] and last[1] == start[1] and last[2] == start[2]
    volume, depth, x, y = carve_part(grid, task.tool.profile, row, span, past.next[0], goes_on)
    last[0], last[1], last[2] = end
    if volume > 0.0:
        record = past.records[past.next[0] % FORGETTING]
        copy(row, record, 0)
        record[0], record[1], record[2] = start
        record[3], record[4], record[5] = end
        record[10] = row[10] + span[0] * row[11]
        record[11] = (span[1] - span[0]) * row[11]
        copy(task.how.shape, record, 13)
        past.next[0] += 1
        findings[VOLUME] += volume
        if depth > findings[DEPTH]:
            findings[DEPTH], findings[SPOT_X], findings[SPOT_Y] = depth, x, y
            column = min(int((x - grid.x) / grid.dx), grid.heights.shape[0] - 1)
            line = min(int((y - grid.y) / grid.dy), grid.heights.shape[1] - 1)
            findings[SPOT_Z] = grid.heights[column, line]
    if low + task.how.overhang < grid.top:
        lost = carve_part(
            grid,
            task.how.holder,
            raised(row, task.how.overhang, task.desk.raised),
            span,
            int(np.int64(MEASURE)),
            start[0] > inf,
        )
        if lost[1] > findings[HOLDER]:
            findings[HOLDER], findings[HOLDER_X], findings[HOLDER_Y] = lost[1], lost[2], lost[3]
    return volume, depth


@kernel
def _with_end(out: Floats, begin: int, count: int, volume: float) -> None:
    """Add the volume that the end of a descending flat tool cuts, spread evenly."""
    rest, length = volume, 0.0
    for index in range(begin, count):
        rest -= out[index, SECTION] * out[index, LENGTH]
        length += out[index, LENGTH] * (out[index, EXACT] == FLANK)
    for index in range(begin, count):
        if out[index, EXACT] == FLANK:
            out[index, SECTION] += max(rest, 0.0) / length
            out[index, EXACT] = 1.0


@kernel
def _shared(task: RemovalTask, out: Floats, begin: int, count: int, volume: float) -> int:
    """Distribute the remaining volume over inexact sections; mark empty stretches as air."""
    unknown = False
    for index in range(begin, count):
        unknown = unknown or out[index, EXACT] == 0.0
    if not unknown:
        _with_end(out, begin, count, volume)
    shape, length, rest = 0.0, 0.0, volume
    for index in range(begin, count):
        part = out[index, SECTION] * out[index, LENGTH]
        if out[index, EXACT] == 1.0:
            rest -= part
            continue
        out[index, EXACT], out[index, GROWTH] = 0.0, 0.0
        shape += part
        length += out[index, LENGTH]
    rest = max(rest, 0.0)
    kept = begin
    for index in range(begin, count):
        line = out[index]
        if line[EXACT] == 0.0:
            line[SECTION] = line[SECTION] * rest / shape if shape > 0.0 else rest / length
        if line[SECTION] <= 0.0:
            kept = _air(out, kept, int(line[ROW]), line[STATION], line[LENGTH])
            continue
        if line[CONTACT] == 0.0:
            # A tool that cuts only behind its axis, such as a descending ball, has no arc.
            line[AXIAL] = line[SECTION] / (2.0 * task.tool.profile.radius)
            line[EXIT], line[CONTACT] = pi, pi
            line[CHIP] = 2.0 / pi * task.how.tip_sine
            line[DIAMETER] = 2.0 * task.tool.profile.radius
        if kept != index:
            copy(line, out[kept], 0)
        kept += 1
    return kept
