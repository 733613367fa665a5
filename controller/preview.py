"""Preview of the cut ahead: the force that the program expects at an override of 1.

No law that only feeds back can avoid the doubled force where the depth doubles, but the program
knows it before. What it knows is not exact in time, so that each look ahead takes the greatest
force within one revolution before and after. Units s, N.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.physics.tooth_means import Arcs

Values = NDArray[np.float32] | NDArray[np.float64]

LOOK_AHEAD = 8
"""revolutions: with fewer the force overshoots, with more feed is lost (docs/closed_loop.md)"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expected:
    """Expected values in the periods of a revolution's teeth, by their number."""

    force: NDArray[np.float64]
    """(z,) N at an override of 1"""
    change: NDArray[np.float64]
    """(z,) N, greatest change of that force to the tooth period before or after"""
    arcs: Arcs
    """(z,)"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Preview:
    """Expected force by the time of the program at an override of 1.

    Raises
    ------
    ValueError
        When shapes differ, times do not ascend or a force is negative or not finite.
    """

    until: NDArray[np.float64]
    """(N,) s at which each stretch of equal force ends"""
    force: Values
    """(N,) N at override 1 with the catalogue's k_c; 0 in air"""
    peak: Values | None = None
    """(N,) greatest force across the axis over the mean force; None: 1"""
    wall: Values | None = None
    """(N,) force normal to the wall that an edge makes, over the mean; None: 0"""
    workingstep: NDArray[np.int64] | None = None
    """(N,) counted from 1; None: 1"""
    weight: NDArray[np.float64] | None = None
    """(N,) by which forces were multiplied already, :mod:`controller.equivalent`; None: 1"""
    land_force: Values | None = None
    """(N,) N that 1 mm of flank wear adds, at any override; None: not known"""
    arcs: Arcs | None = None
    """(N,) arcs of contact; None: not known"""

    def __post_init__(self) -> None:
        if self.until.shape != self.force.shape or self.until.ndim != 1 or not len(self.until):
            raise ValueError("a preview needs as many forces as times, at least one")
        if not (np.diff(self.until) > 0.0).all():
            raise ValueError("the times of a preview must ascend")
        if not (np.isfinite(self.force).all() and (self.force >= 0.0).all()):
            raise ValueError("the forces of a preview must be finite and not negative")

    def mean(self, begin: float, end: float) -> float:
        """Expected force between two times of the program, N: mean over what they touch."""
        first, beyond = self._rows(begin, end)
        return float(self.force[first:beyond].mean())

    def mean_land(self, begin: float, end: float) -> float:
        """Force that 1 mm of flank wear adds between two times, N; 0: not known."""
        if self.land_force is None:
            return 0.0
        first, beyond = self._rows(begin, end)
        return float(self.land_force[first:beyond].mean())

    def expected(self, begin: float, end: float, *, teeth: int, first: int) -> Expected | None:
        """Expected values in each tooth period of a revolution; None: no arc is known.

        Parameters
        ----------
        begin, end : float, s
            Of the revolution, in the time of the program.
        teeth : int
        first : int
            Tooth whose period comes first.
        """
        if self.arcs is None:
            return None
        middle = (np.arange(-1.0, teeth + 1.0) + 0.95) / teeth
        rows = self.until.searchsorted(begin + (end - begin) * middle, side="left")
        rows = np.minimum(rows, len(self.until) - 1)
        force = np.asarray(self.force[rows], dtype=np.float64)
        steps = np.abs(np.diff(force))
        order = (np.arange(teeth) - first) % teeth
        return Expected(
            force=force[1:-1][order],
            change=np.maximum(steps[1:], steps[:-1])[order],
            arcs=self.arcs.rows(rows[1:-1][order]),
        )

    def is_air(self, progress: float, *, revolution: float) -> bool:
        """Whether no chip is expected within a revolution before and after a time."""
        first, beyond = self._rows(progress - revolution, progress + revolution)
        return not self.force[first:beyond].any()

    def weight_between(self, begin: float, end: float) -> float:
        """Weight of what is cut between two times of the program: mean of the forces there.

        A sliver with a great weight and hardly a force counts for what it is.
        """
        if self.weight is None:
            return 1.0
        first, beyond = self._rows(begin, end)
        forces = self.force[first:beyond]
        plain = float((forces / self.weight[first:beyond]).sum())
        return float(forces.sum()) / plain if plain > 0.0 else 1.0

    def ahead(self, progress: float, *, revolution: float, count: int) -> tuple[float, ...]:
        """Greatest expected force around each of the next revolutions, N.

        Parameters
        ----------
        progress : float, s
            Time of the program now.
        revolution : float, s
            Of the program that one revolution of the spindle takes at the present override.
        count : int
            Revolutions to look ahead.

        Returns
        -------
        tuple of float
            Entry j: from j − 1 to j + 2 revolutions after now, which is the j-th revolution
            with one before it and one behind.
        """
        edges = progress + revolution * np.arange(-1.0, count + 2.0)
        rows = np.minimum(self.until.searchsorted(edges, side="right"), len(self.until) - 1)
        single = np.maximum.reduceat(self.force, rows)[:-1]
        # What lies between two edges in one row is that row; the next edge's row is met too.
        single = np.maximum(single, self.force[rows[1:]])
        guarded = np.maximum(np.maximum(single[:-2], single[1:-1]), single[2:])
        values: list[float] = guarded.tolist()
        return tuple(values)

    def _rows(self, begin: float, end: float) -> tuple[int, int]:
        first = int(self.until.searchsorted(begin, side="right"))
        last = int(self.until.searchsorted(end, side="left"))
        first = min(first, len(self.until) - 1)
        return first, max(min(last, len(self.until) - 1), first) + 1
