"""Mean force in the period of each tooth of a milling cutter with unequal teeth.

This is what a dynamometer shows from the entry of one tooth to that of the next. It is fast
enough for each revolution of a run: arcs are sampled at points instead of integrating along
each edge as in :mod:`simulator.physics.tooth_forces`, which defines the model. Units mm, rad.
"""

from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

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
        """Whether the arc is known at every time."""
        return bool((self.exit_angle > self.entry_angle).all())

    def rows(self, rows: NDArray[np.int64]) -> "Arcs":
        """Select the arcs at some of the times."""
        return Arcs(
            entry_angle=np.asarray(self.entry_angle[rows], dtype=np.float64),
            exit_angle=np.asarray(self.exit_angle[rows], dtype=np.float64),
            lag=np.asarray(self.lag[rows], dtype=np.float64),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Periods:
    """Tooth periods of a revolution, prepared for evaluating many sets of offsets."""

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
    teeth = len(arcs.entry_angle)
    pitch = 2.0 * pi / teeth
    contact = (arcs.exit_angle - arcs.entry_angle)[:, None]
    passed = contact * ((np.arange(POINTS) + 0.5) / POINTS)
    # The ends of a straight edge are placed one point apart, so that no point is lost or
    # doubled; the excess length lies half before and half behind.
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
    """Share of a lagging edge already measured when its tip is at an angle past a point.

    This is the distribution of the sum of a uniform delay, along the edge, and an exponential
    one.
    """
    on, beyond = angle.clip(min=0.0), (angle - lag).clip(min=0.0)
    share: Floats = (on - beyond) / lag
    if delay > 0.0:
        share -= delay / lag * (np.exp(-beyond / delay) - np.exp(-on / delay))
    return share


def tooth_means(at: Periods, offsets: Floats) -> Floats:
    """Mean force in the period of each tooth, over that of equal teeth.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``, as
    :func:`simulator.physics.tooth_forces.forces` does.

    Parameters
    ----------
    at : Periods
    offsets : (M, z) array, mm
        Assumed radius of each tooth minus the nominal radius; ``LOST`` if broken.

    Returns
    -------
    (M, z) array
        Period j is the time in which tooth j is the last that has entered.

    Examples
    --------
    Four teeth on a short arc, so that each is alone in its period; one tooth is lost:

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
