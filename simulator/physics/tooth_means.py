"""Mean force in the period of each tooth of a milling cutter with unequal teeth.

What a dynamometer shows from the entry of one tooth to that of the next, quick enough for each
revolution of a run: arcs by points instead of the integrals along each edge of
:mod:`simulator.physics.tooth_forces`, which holds the model. Units mm, rad.
"""

from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

POINTS = 16
"""on an arc of contact"""

_LAGS = 3.0  # time constants after which hardly anything is to come

LOST = -1e6
"""mm, offset of a tooth that has broken: it meets nothing"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arcs:
    """Arcs of contact at N times."""

    entry_angle: Floats | Singles
    """Entry angle, (N,) φ_st, rad"""
    exit_angle: Floats | Singles
    """Exit angle, (N,) φ_ex, rad; not above the entry: no arc is known"""
    lag: Floats | Singles
    """Lag, (N,) rad by which the upper end of the edges in the cut is behind their tips"""

    @property
    def are_known(self) -> bool:
        """Whether there is an arc at every time."""
        return bool((self.exit_angle > self.entry_angle).all())

    def rows(self, rows: NDArray[np.int64]) -> "Arcs":
        """Those at some of the times."""
        return Arcs(
            entry_angle=np.asarray(self.entry_angle[rows], dtype=np.float64),
            exit_angle=np.asarray(self.exit_angle[rows], dtype=np.float64),
            lag=np.asarray(self.lag[rows], dtype=np.float64),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Periods:
    """A revolution's tooth periods, prepared for many guesses of the offsets."""

    feed_per_tooth: Floats
    """(z,) f_z, mm"""
    exponent: float
    """q = 1 − m_c of force over chip"""
    sine: Floats
    """(z, P) sin φ at the points of the arc in each period"""
    weight: Floats
    """(z, K, P) share of a period in which the k-th tooth before is at a point"""
    cutting: NDArray[np.int64]
    """(z, K) which tooth that is"""


def periods(
    arcs: Arcs, *, feed_per_tooth: Floats, exponent: float, delay: float = 0.0
) -> Periods:
    """Prepare the periods of a revolution.

    Parameters
    ----------
    arcs : Arcs
        (z,), one for the period of each tooth, by number.
    feed_per_tooth : (z,) array, mm
        Above 0.
    exponent : float
        q, above 0 and at most 1.
    delay : float, rad
        That the cutter turns in the time constant of the dynamometer.
    """
    teeth = len(arcs.entry_angle)
    pitch = 2.0 * pi / teeth
    contact = (arcs.exit_angle - arcs.entry_angle)[:, None]
    passed = contact * ((np.arange(POINTS) + 0.5) / POINTS)
    # A straight edge is one whose ends are a point apart, so that no point is lost or doubled;
    # what it is too long by lies half before and half behind.
    lag = np.maximum(arcs.lag[:, None], contact / POINTS)
    low = passed + 0.5 * (arcs.lag[:, None] - lag)
    reach = float((contact + lag).max()) + _LAGS * delay
    before = np.arange(min(max(ceil(reach / pitch), 1), teeth))
    ends = pitch * np.arange(len(before) + 1)[:, None]
    share = _passed(ends - low[:, None, :], lag[:, None, :], delay)
    share[:, 0], share[:, -1] = 0.0, 1.0
    weight = np.diff(share, axis=1) * (contact / (POINTS * pitch))[:, None, :]
    return Periods(
        feed_per_tooth=feed_per_tooth,
        exponent=exponent,
        sine=np.sin(arcs.entry_angle[:, None] + passed).clip(min=0.0),
        weight=weight,
        cutting=(np.arange(teeth)[:, None] - before) % teeth,
    )


def _passed(angle: Floats, lag: Floats, delay: float) -> Floats:
    """Share of an edge that lags that was shown until its tip is at an angle past a point.

    Distribution of the sum of an even delay, along the edge, and of an exponential one.
    """
    on, beyond = angle.clip(min=0.0), (angle - lag).clip(min=0.0)
    share: Floats = (on - beyond) / lag
    if delay > 0.0:
        share -= delay / lag * (np.exp(-beyond / delay) - np.exp(-on / delay))
    return share


def tooth_means(at: Periods, offsets: Floats) -> Floats:
    """Mean force in the period of each tooth over that of equal teeth.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``, as
    :func:`simulator.physics.tooth_forces.forces` has it.

    Parameters
    ----------
    at : Periods
    offsets : (M, z) array, mm
        Guesses of the radius of each tooth over the nominal one; ``LOST``: broken.

    Returns
    -------
    (M, z) array
        Period j: while tooth j is the last that has entered.

    Examples
    --------
    Four teeth in a thin arc, so that each is alone in its period, and one of them lost:

    >>> thin = Arcs(entry_angle=np.full(4, 3.0), exit_angle=np.full(4, 3.1), lag=np.zeros(4))
    >>> four = periods(thin, feed_per_tooth=np.full(4, 0.1), exponent=1.0)
    >>> tooth_means(four, np.array([[0.0, LOST, 0.0, 0.0]])).round(6)
    array([[1., 0., 2., 1.]])
    """
    teeth = offsets.shape[1]
    back = (np.arange(teeth)[:, None] - np.arange(1, teeth + 1)) % teeth
    higher = offsets[:, :, None] - offsets[:, back]
    steps = np.arange(1.0, teeth + 1.0)[:, None] * at.sine[:, None, None, :]
    over = higher[:, at.cutting] / at.feed_per_tooth[:, None, None]
    chips = (steps + over[..., None]).min(axis=3).clip(min=0.0)
    force = (at.weight * chips**at.exponent).sum(axis=(2, 3))
    equal = (at.weight.sum(axis=1) * at.sine**at.exponent).sum(axis=1)
    means: Floats = force / equal
    return means
