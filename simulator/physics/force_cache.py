"""Forces of a cutter at many places of a path, computed once for each different place.

A long path meets the same engagements again and again, and a plan runs it several times. Places
are told apart by µm and mrad. Units mm, rad.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.tooth_forces import Floats, Places, peak_resultant, wall_force

DIGITS = 3
"""Number of decimals to which engagements are distinguished: µm, mrad."""

KEPT = 40_000
"""Number of places that are kept for a cutter and a law: 16 bytes each."""

CUTTERS = 8
"""Number of cutters and laws of which places are kept."""

_BITS = 21  # of one of three columns in a key; angles may be negative, depths are below 2 m
_HALF = 1 << (_BITS - 1)


@dataclass
class _Table:
    """Known forces by key, in the order of keys. Mutable: the pair is replaced at once.

    A force depends on the cutter, the law and the place alone, so that none becomes invalid.
    """

    known: tuple[np.ndarray, Floats] = field(
        default_factory=lambda: (np.empty(0, dtype=np.int64), np.empty(0))
    )


def peak_at(edges: CuttingEdges, law: ForceLaw, arcs: Floats) -> Floats:
    """Greatest force across the axis, (M,), mm; see :func:`tooth_forces.peak_resultant`.

    Parameters
    ----------
    arcs : (3, M) array
        Entry angle and exit angle in rad, axial depth in mm.
    """
    return _at(peak_resultant, edges, law, arcs)


def wall_at(edges: CuttingEdges, law: ForceLaw, arcs: Floats) -> Floats:
    """Greatest force normal to a wall, (M,), mm; see :func:`tooth_forces.wall_force`."""
    return _at(wall_force, edges, law, arcs)


Greatest = Callable[[CuttingEdges, Places, ForceLaw], Floats]


def _at(greatest: Greatest, edges: CuttingEdges, law: ForceLaw, arcs: Floats) -> Floats:
    """Forces at rounded places, each of which is computed once."""
    steps = np.rint(arcs * 10.0**DIGITS).astype(np.int64)
    steps[:2] += _HALF
    if steps.size and not 0 <= steps.min() <= steps.max() < 2 * _HALF:
        return greatest(edges, _places(np.round(arcs, DIGITS)), law)
    keys = (steps[0] << 2 * _BITS) | (steps[1] << _BITS) | steps[2]
    told, first, row = np.unique(keys, return_index=True, return_inverse=True)
    table = _table(greatest, edges, law)
    known, forces = table.known
    place = np.minimum(np.searchsorted(known, told), max(len(known) - 1, 0))
    is_known = known[place] == told if len(known) else np.zeros(len(told), dtype=np.bool_)
    found = np.empty(len(told))
    found[is_known] = forces[place[is_known]]
    if not is_known.all():
        new = ~is_known
        found[new] = greatest(edges, _places(np.round(arcs[:, first[new]], DIGITS)), law)
        if len(known) + int(new.sum()) > KEPT:
            known, forces = known[:0], forces[:0]
        joined = np.concatenate((known, told[new]))
        order = np.argsort(joined, kind="stable")
        table.known = joined[order], np.concatenate((forces, found[new]))[order]
    return found[row]


@lru_cache(maxsize=CUTTERS)
def _table(_greatest: Greatest, _edges: CuttingEdges, _law: ForceLaw) -> _Table:
    """Table of a cutter, which grows."""
    return _Table()


def _places(columns: Floats) -> Places:
    return Places(entry_angle=columns[0], exit_angle=columns[1], axial_depth=columns[2])
