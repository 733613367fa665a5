"""The march of a tool along its path: look at the rim at each station, then cut.

Lines are taken whole and arcs by quarter turns. Stations lie closer where the engagement
changes. Units mm and rad.
"""

from math import ceil, hypot, pi, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from simulator.motion.segments import Floats, Segments
from simulator.removal.carve import MEASURE, carve_part, place
from simulator.removal.profile import INNER, Profile
from simulator.removal.rim import (
    FORGETTING,
    Contact,
    Past,
    Pose,
    Tool,
    lip,
    look,
    nothing,
)
from simulator.removal.stations import CutKind
from simulator.removal.zmap import Grid

STEEP = 0.1
"""horizontal share of a move below which the tool sinks rather than mills"""

CHANGE_OF_ANGLE = 0.1
"""rad of contact by which two stations may differ"""

CHANGE_OF_SECTION = 0.1
"""share of the greater by which the sections of two stations may differ"""

MOST_STRETCHES = 4000
"""of a part; longer parts have longer stretches"""

DEEPEST = 12
"""halvings of a stretch"""

ROOM_FOR_ROW = 5 * MOST_STRETCHES
"""stations kept free before a row begins"""

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
) = range(12)
"""columns of what the march writes; EXACT: the section comes from exact arcs"""

COLUMNS = 12

VOLUME, DEPTH, SPOT_X, SPOT_Y, SPOT_Z, SHANK, HOLDER, HOLDER_X, HOLDER_Y = range(9)
"""columns of what the march finds on each row"""

FINDINGS = 9

_AIR, _MILLING, _DRILLING = int(CutKind.AIR), int(CutKind.MILLING), int(CutKind.DRILLING)


class March(NamedTuple):
    """How to march."""

    step: float
    """mm, longest stretch between two stations"""
    least: float
    """mm, shortest stretch"""
    shank: float
    """mm above the tip where the cutting edge ends; infinite: never"""
    holder: Profile
    overhang: float
    """mm above the tip where the holder begins; infinite: there is none"""
    tip_sine: float
    """sine of half the point angle"""


def rows_of(segments: Segments) -> Floats:
    """(N, 13) start, end, centre, radius, angle of the first arm, turn, normal."""
    rows = np.arange(len(segments))
    first = (segments.normal + 1) % 3
    second = (segments.normal + 2) % 3
    arm = segments.start - segments.centre
    angle = np.arctan2(arm[rows, second], arm[rows, first])
    columns = (segments.start, segments.end, segments.centre)
    numbers = (segments.radius, angle, segments.turn, segments.normal.astype(np.float64))
    return np.ascontiguousarray(np.column_stack([*columns, *numbers]))


@njit(cache=True)
def march(
    state: tuple[Grid, Past],
    tool: Tool,
    how: March,
    rows: Floats,
    lengths: Floats,
    first: int,
    out: Floats,
    found: Floats,
) -> tuple[int, int]:
    """Cut row after row until the stations' room is full; gives the next row and the count."""
    count, row = np.int64(0), first
    while row < len(rows) and count + ROOM_FOR_ROW <= len(out):
        count = _row(state, tool, how, (rows[row], lengths[row], row), out, count, found[row])
        row += 1
    return row, count


@njit(inline="always")
def _row(state, tool, how, segment, out, count, found):
    """Cut one row; gives the number of stations so far."""
    row, length, index = segment
    begin = count
    if length > 0.0:
        flat = hypot(row[3] - row[0], row[4] - row[1]) if row[11] == 0.0 else length
        if flat < STEEP * length:
            count = _sink(state, tool, how, segment, out, count, found)
        else:
            parts = max(1, ceil(abs(row[11]) / (0.5 * pi) - 1e-9))
            for part in range(parts):
                span = (part / parts, (part + 1) / parts)
                count = _mill(state, tool, how, segment, span, out, count, found)
    if count == begin:
        count = _air(out, count, index, 0.0, 0.0)
    return count


@njit(**INNER)
def _air(out, count, index, station, length):
    """Write a stretch of air, or lengthen the one before."""
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


