"""Share of each tooth in the force of a revolution, and its error.

Shares know neither depth nor k_c: both act on all teeth alike. Units mm, s, N, rad, rev/s.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from controller.ports import Floats
from controller.preview import Expected
from controller.signal import Revolution
from simulator.physics.tooth_means import Periods, periods, tooth_means

READING = 0.011
"""of the mean force, and of a tooth's own: standard deviations by which dynamometer and model
err in the mean of a tooth period"""

FLOOR = 0.5
"""N, standard deviation of that mean whatever the force"""

MISSED = 4.0
"""standard deviation of a share, times the share of samples that were lost: in a tooth period,
samples differ much"""

JITTER = 0.5
"""of the change of the expected force from one tooth period to the next: what is expected errs
by so much where depth or width change"""

DRIFT = 0.02
"""least standard deviation of what the force changes within a revolution, as a share; at least
what it changed since the one before"""

ENTRY = 0.2
"""the same in a revolution without another before it"""

EARLY = 0.05
"""of a tooth period, standard deviation of where teeth enter"""

LAG = 0.0005
"""s by which a dynamometer is late, as the loop takes it: its own may differ"""

LEAST_CHIP = 0.005
"""mm of feed per tooth below which edges rub, and nothing is judged"""

_LEAST = 1e-9  # N, so that no force at all divides


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToothShares:
    """Shares of the teeth in a revolution."""

    taken: Floats
    """(z,) mean force in the period of each tooth over the mean of all"""
    noise: Floats
    """(z, z) covariance of their errors"""
    expected: Floats
    """(z,) N that equal teeth would take"""
    periods: Periods

    def of(self, offsets: Floats) -> Floats:
        """(M, z) shares that (M, z) guesses of the offsets of the teeth in mm give."""
        force = self.expected * tooth_means(self.periods, offsets)
        shares: Floats = force / np.maximum(force.mean(axis=1, keepdims=True), _LEAST)
        return shares


def force_ratio(revolution: Revolution, expected: Expected | None) -> float | None:
    """Force of a revolution over the expected one; None: its teeth are not to be compared.

    Not compared is a revolution in which a tooth, the feed or the arc of contact is missing,
    and one with a single sample for each tooth: by the power of a drive, which is slower.
    """
    if expected is None or revolution.samples < 2 or not revolution.force > 0.0:
        return None
    means = revolution.tooth_means
    passing = revolution.teeth * revolution.spindle_speed
    is_whole = bool(np.isfinite(means).all()) and means.sum() > 0.0
    is_fed = bool(revolution.tooth_feeds.min() > LEAST_CHIP * passing)
    is_known = expected.arcs.are_known and bool(expected.force.min() > 0.0)
    if not (is_whole and is_fed and is_known):
        return None
    return revolution.force / float(expected.force.mean())


def shares_of(
    revolution: Revolution, expected: Expected, *, exponent: float, change: float | None
) -> ToothShares:
    """Shares of the teeth in a revolution.

    Parameters
    ----------
    revolution : Revolution
    expected : Expected
        What equal teeth would take.
    exponent : float
        p of force over chip.
    change : float, optional
        Of ln(force over the expected one) since the revolution before; None: there was none.
    """
    teeth, means = revolution.teeth, revolution.tooth_means
    taken: Floats = means / means.mean()
    per_tooth = revolution.tooth_feeds / (teeth * revolution.spindle_speed)
    # The mean of samples that are taken at the ends of their intervals is early by half of one.
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
    """(z, z) covariance of what shares err by."""
    teeth = revolution.teeth
    order = (np.arange(teeth) - revolution.first) % teeth
    near = JITTER * expected.change / expected.force.mean()
    even = FLOOR / revolution.tooth_means.mean(), MISSED * (1.0 - revolution.coverage)
    own = READING**2 * (1.0 + taken**2) + even[0] ** 2 + even[1] ** 2
    # What one tooth takes more than expected moves the mean, and with it the shares of all.
    jitter = np.diag(near) - np.outer(taken, near) / teeth
    grown = drift * taken * ((order + 0.5) / teeth - 0.5)
    moved = EARLY * (np.roll(taken, 1) - taken)
    return np.diag(own) + jitter @ jitter.T + np.outer(grown, grown) + np.outer(moved, moved)
