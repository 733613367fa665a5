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

from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np

from controller.ports import Floats
from controller.tooth_shares import ToothShares
from simulator.physics.tooth_means import LOST

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

_STEP = 1e-4  # step for numerical derivatives, mm
_NEAR = 5e-4  # change between iterations at which they have converged, mm
_ITERATIONS = 8
_ANGLES = 8
_RADII = (0.01, 0.025)  # eccentricities tried as starting points, mm


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
    teeth = len(offsets.mean)
    guesses = np.tile(offsets.mean, (teeth + 1, 1))
    np.fill_diagonal(guesses[1:], LOST)
    return _square(shares.taken - shares.of(guesses), _scaled(shares, offsets.mean).noise)


def judged(offsets: Offsets, shares: ToothShares, *, lost: int | None = None) -> Judged:
    """Likelihood of a revolution under the hypothesis of a lost tooth, or of none.

    Parameters
    ----------
    offsets : Offsets
    shares : ToothShares
    lost : int, optional
        Number of the tooth that takes no chip; None: all teeth cut.
    """
    teeth = len(offsets.mean)
    covariance = offsets.covariance + WANDER**2 * np.eye(teeth)
    known = replace(offsets, covariance=covariance)
    found = _fitted(known, shares, lost, start=offsets.mean)
    if found.misfit > PLAIN * teeth:
        # From offsets that keep teeth out of the work, the gradient search cannot return.
        again = _fitted(known, shares, lost, start=_start(known, shares, lost))
        found = min(found, again, key=lambda each: each.misfit)
    near = found.offsets.mean
    found = _fitted(known, _scaled(shares, near, lost), lost, start=near)
    if found.misfit <= OUTLIER * teeth:
        return found
    return Judged(log_likelihood=found.log_likelihood, misfit=found.misfit, offsets=offsets)


def _scaled(shares: ToothShares, offsets: Floats, lost: int | None = None) -> ToothShares:
    """Add the error of a common change of chip thickness to the noise of the shares."""
    pair = shares.of(_without(np.vstack((offsets, (1.0 + SCALE) * offsets)), lost))
    error = pair[1] - pair[0]
    return replace(shares, noise=shares.noise + np.outer(error, error))


def _start(known: Offsets, shares: ToothShares, lost: int | None) -> Floats:
    """Best of some eccentricities as a starting point for the search."""
    teeth = len(known.mean)
    angles = 2.0 * pi * np.arange(_ANGLES) / _ANGLES
    eccentric = np.cos(angles[:, None] - 2.0 * pi / teeth * np.arange(teeth))
    away = np.vstack([np.zeros(teeth), *(radius * eccentric for radius in _RADII)])
    error = shares.taken - shares.of(_without(known.mean + away, lost))
    cost = _square(error, shares.noise) + _square(away, known.covariance)
    start: Floats = known.mean + away[cost.argmin()]
    return start


def _fitted(known: Offsets, shares: ToothShares, lost: int | None, *, start: Floats) -> Judged:
    """Fit the offsets by Gauss-Newton, [1]_; a step that makes the fit worse is halved."""
    at, covariance = start, known.covariance
    precision, certainty = np.linalg.inv(shares.noise), np.linalg.inv(covariance)
    best, least = start, inf
    for _ in range(_ITERATIONS):
        guesses = np.vstack((at, at + _STEP * np.eye(len(at))))
        shown = shares.of(_without(guesses, lost))
        error, away = shares.taken - shown[0], at - known.mean
        misfit = float(error @ precision @ error + away @ certainty @ away)
        if misfit >= least:
            at = 0.5 * (at + best)
            continue
        best, least = at, misfit
        slope = (shown[1:] - shown[0]).T / _STEP
        spread = slope @ covariance @ slope.T + shares.noise
        gain = covariance @ slope.T @ np.linalg.inv(spread)
        at = known.mean + gain @ (error + slope @ away)
        if np.abs(at - best).max() < _NEAR:
            best = at
            break
    is_expected = least <= PLAIN * len(best)
    return Judged(
        log_likelihood=-0.5 * (least + float(np.linalg.slogdet(spread)[1])),
        misfit=least,
        offsets=Offsets(
            mean=best,
            covariance=covariance - gain @ slope @ covariance,
            confirmed=known.confirmed + 1 if is_expected else known.confirmed // 2,
        ),
    )


def _square(rows: Floats, covariance: Floats) -> Floats:
    """Squared lengths of (M, z) rows in standard deviations, (M,)."""
    squares: Floats = (rows @ np.linalg.inv(covariance) * rows).sum(axis=1)
    return squares


def _without(offsets: Floats, lost: int | None) -> Floats:
    """Mark a tooth as lost in (M, z) guesses of the offsets."""
    if lost is None:
        return offsets
    without = offsets.copy()
    without[:, lost] = LOST
    return without
