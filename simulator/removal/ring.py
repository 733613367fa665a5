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
from simulator.removal.profile import CutterProfile
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


class RimBuffers(NamedTuple):
    """Working buffers for the engagement at one station."""

    arcs: Intervals
    total: Intervals
    heights: Floats
    """Stock height at each sample of the ring, (S,), mm."""
    owner: Ints
    """Number of the move that last cut each sample of the ring, (S,)."""
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
        np.empty(samples),
        np.empty(samples, dtype=np.int64),
        np.empty(samples, dtype=np.int64),
        np.empty(MOST_LEVELS + CORNER_SLICES + 3),
        np.zeros(MOST_LEVELS + CORNER_SLICES + 3),
        np.empty(MOST_CANDIDATES, dtype=np.int64),
    )


@kernel
def circle_of(pose: Pose, radius: float, side: float) -> ToolCircle:
    """Circular section of the tool at a pose with a given radius."""
    return ToolCircle(pose.x, pose.y, radius, pose.ahead_x, pose.ahead_y, side)


@kernel
def read_ring(grid: HeightGrid, work: RimBuffers, circle: ToolCircle, gap: float) -> None:
    """Read heights and owners on the front half of a ring around a circle."""
    samples = len(work.heights)
    radius = circle.radius + gap
    step = pi / samples
    turn_cos, turn_sin = cos(step), sin(step)
    across, onward = radius * cos(0.5 * step) * circle.side, radius * sin(0.5 * step)
    turn_sin *= circle.side
    columns, rows = grid.heights.shape
    for index in range(samples):
        x = circle.x + onward * circle.ahead_x - across * circle.ahead_y
        y = circle.y + onward * circle.ahead_y + across * circle.ahead_x
        column, row = floor((x - grid.x) / grid.dx), floor((y - grid.y) / grid.dy)
        if 0 <= column < columns and 0 <= row < rows:
            work.heights[index] = grid.heights[column, row]
            work.owner[index] = grid.owner[column, row]
        else:
            work.heights[index] = grid.bottom
            work.owner[index] = OUTSIDE
        across, onward = (
            across * turn_cos - onward * turn_sin,
            onward * turn_cos + across * turn_sin,
        )


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
    """Divide a flat cutter into slices at the heights found on its ring, or evenly.

    Returns the number of slices.
    """
    bounds = work.bounds
    bounds[0] = base
    count, top = 0, base
    for height in work.heights:
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
