"""Share of each tooth in the force of a revolution, with its uncertainty.

Shares do not depend on depth or k_c, which act on all teeth alike. Units: mm, s, N, rad, rev/s.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import isfinite, pi

import numpy as np

from controller.signals.ports import Floats
from controller.signals.preview import Expected, average
from controller.signals.signal import Revolution
from simulator.kernels.kernel import entry, kernel
from simulator.physics.tooth_means import Periods, means_of, periods

READING = 0.011
"""Relative standard deviations of a tooth period's mean by dynamometer and model.

They apply to the mean force of the revolution and to the tooth's own force.
"""

FLOOR = 0.5
"""Standard deviation of the mean of a tooth period at any force, N."""

MISSED = 4.0
"""Standard deviation of a share per share of lost samples; samples vary within a period."""

JITTER = 0.5
"""Error of the expected force over its change to the next tooth period.

It covers places where depth or width change.
"""

DRIFT = 0.02
"""Least relative standard deviation of the force change within a revolution.

It is at least the change since the previous revolution.
"""

ENTRY = 0.2
"""Relative standard deviation of the force change without a previous revolution."""

EARLY = 0.05
"""Standard deviation of the entry of teeth, in tooth periods."""

LAG = 0.0005
"""Delay of the dynamometer assumed by the loop, s; the real one may differ."""

LEAST_CHIP = 0.005
"""Feed per tooth below which edges rub and nothing is judged, mm."""

_LEAST = 1e-9  # N, avoids division by zero


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToothShares:
    """Measured shares of the teeth in the force of a revolution."""

    taken: Floats
    """Mean force in the period of each tooth over the mean of all, (z,)."""
    noise: Floats
    """Covariance of the errors of the shares, (z, z)."""
    expected: Floats
    """Force that equal teeth would take, (z,), N."""
    periods: Periods

    def of(self, offsets: Floats) -> Floats:
        """Shares that (M, z) guesses of the tooth offsets, mm, would give, (M, z)."""
        shares = np.empty(offsets.shape)
        _all_shares(self.periods, self.expected, np.ascontiguousarray(offsets), shares)
        return shares


@entry
def _all_shares(at: Periods, expected: Floats, offsets: Floats, shares: Floats) -> None:
    """Kernel of :meth:`ToothShares.of`."""
    for row in range(offsets.shape[0]):
        shares_into(at, expected, offsets[row], shares[row])


@kernel
def shares_into(at: Periods, expected: Floats, offsets: Floats, shares: Floats) -> None:
    """Write the shares, (z,), that (z,) offsets would give; for kernels."""
    means_of(at, offsets, shares)
    total = 0.0
    for each in range(shares.shape[0]):
        shares[each] *= expected[each]
        total += shares[each]
    mean = max(total / shares.shape[0], _LEAST)
    for each in range(shares.shape[0]):
        shares[each] /= mean


def force_ratio(revolution: Revolution, expected: Expected | None) -> float | None:
    """Measured over expected force of a revolution; None if its teeth cannot be compared.

    A revolution is not compared if a tooth, the feed or the arc of contact is missing, or if
    there is a single sample per tooth, as from the power of a drive, which is too slow.
    """
    if expected is None or revolution.samples < 2 or not revolution.force > 0.0:
        return None
    means, passing = revolution.tooth_means, revolution.teeth * revolution.spindle_speed
    # Lists, as numpy takes several times as long for the few teeth of a cutter.
    is_whole = all(map(isfinite, means.tolist())) and np.add.reduce(means) > 0.0
    is_fed = all(each > LEAST_CHIP * passing for each in revolution.tooth_feeds.tolist())
    is_known = expected.arcs.are_known and min(expected.force.tolist()) > 0.0
    if not (is_whole and is_fed and is_known):
        return None
    return revolution.force / average(expected.force)


def shares_of(
    revolution: Revolution, expected: Expected, *, exponent: float, change: float | None
) -> ToothShares:
    """Compute the shares of the teeth in the force of a revolution.

    Parameters
    ----------
    expected : Expected
        Forces that equal teeth would take.
    exponent : float
        p of force over chip.
    change : float, optional
        Change of ln(measured / expected force) since the previous revolution; None: none
    """
    teeth, means = revolution.teeth, revolution.tooth_means
    taken: Floats = means / average(means)
    per_tooth = revolution.tooth_feeds / (teeth * revolution.spindle_speed)
    # The mean of samples taken at the ends of their intervals is early by half an interval.
    delay = max(LAG - 0.5 * revolution.period / (teeth * revolution.samples), 0.0)
    drift = ENTRY if change is None else max(DRIFT, abs(change))
    return ToothShares(
        taken=taken,
        noise=_noise(revolution, expected, taken, drift=drift),
        expected=expected.force * revolution.tooth_overrides**exponent,
        periods=periods(
            expected.arcs,
            feed_per_tooth=per_tooth,
            exponent=exponent,
            delay=2.0 * pi * delay * revolution.spindle_speed,
        ),
    )


def _noise(
    revolution: Revolution, expected: Expected, taken: Floats, *, drift: float
) -> Floats:
    """Covariance of the errors of the shares, (z, z)."""
    teeth = revolution.teeth
    near = JITTER * expected.change / average(expected.force)
    even = FLOOR / average(revolution.tooth_means), MISSED * (1.0 - revolution.coverage)
    own = READING**2 * (1.0 + taken**2) + even[0] ** 2 + even[1] ** 2
    # Columns: jitter, of which an excess of one tooth shifts the mean, and with it the shares
    # of all teeth; drift; early entry.
    errors = np.empty((teeth, teeth + 2))
    errors[:, :teeth] = taken[:, None] * (near / -teeth)
    errors.flat[:: teeth + 3] += near
    errors[:, -2] = drift * taken * _places(teeth, revolution.first)
    errors[0, -1] = taken[-1] - taken[0]
    errors[1:, -1] = taken[:-1] - taken[1:]
    errors[:, -1] *= EARLY
    noise = errors @ errors.T
    noise.flat[:: teeth + 1] += own
    return noise


@lru_cache(maxsize=64)
def _places(teeth: int, first: int) -> Floats:
    """Middle of each tooth period from the middle of the revolution, in revolutions, (z,)."""
    places: Floats = ((np.arange(teeth) - first) % teeth + 0.5) / teeth - 0.5
    places.setflags(write=False)
    return places
