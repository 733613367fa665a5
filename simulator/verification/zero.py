"""Zero of a log: distance of positions from the programmed path, and a fit of the offset.

The fit takes whole millimetres only. A constant error of less than half a millimetre cannot
hide in it: it stays in the deviations. Units mm.
"""

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Floats
from simulator.verification.path import ProgrammedPath

ROUNDS = 20
"""Most rounds of the fit."""

CLOSE = 1e-4
"""Change of the offset, mm, at which the fit ends."""

PIECE = 0.25
"""Longest piece of the path whose middle stands for it, mm."""


def distance_from(positions: Floats, path: ProgrammedPath) -> Floats:
    """Distance of positions from a programmed path, (N,), mm."""
    near = _nearest(positions, path)
    return np.asarray(np.linalg.norm(positions - near, axis=1))


def fitted_zero(
    positions: Floats, path: ProgrammedPath
) -> tuple[tuple[float, float, float], Floats]:
    """Fit the position of the program's zero, in whole millimetres.

    Parameters
    ----------
    positions : (N, 3) array, mm
        Positions on the axes, in order, spread over the whole log.
    path : ProgrammedPath

    Returns
    -------
    zero : tuple of 3 floats, mm
    rest : (3,) array, mm
        Median offset of the positions from the path that the rounding leaves.
    """
    points = np.concatenate(path.chords)
    offset = np.asarray(
        0.5 * (positions.min(axis=0) + positions.max(axis=0))
        - 0.5 * (points.min(axis=0) + points.max(axis=0))
    )
    for _ in range(ROUNDS):
        moved = positions - offset
        change = np.median(moved - _nearest(moved, path), axis=0)
        offset = offset + change
        if np.abs(change).max() < CLOSE:
            break
    whole = np.round(offset)
    return (float(whole[0]), float(whole[1]), float(whole[2])), offset - whole


def _nearest(positions: Floats, path: ProgrammedPath) -> Floats:
    """Point of the path near each position, (N, 3), mm: the nearest on the nearest piece."""
    starts, pieces = [], []
    for chords in path.chords:
        along = np.diff(chords, axis=0)
        counts = np.maximum(np.ceil(np.linalg.norm(along, axis=1) / PIECE), 1.0)
        rows = np.repeat(np.arange(len(along)), counts.astype(np.int64))
        index = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts.astype(int))
        step = along[rows] / counts[rows, None]
        starts.append(chords[rows] + index[:, None] * step)
        pieces.append(step)
    start, step = np.concatenate(starts), np.concatenate(pieces)
    best = cKDTree(start + 0.5 * step).query(positions)[1]
    start, step = start[best], step[best]
    square = np.maximum(np.sum(step * step, axis=1), 1e-12)
    share = np.clip(np.sum((positions - start) * step, axis=1) / square, 0.0, 1.0)
    return np.asarray(start + share[:, None] * step)
