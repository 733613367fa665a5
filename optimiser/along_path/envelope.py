"""Lower envelope of intervals along a path: the least of the caps that cover each place."""

from dataclasses import dataclass

import numpy as np

from simulator.kernels.kernel import entry
from simulator.motion.segments import Floats, Ints


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Envelope:
    """Least cap of each of K stretches that cover the path without gaps."""

    ends: Floats
    """End of each stretch, (K,), mm, ascending."""
    which: Ints
    """Number of the interval that gives the least cap, (K,)."""


def lower_envelope(begin: Floats, end: Floats, cap: Floats) -> Envelope:
    """Least of the caps that cover each place of a path.

    Parameters
    ----------
    begin, end : (N,) arrays, mm
        Intervals; together they cover the path from the least begin to the greatest end.
    cap : (N,) array
        Value of each interval.

    Returns
    -------
    Envelope

    Raises
    ------
    ValueError
        If the intervals leave a gap.
    """
    places = np.unique(np.concatenate((begin, end)))
    which = np.full(len(places) - 1, -1)
    links = np.arange(len(places))
    first = np.searchsorted(places, begin)
    beyond = np.searchsorted(places, end)
    _paint(np.argsort(cap, kind="stable"), first, beyond, links, which)
    if (which < 0).any():
        gap = float(places[int(np.flatnonzero(which < 0)[0])])
        raise ValueError(f"no interval covers the path after {gap:g} mm")
    lasts = np.append(np.flatnonzero(which[1:] != which[:-1]), len(which) - 1)
    return Envelope(ends=places[1:][lasts], which=which[lasts])


@entry
def _paint(order: Ints, first: Ints, beyond: Ints, links: Ints, which: Ints) -> None:
    """Give each cell the first interval of an order that covers it.

    ``links`` leads from each cell to the next one that has no interval yet; it initially holds
    the number of each cell, with one more at the end.
    """
    for interval in order:
        cell = first[interval]
        while links[cell] != cell:
            links[cell] = links[links[cell]]
            cell = links[cell]
        while cell < beyond[interval]:
            which[cell] = interval
            links[cell] = cell + 1
            cell += 1
            while links[cell] != cell:
                links[cell] = links[links[cell]]
                cell = links[cell]
