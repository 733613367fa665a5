"""Programmed path as chords, each with its segment, for the sweep of a tool.

Arcs become chords that deviate by at most ``SAGITTA``, so that programmed and logged positions
are removed by the same code. Units mm and rad.

Zero of a log: distance of positions from the programmed path, and a fit of the offset.

The fit takes whole millimetres only. A constant error of less than half a millimetre cannot
hide in it: it stays in the deviations. Units mm.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Bools, Floats, Ints, Segments, chained
from simulator.removal.cutter import Cutter, Insert

SAGITTA = 1e-4
"""Greatest deviation of a chord from its arc, mm."""

COARSEST = 0.1
"""Greatest angle of one chord of an arc, rad."""

ROWS = 13
"""Columns of the rows that removal takes; lines use the first six and the last."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgrammedRun:
    """Consecutive moves of one tool in one workingstep."""

    cutter: Cutter | Insert | None
    """Shape of the tool; None if it removes nothing that is modelled."""
    tool: int
    workingstep: int
    """Index of the workingstep, from 0."""
    segments: Segments


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgrammedPath:
    """Path of a program: S segments as N chords."""

    runs: tuple[ProgrammedRun, ...]
    chords: tuple[Floats, ...]
    """Corner points of the chords of each run, (K + 1, 3), mm."""
    segment: Ints
    """Segment of each chord, (N,)."""
    workingstep: Ints
    """Workingstep of each segment, (S,)."""
    block: Ints
    """Block of each segment, (S,)."""
    radius: Floats
    """Radius of each segment, (S,), mm; infinite for a line."""
    turn: Floats
    """Angle by which the path turns at the start of each segment, (S,), rad."""
    station: Floats
    """Way along the path to the start of each segment, (S,), mm."""
    chord_station: Floats
    """Way along the path to the start of each chord, (N,), mm."""
    is_plunge: Bools
    """Whether a segment is parallel to the axis of the tool, (S,)."""


def programmed_path(runs: Iterable[ProgrammedRun]) -> ProgrammedPath:
    """Prepare the path of a program for its sweep.

    Parameters
    ----------
    runs : iterable of ProgrammedRun
        In order of execution; at least one.
    """
    kept = tuple(run for run in runs if len(run.segments))
    chords, owners, first = [], [], 0
    for run in kept:
        points, owner = chorded(run.segments)
        chords.append(points)
        owners.append(owner + first)
        first += len(run.segments)
    whole = chained([run.segments for run in kept])
    counts = [len(run.segments) for run in kept]
    segment = np.concatenate(owners)
    way = np.linalg.norm(np.concatenate([np.diff(each, axis=0) for each in chords]), axis=1)
    chord_station = np.cumsum(way) - way
    flat = np.hypot(*(whole.end - whole.start)[:, :2].T)
    return ProgrammedPath(
        runs=kept,
        chords=tuple(chords),
        segment=segment,
        workingstep=np.repeat([run.workingstep for run in kept], counts),
        block=np.concatenate([run.segments.block for run in kept]),
        radius=np.where(whole.turn == 0.0, np.inf, whole.radius),
        turn=_turns(whole),
        station=chord_station[np.searchsorted(segment, np.arange(len(whole)))],
        chord_station=chord_station,
        is_plunge=(flat < 1e-6) & (whole.turn == 0.0),
    )


def chorded(segments: Segments) -> tuple[Floats, Ints]:
    """Corner points of segments as chords, (K + 1, 3) in mm, and the segment of each chord."""
    radius = np.maximum(segments.radius, SAGITTA)
    step = np.minimum(np.sqrt(8.0 * SAGITTA / radius), COARSEST)
    counts = np.maximum(np.ceil(np.abs(segments.turn) / step), 1.0).astype(np.int64)
    rows = np.repeat(np.arange(len(segments)), counts)
    index = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (index + 1.0) / counts[rows]
    points = segments.position(rows, share * segments.length[rows])
    return np.concatenate((segments.start[:1], points)), rows


def rows_between(points: Floats) -> Floats:
    """Rows of the lines through points, as removal takes them, (N - 1, 13)."""
    rows = np.zeros((max(len(points) - 1, 0), ROWS))
    rows[:, 0:3], rows[:, 3:6], rows[:, 12] = points[:-1], points[1:], 2.0
    return rows


def pieces_of(points: Floats, longest: float) -> tuple[Floats, Floats, Ints, Floats]:
    """Divide the lines through points into pieces.

    Parameters
    ----------
    points : (N, D) array, mm
    longest : float, mm
        Greatest length of a piece.

    Returns
    -------
    start, piece : (M, D) array, mm
        Start and vector of each piece.
    line : (M,) array of int
    way : (M,) array, mm
        Way from the start of the line to the middle of the piece.
    """
    return divided(points[:-1], np.diff(points, axis=0), longest)


def divided(
    begin: Floats, along: Floats, longest: float
) -> tuple[Floats, Floats, Ints, Floats]:
    """Divide lines, given by their start and vector, as :func:`pieces_of` does."""
    way = np.linalg.norm(along, axis=1)
    counts = np.maximum(np.ceil(way / longest), 1.0).astype(np.int64)
    rows = np.repeat(np.arange(len(along)), counts)
    index = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    piece = along[rows] / counts[rows, None]
    start = begin[rows] + index[:, None] * piece
    return start, piece, rows, (index + 0.5) * (way / counts)[rows]


def _turns(segments: Segments) -> Floats:
    """Angle between each segment and the one before, (S,), rad; half a turn at the start."""
    rows = np.arange(len(segments))
    begin = segments.direction(rows, np.zeros(len(rows)))
    end = segments.direction(rows, segments.length)
    cosine = np.clip(np.sum(end[:-1] * begin[1:], axis=1), -1.0, 1.0)
    return np.concatenate(([pi], np.arccos(cosine)))


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
