"""Ring of samples of the height map around the front of a cutter, with its work buffers.

Units mm and rad.
"""

from math import cos, floor, pi, sin
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import kernel
from simulator.motion.segments import Floats, Ints
from simulator.removal.arcs import (
    Intervals,
    ToolCircle,
    intervals,
)
from simulator.removal.cutter import CutterProfile
from simulator.removal.tip_move import LEAST
from simulator.removal.zmap import OUTSIDE, HeightGrid

SAMPLES = 128
"""Number of samples on the front half of a ring."""

ROUND_SAMPLES = 48
"""Number of samples on each ring of a rounded tool."""

MOST_LEVELS = 8
"""Largest number of different stock heights that a flat cutter distinguishes."""

CORNER_SLICES = 6
"""Number of slices of a rounded end."""

BLURRED_SLICES = 8
"""Number of even slices used where there are more heights than MOST_LEVELS, as on a ramp."""

NEAR = 8
"""Distance from a solid sample, in samples, within which exact outlines are used."""

MOST_CANDIDATES = 96


class Ring(NamedTuple):
    """Samples of the height map on the front half of a ring."""

    heights: Floats
    """Stock height at each sample, (S,), mm."""
    owner: Ints
    """Number of the move that last cut each sample, (S,)."""


class RimBuffers(NamedTuple):
    """Working buffers for the engagement at one station."""

    arcs: Intervals
    total: Intervals
    turns: Floats
    """Cosine and sine of the angle of each sample, (S, 2)."""
    wide: Ring
    """Ring around the tool's greatest radius; read once at a station."""
    inner: Ring
    """Ring around a part of the tool with a smaller radius; read anew for each."""
    solid: Ints
    """Distance from each sample to the nearest solid sample, in samples, (S,)."""
    bounds: Floats
    """Heights that separate the slices, (MOST_LEVELS + CORNER_SLICES + 3,), mm."""
    areas: Floats
    """Section of each slice, mm²."""
    candidates: Ints
    """Numbers of the moves whose outlines have been used, (MOST_CANDIDATES,)."""


class RimTool(NamedTuple):
    """Cutter data needed to determine the contact at the rim."""

    profile: CutterProfile
    sine: float
    """Sine of the cutting edge angle κ of the flank."""
    side: float
    """Direction of rotation: 1 clockwise, −1 counter-clockwise."""


class Pose(NamedTuple):
    """Position of the tip and direction of its feed."""

    x: float
    y: float
    z: float
    ahead_x: float
    ahead_y: float
    """Y component of the unit vector of the feed in the XY plane."""
    climb: float
    """Rise of the path per mm in the XY plane."""


def room_for(samples: int) -> RimBuffers:
    """Allocate the working buffers for the engagement at one station."""
    return RimBuffers(
        intervals(),
        intervals(),
        turns_of(samples),
        Ring(np.empty(samples), np.empty(samples, dtype=np.int64)),
        Ring(np.empty(samples), np.empty(samples, dtype=np.int64)),
        np.empty(samples, dtype=np.int64),
        np.empty(MOST_LEVELS + CORNER_SLICES + 3),
        np.zeros(MOST_LEVELS + CORNER_SLICES + 3),
        np.empty(MOST_CANDIDATES, dtype=np.int64),
    )


def turns_of(samples: int) -> Floats:
    """Cosine and sine of the angles of a number of samples on the front half, (S, 2)."""
    angles = (np.arange(samples) + 0.5) * (pi / samples)
    return np.column_stack((np.cos(angles), np.sin(angles)))


@kernel
def circle_of(pose: Pose, radius: float, side: float) -> ToolCircle:
    """Circular section of the tool at a pose with a given radius."""
    return ToolCircle(pose.x, pose.y, radius, pose.ahead_x, pose.ahead_y, side)


@kernel
def read_ring(
    grid: HeightGrid, ring: Ring, turns: Floats, circle: ToolCircle, gap: float
) -> None:
    """Read heights and owners on the front half of a ring around a circle."""
    radius = circle.radius + gap
    columns, rows = grid.heights.shape
    # Positions in cells; products with the reciprocal spare two divisions a sample.
    in_x, in_y = 1.0 / grid.dx, 1.0 / grid.dy
    x, y = (circle.x - grid.x) * in_x, (circle.y - grid.y) * in_y
    onward_x, onward_y = radius * circle.ahead_x * in_x, radius * circle.ahead_y * in_y
    across = radius * circle.side
    across_x, across_y = -across * circle.ahead_y * in_x, across * circle.ahead_x * in_y
    for index in range(len(ring.heights)):
        cosine, sine = turns[index, 0], turns[index, 1]
        at_x = x + sine * onward_x + cosine * across_x
        at_y = y + sine * onward_y + cosine * across_y
        if 0.0 <= at_x < columns and 0.0 <= at_y < rows:
            column, row = int(at_x), int(at_y)
            ring.heights[index] = grid.heights[column, row]
            ring.owner[index] = grid.owner[column, row]
        else:
            ring.heights[index] = grid.bottom
            ring.owner[index] = OUTSIDE


@kernel
def cell_at(
    grid: HeightGrid, circle: ToolCircle, radius: float, angle: float
) -> tuple[float, int]:
    """Height and owner of the cell at an angle φ and a distance from the tool axis."""
    across, onward = circle.side * radius * cos(angle), radius * sin(angle)
    x = circle.x + onward * circle.ahead_x - across * circle.ahead_y
    y = circle.y + onward * circle.ahead_y + across * circle.ahead_x
    column, row = floor((x - grid.x) / grid.dx), floor((y - grid.y) / grid.dy)
    if 0 <= column < grid.heights.shape[0] and 0 <= row < grid.heights.shape[1]:
        return float(grid.heights[column, row]), int(grid.owner[column, row])
    return grid.bottom, OUTSIDE


@kernel
def levels(work: RimBuffers, base: float) -> int:
    """Divide a flat cutter into slices at the heights on its widest ring, or evenly.

    Returns the number of slices.
    """
    bounds = work.bounds
    bounds[0] = base
    count, top = 0, base
    for height in work.wide.heights:
        top = max(top, height)
        if height <= base + LEAST or count > MOST_LEVELS:
            continue
        place = count + 1
        while bounds[place - 1] > height + LEAST:
            place -= 1
        if abs(bounds[place - 1] - height) <= LEAST:
            continue
        if count == MOST_LEVELS:
            count += 1
            continue
        for index in range(count, place - 1, -1):
            bounds[index + 1] = bounds[index]
        bounds[place] = height
        count += 1
    if count > MOST_LEVELS:
        count = BLURRED_SLICES
        for index in range(1, count + 1):
            bounds[index] = base + (top - base) * index / count
    return count
