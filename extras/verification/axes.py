"""Axes that a log stamps separately: values that are only held are told from measured ones.

An agent may give each axis its own time. A row of the log then has one new coordinate, and the
last values of the others, so that the path looks like a staircase. Where single axes change
in turn, a coordinate that does not change is unknown; it is interpolated later.
"""

import numpy as np

from simulator.motion.segments import Bools, Floats

FEWEST = 4
"""Fewest rows in succession, each with a change of another axis than before, that are a
staircase; a step from pass to pass has fewer."""

AROUND = 3
"""Rows before and after within which an axis must change for its held value to be unknown."""


def without_held(position: Floats) -> Floats:
    """Positions with NaN for values that are only held, (N, 3).

    Parameters
    ----------
    position : (N, 3) array, mm
        NaN where a value is missing.
    """
    has_changed = np.zeros(position.shape, dtype=np.bool_)
    has_changed[1:] = np.diff(position, axis=0) != 0.0
    has_changed &= np.isfinite(position)
    rows = np.flatnonzero(has_changed.any(axis=1))
    if len(rows) < FEWEST:
        return position
    found = position.copy()
    stairs = np.zeros(len(position), dtype=np.bool_)
    stairs[rows] = _in_turn(has_changed[rows])
    for axis in range(position.shape[1]):
        changes = has_changed[:, axis]
        is_held = stairs & ~changes & _before(changes) & _before(changes[::-1])[::-1]
        found[is_held, axis] = np.nan
    return found


def _in_turn(has_changed: Bools) -> Bools:
    """True if rows belong to a run in which single axes change in turn, (N,)."""
    is_single = has_changed.sum(axis=1) == 1
    axis = has_changed.argmax(axis=1)
    turns = is_single[1:] & is_single[:-1] & (axis[1:] != axis[:-1])
    edges = np.flatnonzero(np.diff(np.concatenate(([False], turns, [False])).astype(np.int8)))
    found = np.zeros(len(has_changed), dtype=np.bool_)
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if end - begin >= FEWEST:
            found[begin : end + 1] = True
    return found


def _before(changes: Bools) -> Bools:
    """True if there is a change in one of the rows before each, (N,)."""
    found = np.zeros_like(changes)
    for shift in range(1, AROUND + 1):
        found[shift:] |= changes[:-shift]
    return found
