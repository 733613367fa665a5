"""Mean force in the period of each tooth of a milling cutter with unequal teeth.

This is what a dynamometer shows from the entry of one tooth to that of the next. It is fast
enough for each revolution of a run: arcs are sampled at points instead of integrating along
each edge as in :mod:`simulator.physics.tooth_forces`, which defines the model. Units mm, rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, inf, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.kernels.kernel import kernel

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

POINTS = 16
"""Number of points on a contact arc."""

_LAGS = 3.0  # number of time constants after which the response has decayed

LOST = -1e6
"""Offset of a broken tooth, mm, so low that it cuts nothing."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arcs:
    """Contact arcs at N times."""

    entry_angle: Floats | Singles
    """Entry angle φ_st, (N,), rad."""
    exit_angle: Floats | Singles
    """Exit angle φ_ex, (N,), rad; not above the entry angle if the arc is unknown."""
    lag: Floats | Singles
    """Lag of the upper end of the engaged edges behind their tips, (N,), rad."""

    @property
    def are_known(self) -> bool:
        """True if the arc is known at every time."""
        return bool((self.exit_angle > self.entry_angle).all())

    def rows(self, rows: Sequence[int] | NDArray[np.int64]) -> "Arcs":
        """Select the arcs at some of the times."""
        at, found = np.asarray(rows), np.empty((3, len(rows)))
        entry, exit_, lag = found
        entry[:], exit_[:], lag[:] = self.entry_angle[at], self.exit_angle[at], self.lag[at]
        return Arcs(entry_angle=entry, exit_angle=exit_, lag=lag)


class Periods(NamedTuple):
    """Tooth periods of a revolution, prepared for many sets of offsets; a tuple for kernels."""

    feed_per_tooth: Floats
    """Feed per tooth f_z, (z,), mm."""
    exponent: float
    """Exponent q = 1 − m_c of the force law."""
    sine: Floats
    """Values of sin φ at the points of the arc in each period, (z, P)."""
    weight: Floats
    """Share of a period in which the k-th previous tooth is at a point, (z, K, P)."""
    cutting: NDArray[np.int64]
    """Number of the k-th previous tooth in each period, (z, K)."""
    equal: Floats
    """Force of equal teeth in each period, over ``K·k_c1.1·f_z^q``, (z,)."""


def periods(
    arcs: Arcs, *, feed_per_tooth: Floats, exponent: float, delay: float = 0.0
) -> Periods:
    """Prepare the tooth periods of a revolution.

    Parameters
    ----------
    arcs : Arcs
        Arcs of length z, one for the period of each tooth, by tooth number.
    feed_per_tooth : (z,) array, mm
        Greater than 0.
    exponent : float
        Exponent q, above 0 and at most 1.
    delay : float, rad
        Rotation of the cutter within the time constant of the dynamometer.
    """
    return Periods(
        feed_per_tooth,
        float(exponent),
        *_prepared(
            *(
                np.asarray(each, dtype=np.float64).tobytes()
                for each in (arcs.entry_angle, arcs.exit_angle, arcs.lag)
            ),
            float(exponent),
            delay,
        ),
    )


# In a straight cut all revolutions have the same arcs; the key holds all that the values
# depend on, so nothing makes an entry invalid.
@lru_cache(maxsize=64)
def _prepared(
    entry_angle: bytes, exit_angle: bytes, lag_angle: bytes, exponent: float, delay: float
) -> tuple[Floats, Floats, NDArray[np.int64], Floats]:
    """Quantities that depend on the arcs, as bytes of (z,) arrays: see :class:`Periods`."""
    begin, end, lags = (np.frombuffer(each) for each in (entry_angle, exit_angle, lag_angle))
    teeth = len(begin)
    pitch = 2.0 * pi / teeth
    contact = (end - begin)[:, None]
    passed = contact * ((np.arange(POINTS) + 0.5) / POINTS)
    # The ends of a straight edge are placed one point apart, so that no point is lost or
    # doubled; the excess length lies half before and half behind.
    lag = np.maximum(lags[:, None], contact / POINTS)
    low = passed + 0.5 * (lags[:, None] - lag)
    reach = float((contact + lag).max()) + _LAGS * delay
    before = np.arange(min(max(ceil(reach / pitch), 1), teeth))
    ends = pitch * np.arange(len(before) + 1)[:, None]
    share = _passed(ends - low[:, None, :], lag[:, None, :], delay)
    share[:, 0], share[:, -1] = 0.0, 1.0
    weight = np.diff(share, axis=1) * (contact / (POINTS * pitch))[:, None, :]
    sine = np.sin(begin[:, None] + passed).clip(min=0.0)
    cutting = (np.arange(teeth)[:, None] - before) % teeth
    equal: Floats = (weight.sum(axis=1) * sine**exponent).sum(axis=1)
    return sine, weight, cutting, equal


def _passed(angle: Floats, lag: Floats, delay: float) -> Floats:
    """Share of a lagging edge already measured when its tip is at an angle past a point.

    This is the distribution of the sum of a uniform delay, along the edge, and an exponential
    one.
    """
    on, beyond = angle.clip(min=0.0), (angle - lag).clip(min=0.0)
    share: Floats = (on - beyond) / lag
    if delay > 0.0:
        share -= delay / lag * (np.exp(-beyond / delay) - np.exp(-on / delay))
    return share


@kernel
def means_of(at: Periods, offsets: Floats, means: Floats) -> None:
    """Mean force in the period of each tooth, over that of equal teeth; for kernels.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``, as
    :func:`simulator.physics.tooth_forces.forces` does.

    Parameters
    ----------
    offsets : (z,) array, mm
        Assumed radius of each tooth minus the nominal radius; ``LOST`` if broken.
    means : (z,) array
        The result. Period j is the time in which tooth j is the last that has entered.

    Examples
    --------
    Four teeth on a short arc, so that each is alone in its period; one tooth is lost:

    >>> thin = Arcs(entry_angle=np.full(4, 3.0), exit_angle=np.full(4, 3.1), lag=np.zeros(4))
    >>> four = periods(thin, feed_per_tooth=np.full(4, 0.1), exponent=1.0)
    >>> means = np.empty(4)
    >>> means_of(four, np.array([0.0, LOST, 0.0, 0.0]), means)
    >>> means.round(6)
    array([1., 0., 2., 1.])
    """
    for period in range(offsets.shape[0]):
        force = 0.0
        for back in range(at.cutting.shape[1]):
            tooth = at.cutting[period, back]
            for point in range(at.sine.shape[1]):
                weight = at.weight[period, back, point]
                if weight != 0.0:
                    force += weight * _chip(at, offsets, period, (tooth, point)) ** at.exponent
        means[period] = force / at.equal[period]


@kernel
def _chip(at: Periods, offsets: Floats, period: int, where: tuple[int, int]) -> float:
    """Chip of a tooth at a point of the arc over the feed per tooth."""
    (tooth, point), teeth, chip = where, offsets.shape[0], inf
    for step in range(1, teeth + 1):
        # An index below 0 counts from the end, in kernels too.
        higher = offsets[tooth] - offsets[tooth - step]
        chip = min(chip, step * at.sine[period, point] + higher / at.feed_per_tooth[period])
    return max(chip, 0.0)
