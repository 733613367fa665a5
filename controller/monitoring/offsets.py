"""Radial offsets of the teeth of a cutter, estimated from the shares of the teeth in the force.

Runout makes the radius of each tooth larger or smaller by an offset in mm that does not depend
on feed or engagement; the resulting share of the tooth depends on both. The offsets are
estimated by an iterated extended Kalman filter, [1]_, on the physics of
:mod:`simulator.physics.tooth_means`; the likelihood of a revolution shows which hypothesis it
supports: intact teeth, or a lost one. Units: mm, N, rad.

References
----------
.. [1] B. M. Bell, F. W. Cathey, "The iterated Kalman filter update as a Gauss-Newton method",
   IEEE Trans. Automatic Control 38 (1993), 294-297.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from controller.monitoring import offset_fit
from controller.signals.ports import Floats
from controller.signals.tooth_shares import ToothShares

ECCENTRICITY = 0.02
"""Initial standard deviation of each component of the eccentricity, mm.

0.005 to 0.01 is usual, 0.03 happens.
"""

SINGLE = 0.003
"""Initial standard deviation of the individual offset of a tooth, mm."""

WANDER = 2e-4
"""Standard deviation of the change of an offset per revolution by edge wear, mm."""

OUTLIER = 4.0
"""Misfit per tooth above which a revolution does not update the offsets."""

SCALE = 0.05
"""Relative standard deviation of the chip thickness.

Arcs of contact are not exactly as planned, thin ones above all.
"""

PLAIN = 1.5
"""Misfit per tooth of a revolution as expected; above it, the fit is repeated."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Offsets:
    """Estimated offsets of the teeth, as a normal distribution."""

    mean: Floats
    """Mean offsets, (z,), mm."""
    covariance: Floats
    """Covariance of the offsets, (z, z), mm²."""
    confirmed: int = 0
    """Number of revolutions that confirmed the offsets; halved by each contrary one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """Likelihood and misfit of a revolution under one hypothesis."""

    log_likelihood: float
    """Logarithm of the likelihood, up to a constant."""
    misfit: float
    """Squared distance between measured and expected shares, in standard deviations."""
    offsets: Offsets
    """Tooth offsets updated by the revolution."""


def unknown(teeth: int) -> Offsets:
    """Prior for a new cutter: an eccentricity, plus a small offset of each tooth."""
    turned = 2.0 * pi / teeth * np.arange(teeth)
    eccentric = ECCENTRICITY**2 * np.cos(turned[:, None] - turned)
    return Offsets(mean=np.zeros(teeth), covariance=eccentric + SINGLE**2 * np.eye(teeth))


def misfits(offsets: Offsets, shares: ToothShares) -> Floats:
    """Misfits of a revolution to the known offsets, with all teeth and without each tooth.

    Returns
    -------
    (z + 1,) array
        The first entry is with all teeth.
    """
    return offset_fit.misfits(shares, offsets.mean, scale=SCALE)


def judged(offsets: Offsets, shares: ToothShares, *, lost: int | None = None) -> Judged:
    """Likelihood of a revolution under the hypothesis of a lost tooth, or of none.

    Parameters
    ----------
    lost : int, optional
        Number of the tooth that takes no chip; None: all teeth cut.
    """
    teeth = len(offsets.mean)
    found = offset_fit.fitted(
        shares,
        offsets.mean,
        offsets.covariance + WANDER**2 * np.eye(teeth),
        lost=lost,
        scale=SCALE,
        plain=PLAIN * teeth,
    )
    log_likelihood, misfit = -0.5 * (found.misfit + found.log_determinant), found.misfit
    if misfit > OUTLIER * teeth:
        return Judged(log_likelihood=log_likelihood, misfit=misfit, offsets=offsets)
    is_expected = misfit <= PLAIN * teeth
    confirmed = offsets.confirmed + 1 if is_expected else offsets.confirmed // 2
    return Judged(
        log_likelihood=log_likelihood,
        misfit=misfit,
        offsets=Offsets(mean=found.mean, covariance=found.covariance, confirmed=confirmed),
    )
