"""Preview of the cut ahead: the force that the program expects at an override of 1.

No law with feedback alone can avoid the doubled force where the depth doubles, but the program
knows of it in advance. Its timing is not exact, so each look ahead takes the greatest force
within one revolution before and after. Units: s, N.
"""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.physics.tooth_means import Arcs

Values = NDArray[np.float32] | NDArray[np.float64]

NEARBY = 3
"""Rows that are looked at one by one before all of them are searched."""

_FEW = 7  # values that numpy, too, adds up in order

LOOK_AHEAD = 8
"""Default look-ahead, revolutions.

With fewer the force overshoots, with more feed is lost (docs/closed_loop.md).
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expected:
    """Expected values in the tooth periods of a revolution, by tooth number."""

    force: NDArray[np.float64]
    """Expected force at an override of 1, (z,), N."""
    change: NDArray[np.float64]
    """Greatest change of that force from the previous or to the next tooth period, (z,), N."""
    arcs: Arcs
    """Arcs of contact of the teeth, (z,)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Preview:
    """Expected force as a function of program time, at an override of 1.

    Raises
    ------
    ValueError
        When shapes differ, times do not ascend or a force is negative or not finite.
    """

    until: NDArray[np.float64]
    """Times at which each stretch of equal force ends, (N,), s."""
    force: Values
    """Force at override 1 with the catalogue's k_c, (N,), N; 0 in air."""
    peak: Values | None = None
    """Greatest force across the axis over the mean force, (N,); None: 1."""
    wall: Values | None = None
    """Force normal to the wall that an edge forms, over the mean force, (N,); None: 0."""
    workingstep: NDArray[np.int64] | None = None
    """Number of the workingstep, counted from 1, (N,); None: 1."""
    weight: NDArray[np.float64] | None = None
    """Factors that the forces contain already, (N,), of equivalent forces; None: 1."""
    land_force: Values | None = None
    """Force that 1 mm of flank wear adds at any override, (N,), N; None: not known."""
    arcs: Arcs | None = None
    """Arcs of contact, (N,); None: not known."""
    _ends: "memoryview[Any]" = field(init=False, repr=False)
    """The times, as Python reads single ones fastest."""
    _force: "memoryview[Any]" = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_ends", self.until.data)
        object.__setattr__(self, "_force", self.force.data)
        if self.until.shape != self.force.shape or self.until.ndim != 1 or not len(self.until):
            raise ValueError("a preview needs equal numbers of forces and times, at least one")
        if not (np.diff(self.until) > 0.0).all():
            raise ValueError("the times of a preview must ascend")
        if not (np.isfinite(self.force).all() and (self.force >= 0.0).all()):
            raise ValueError("the forces of a preview must be finite and not negative")

    def mean(self, begin: float, end: float) -> float:
        """Mean expected force between two program times, over the stretches touched, N."""
        first, beyond = self._rows(begin, end)
        return average(self.force[first:beyond])

    def mean_land(self, begin: float, end: float) -> float:
        """Force that 1 mm of flank wear adds between two program times, N; 0: not known."""
        if self.land_force is None:
            return 0.0
        first, beyond = self._rows(begin, end)
        return average(self.land_force[first:beyond])

    def expected(self, begin: float, end: float, *, teeth: int, first: int) -> Expected | None:
        """Expected values in each tooth period of a revolution; None if no arc is known.

        Parameters
        ----------
        begin, end : float, s
            Program times at which the revolution begins and ends.
        teeth : int
        first : int
            Number of the tooth whose period comes first.
        """
        if self.arcs is None:
            return None
        until, final, way = self._ends, len(self._ends) - 1, end - begin
        # Lists, as numpy takes several times as long for the few teeth of a cutter.
        middles = [begin + way * ((each + 0.95) / teeth) for each in range(-1, teeth + 1)]
        rows = [min(bisect_left(until, middle), final) for middle in middles]
        force = [self._force[row] for row in rows]
        steps = [abs(after - before) for before, after in pairwise(force)]
        order = [(tooth - first) % teeth for tooth in range(teeth)]
        return Expected(
            force=np.array([force[place + 1] for place in order]),
            change=np.array([max(steps[place : place + 2]) for place in order]),
            arcs=self.arcs.rows([rows[place + 1] for place in order]),
        )

    def is_air(self, progress: float, *, revolution: float) -> bool:
        """True if no chip is expected within one revolution before and after a program time."""
        first, beyond = self._rows(progress - revolution, progress + revolution)
        # Chips mostly begin with the first row: Python then stops sooner than numpy starts.
        return not any(self.force[first:beyond].data)

    def weight_between(self, begin: float, end: float) -> float:
        """Mean weight of the cut between two program times, weighted by force.

        A sliver with a great weight and hardly any force therefore counts little.
        """
        if self.weight is None:
            return 1.0
        first, beyond = self._rows(begin, end)
        if beyond == first + 1:
            force = float(self.force[first])
            plain = float(self.force[first] / self.weight[first])
            return force / plain if plain > 0.0 else 1.0
        if beyond - first > _FEW:
            forces = self.force[first:beyond]
            plain = float((forces / self.weight[first:beyond]).sum())
            return float(forces.sum()) / plain if plain > 0.0 else 1.0
        # A tooth period touches two cells, for which numpy takes ten times as long.
        whole = plain = 0.0
        rows = self.force[first:beyond].tolist(), self.weight[first:beyond].tolist()
        for force, weight in zip(*rows, strict=True):
            whole += force
            plain += force / weight
        return whole / plain if plain > 0.0 else 1.0

    def ahead(self, progress: float, *, revolution: float, count: int) -> tuple[float, ...]:
        """Greatest expected force around each of the next revolutions, N.

        Parameters
        ----------
        progress : float, s
            Present program time.
        revolution : float, s
            Program time of one spindle revolution at the present override.
        count : int
            Revolutions to look ahead.

        Returns
        -------
        tuple of float
            Entry j covers j − 1 to j + 2 revolutions from now: the j-th revolution, with one
            before and one after it.
        """
        edges = progress + revolution * np.arange(-1.0, count + 2.0)
        rows = np.minimum(self.until.searchsorted(edges, side="right"), len(self.until) - 1)
        single = np.maximum.reduceat(self.force, rows)[:-1]
        # If two edges lie in one row, the range is that row; the next edge's row counts too.
        single = np.maximum(single, self.force[rows[1:]])
        guarded = np.maximum(np.maximum(single[:-2], single[1:-1]), single[2:])
        values: list[float] = guarded.tolist()
        return tuple(values)

    def _rows(self, begin: float, end: float) -> tuple[int, int]:
        until, final = self._ends, len(self._ends) - 1
        first = min(bisect_right(until, begin), final)
        # A tooth period touches one row or two: no search through all of them.
        for last in range(first, min(first + NEARBY, final)):
            if end <= until[last]:
                return first, last + 1
        last = bisect_left(until, end)
        return first, max(min(last, final), first) + 1


def average(values: Values) -> float:
    """Mean as numpy's method gives it, which takes several times as long for a few values.

    Parameters
    ----------
    values : (N,) array
        At least one.
    """
    return float(np.add.reduce(values) / len(values))
