"""A box as twelve triangles."""

from itertools import product

import numpy as np

from simulator.motion.segments import Floats

Point = tuple[float, float, float]


def box(low: Point, high: Point) -> Floats:
    corners = np.array([
        [(low, high)[side][axis] for axis, side in enumerate(sides)]
        for sides in product((0, 1), repeat=3)
    ])
    quads = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
    return np.array([
        corners[list(each)] for a, b, c, d in quads for each in ((a, b, c), (a, c, d))
    ])
