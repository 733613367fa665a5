"""A turning insert and its path in the form of :mod:`simulator.removal.lathe_carve`.

Units mm and rad.
"""

from math import inf, pi, sin, tan

import numpy as np

from simulator.errors import SimulationError
from simulator.motion.segments import Floats, Segments
from simulator.removal.cutter import Insert
from simulator.removal.lathe_carve import Body
from simulator.removal.lathe_windows import Windows

ZX_NORMAL = 1
"""axis across the half plane of the lathe"""

UPRIGHT = 0.5 * pi - 1e-9
"""rad; steeper edges overhang and count as upright"""


def body_of(insert: Insert) -> Body:
    """Curve of an insert."""
    back, front = (_edge(insert.nose_radius, angle) for angle in insert.edge_angles)
    return Body(insert.nose_radius, insert.flat, *back, *front)


def _edge(nose: float, angle: float) -> tuple[float, float]:
    """Slope of an edge, and where it leaves the nose; upright from 90° on."""
    return (inf, nose) if angle >= UPRIGHT else (tan(angle), nose * sin(angle))


def ways_of(segments: Segments, windows: Windows, insert: Insert) -> Floats:
    """Ways of the centre of the nose, one a stretch; mirrored for a bore.

    Parameters
    ----------
    segments : Segments
        Of the programmed point.
    windows : Windows
    insert : Insert

    Returns
    -------
    (M, 9) array
        Rows of :class:`~simulator.removal.lathe_carve.Way`.

    Raises
    ------
    SimulationError
        When an arc lies in another plane than ZX.
    """
    _require_plane(segments)
    rows = windows.segment
    mirror = -1.0 if insert.is_inside else 1.0
    shift_x, shift_z = insert.centre
    start = segments.position(rows, windows.start)
    end = segments.position(rows, windows.end)
    centre = segments.centre[rows]
    arm = start - centre
    begin = np.arctan2(mirror * arm[:, 0], arm[:, 2])
    length = segments.length[rows]
    part = np.divide(windows.length, length, out=np.zeros(len(rows)), where=length > 0.0)
    turn = mirror * segments.turn[rows] * part
    return np.column_stack((
        start[:, 2] + shift_z,
        mirror * (start[:, 0] + shift_x),
        end[:, 2] + shift_z,
        mirror * (end[:, 0] + shift_x),
        centre[:, 2] + shift_z,
        mirror * (centre[:, 0] + shift_x),
        segments.radius[rows],
        np.minimum(begin, begin + turn),
        np.abs(turn),
    ))


def _require_plane(segments: Segments) -> None:
    """Arcs must lie in the half plane."""
    wrong = np.flatnonzero((segments.turn != 0.0) & (segments.normal != ZX_NORMAL))
    if len(wrong):
        block = segments.block[wrong[0]]
        raise SimulationError(f"block {block}: an arc of a turning tool must lie in plane ZX")