@njit(**INNER)
def _guard(state, tool, how, row, span, found, before):
    """Measure what the shank meets before the cut, or the holder after it."""
    grid = state[0]
    low = min(place(row, span[0])[2], place(row, span[1])[2])
    if row[11] != 0.0 and row[12] != 2.0:
        low -= row[9]
    lift = how.shank if before else how.overhang
    if low + lift >= grid.top:
        return
    raised = row.copy()
    raised[2] += lift
    raised[5] += lift
    raised[8] += lift
    if before:
        shank = Profile(0.0, tool.profile.radius, 0.0, tool.profile.radius, 0.0, 0.0, tool.profile.radius)
        lost = carve_part(grid, shank, raised, span, np.int64(MEASURE))
        found[SHANK] = max(found[SHANK], lost[1])
        return
    lost = carve_part(grid, how.holder, raised, span, np.int64(MEASURE))
    if lost[1] > found[HOLDER]:
        found[HOLDER], found[HOLDER_X], found[HOLDER_Y] = lost[1], lost[2], lost[3]


@njit(**INNER)
def _cut(state, tool, how, row, span, found):
    """Cut a part of a row and keep account; gives the volume."""
    grid, past = state
    _guard(state, tool, how, row, span, found, True)
    number = past.next[0]
    volume, depth, x, y = carve_part(grid, tool.profile, row, span, number)
    if volume > 0.0:
        start, end = place(row, span[0]), place(row, span[1])
        record = past.records[number % FORGETTING]
        record[:13] = row
        record[0], record[1], record[2] = start
        record[3], record[4], record[5] = end
        record[10] = row[10] + span[0] * row[11]
        record[11] = (span[1] - span[0]) * row[11]
        profile = tool.profile
        record[13], record[14], record[15] = profile.slope, profile.flat, profile.corner
        record[16], record[17], record[18] = profile.tangent, profile.shoulder, profile.flank
        record[19] = profile.radius
        past.next[0] += 1
        found[VOLUME] += volume
        if depth > found[DEPTH]:
            found[DEPTH], found[SPOT_X], found[SPOT_Y] = depth, x, y
            column = min(int((x - grid.x) / grid.dx), grid.heights.shape[0] - 1)
            line = min(int((y - grid.y) / grid.dy), grid.heights.shape[1] - 1)
            found[SPOT_Z] = grid.heights[column, line]
    _guard(state, tool, how, row, span, found, False)
    return volume


@njit(inline="always")
def _sink(state, tool, how, segment, out, count, found):
    """Cut a plunge by stretches, or what a tool meets on its way up."""
    row, length, index = segment
    grid = state[0]
    stretches = min(max(1, ceil(length / how.step)), MOST_STRETCHES)
    for stretch in range(stretches):
        span = (stretch / stretches, (stretch + 1) / stretches)
        x, y, z = place(row, span[1])
        inner, outer = lip(grid, tool.profile, x, y, z)
        volume = _cut(state, tool, how, row, span, found)
        long = length / stretches
        if volume <= 0.0:
            count = _air(out, count, index, span[1] * length, long)
            continue
        if outer <= inner:
            inner, outer = 0.0, tool.profile.radius
        line = out[count]
        line[:] = 0.0
        line[ROW], line[STATION], line[KIND] = index, span[1] * length, _DRILLING
        line[SECTION] = volume / long
        line[AXIAL] = outer - inner
        line[CHIP] = how.tip_sine
        line[DIAMETER] = outer + inner
        line[LENGTH] = long
        count += 1
    return count


@njit(**INNER)
def _look(state, tool, row, part):
    """Engagement at a share of a row."""
    grid, past = state
    x, y, z = place(row, part)
    if row[11] == 0.0:
        ahead_x, ahead_y, climb = row[3] - row[0], row[4] - row[1], row[5] - row[2]
    else:
        # A difference that small errs by less than its square, and serves every plane.
        nearer, farther = max(part - 1e-5, 0.0), min(part + 1e-5, 1.0)
        one, other = place(row, nearer), place(row, farther)
        ahead_x, ahead_y, climb = other[0] - one[0], other[1] - one[1], other[2] - one[2]
        if row[12] == 2.0:
            ahead_x, ahead_y = -(y - row[7]) * row[11], (x - row[6]) * row[11]
            climb = row[5] - row[2]
    flat = hypot(ahead_x, ahead_y)
    if flat == 0.0:
        return nothing()
    pose = Pose(x, y, z, ahead_x / flat, ahead_y / flat, climb / flat)
    return look(grid, past, tool, pose)


