"""Paths of cutters for trials of feed profiles: pocket, spiral, raster, helix, random."""

from collections.abc import Callable
from math import cos, pi, sin, tau

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Segments, arc, chained, lines

Floats = NDArray[np.float64]

SPEED = 100.0
"""commanded speed, mm/s; the trials have caps of their own"""


def pocket(rings: int = 6) -> Segments:
    """Rings with rounded corners from outside to inside, joined by straight steps."""
    parts: list[Segments] = []
    radius, step = 3.0, 4.0
    for ring in range(rings):
        left, low = step * ring, step * ring
        right, high = 80.0 - left, 60.0 - low
        start = (left + radius, low, 0.0)
        if parts:
            parts.append(lines([parts[-1].end[-1], start], speed=SPEED))
        for begin, end, centre in (
            (start, (right - radius, low, 0.0), (right - radius, low + radius)),
            (
                (right, low + radius, 0.0),
                (right, high - radius, 0.0),
                (right - radius, high - radius),
            ),
            (
                (right - radius, high, 0.0),
                (left + radius, high, 0.0),
                (left + radius, high - radius),
            ),
            (
                (left, high - radius, 0.0),
                (left, low + radius, 0.0),
                (left + radius, low + radius),
            ),
        ):
            parts.append(lines([begin, end], speed=SPEED))
            parts.append(arc(end, (*centre, 0.0), pi / 2, speed=SPEED))
    return chained(parts)


def raster(rows: int = 8) -> Segments:
    """Rows that half circles join."""
    parts: list[Segments] = []
    for row in range(rows):
        y, goes_right = 3.0 * row, row % 2 == 0
        begin, end = ((0.0, y, 0.0), (60.0, y, 0.0))[:: 1 if goes_right else -1]
        parts.append(lines([begin, end], speed=SPEED))
        if row + 1 < rows:
            turn = pi if goes_right else -pi
            parts.append(arc(end, (end[0], y + 1.5, 0.0), turn, speed=SPEED))
    return chained(parts)


def helix(turns: float = 3.0) -> Segments:
    """A helical plunge, and a full circle on its bottom."""
    down = arc((12.0, 0.0, 0.0), (0.0, 0.0, 0.0), turns * tau, rise=-4.0, speed=SPEED)
    return chained([down, arc(down.end[0].tolist(), (0.0, 0.0, 0.0), tau, speed=SPEED)])


def random_path(seed: int, *, parts: int = 14) -> Segments:
    """Lines and arcs that go on without corners, with random lengths and radii."""
    random = np.random.default_rng(seed)
    found: list[Segments] = []
    x, y, heading = 0.0, 0.0, 0.3
    for part in range(parts):
        if part % 2 == 0:
            long = float(random.uniform(2.0, 25.0))
            end = (x + long * cos(heading), y + long * sin(heading), 0.0)
            found.append(lines([(x, y, 0.0), end], speed=SPEED))
        else:
            radius = float(random.uniform(1.0, 12.0))
            turn = float(random.choice((-1.0, 1.0)) * random.uniform(0.3, 2.8))
            side = heading + (pi / 2 if turn > 0.0 else -pi / 2)
            centre = (x + radius * cos(side), y + radius * sin(side), 0.0)
            found.append(arc((x, y, 0.0), centre, turn, speed=SPEED))
            heading += turn
        x, y, _ = found[-1].end[0].tolist()
    return chained(found)


def spiral(turns: int = 8) -> Segments:
    """Half circles whose radius grows, as a spiral pocket is programmed with arcs."""
    parts: list[Segments] = []
    x = 2.0
    for half in range(2 * turns):
        radius = 2.0 + 1.0 * half
        centre = x - radius if half % 2 == 0 else x + radius
        parts.append(arc((x, 0.0, 0.0), (centre, 0.0, 0.0), pi, speed=SPEED))
        x = float(parts[-1].end[0, 0])
    return chained(parts)


PATHS: dict[str, Callable[[], Segments]] = {
    "pocket": pocket,
    "spiral": spiral,
    "raster": raster,
    "helix": helix,
    "random": lambda: random_path(7),
}


def wavy_caps(stations: Floats) -> Floats:
    """Caps on b, mm²/s², of an engagement that changes along the path."""
    feeds = 60.0 + 25.0 * np.sin(stations / 9.0) + 10.0 * np.sin(stations / 1.7)
    squares: Floats = np.maximum(feeds, 8.0) ** 2
    return squares


AXES = np.array([1000.0, 700.0, 500.0])
"""accelerations of the axes of the trials, mm/s²"""