@njit(**INNER)
def _differs(one: Contact, other: Contact) -> bool:
    """Whether there should be a station between two."""
    change = abs(one.section - other.section)
    if change > CHANGE_OF_SECTION * max(one.section, other.section):
        return True
    return abs(one.contact - other.contact) > CHANGE_OF_ANGLE


@njit(inline="always")
def _mill(state, tool, how, segment, span, out, count, found):
    """Look along a part, cut it, and share its volume among the stretches."""
    row, length, index = segment
    begin = count
    if min(place(row, span[0])[2], place(row, span[1])[2]) >= state[0].top and row[12] == 2.0:
        return _air(out, count, index, span[1] * length, (span[1] - span[0]) * length)
    count = _stations(state, tool, how, segment, span, out, count)
    volume = _cut(state, tool, how, row, span, found)
    return _shared(tool, how, out, begin, count, volume)


@njit(**INNER)
def _stations(state, tool, how, segment, span, out, count):
    """Write a line for each stretch of a part: the fuller of its ends, and the mean section."""
    row, length, index = segment
    whole = (span[1] - span[0]) * length
    stretches = min(max(1, ceil(whole / how.step - 1e-9)), MOST_STRETCHES)
    limit = count + MOST_STRETCHES + 200
    last, left = span[0], _look(state, tool, row, span[0])
    waiting = [(last, left)]
    for stretch in range(stretches):
        part = span[0] + (span[1] - span[0]) * (stretch + 1) / stretches
        waiting.append((part, _look(state, tool, row, part)))
        while len(waiting) > 1:
            part, right = waiting[-1]
            long = (part - last) * length
            halves = len(waiting) < DEEPEST and count < limit and long > 2.0 * how.least
            if halves and _differs(left, right):
                middle = 0.5 * (last + part)
                waiting.append((middle, _look(state, tool, row, middle)))
                continue
            waiting.pop()
            fuller = right if right.section >= left.section else left
            line = out[count]
            line[ROW], line[STATION], line[KIND] = index, part * length, _MILLING
            line[SECTION] = 0.5 * (left.section + right.section)
            line[AXIAL], line[ENTRY], line[EXIT] = fuller.axial_depth, fuller.entry, fuller.exit
            line[CONTACT], line[CHIP] = fuller.contact, fuller.chip_ratio
            line[DIAMETER], line[LENGTH] = fuller.diameter, long
            line[EXACT] = 1.0 if left.exact and right.exact else 0.0
            count += 1
            last, left = part, right
    return count


@njit(**INNER)
def _shared(tool, how, out, begin, count, volume):
    """Sections of a part that hold its volume, and air where there is none."""
    exact, shape, length = True, 0.0, 0.0
    for index in range(begin, count):
        exact = exact and out[index, EXACT] == 1.0
        shape += out[index, SECTION] * out[index, LENGTH]
        length += out[index, LENGTH]
    kept = begin
    for index in range(begin, count):
        line = out[index]
        if not exact:
            line[EXACT] = 0.0
            if shape > 0.0:
                line[SECTION] *= volume / shape
            else:
                line[SECTION] = volume / length
        if line[SECTION] <= 0.0:
            kept = _air(out, kept, line[ROW], line[STATION], line[LENGTH])
            continue
        if line[CONTACT] == 0.0:
            # What cuts only behind its axis, as a ball does that runs down, has no arc ahead.
            line[AXIAL] = line[SECTION] / (2.0 * tool.profile.radius)
            line[EXIT], line[CONTACT] = pi, pi
            line[CHIP] = 2.0 / pi * how.tip_sine
            line[DIAMETER] = 2.0 * tool.profile.radius
        if kept != index:
            out[kept] = line
        kept += 1
    return kept
