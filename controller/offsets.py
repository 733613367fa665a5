"""Offsets of the teeth of a cutter, estimated from what each of them takes of a revolution.

Runout makes the radius of each tooth larger or smaller by an offset in mm that no feed and no
engagement changes; what a tooth takes for it depends on both. The offsets are estimated by an
iterated extended Kalman filter, [1]_, on the physics of :mod:`simulator.physics.tooth_means`;
how likely a revolution is tells what it speaks for: whole teeth, or one that is lost. Units
mm, N, rad.

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
"""mm, standard deviation of each component of the eccentricity before anything is learnt;
0.005 to 0.01 is usual, 0.03 happens"""

SINGLE = 0.003
"""mm, standard deviation of a tooth's own offset before anything is learnt"""

WANDER = 2e-4
"""mm, standard deviation of what an offset changes in a revolution, since edges wear"""

OUTLIER = 4.0
"""misfit for each tooth above which a revolution teaches nothing"""

SCALE = 0.05
"""of a chip's thickness, standard deviation: arcs of contact are not exactly as planned, above
all thin ones"""

PLAIN = 1.5
"""misfit for each tooth up to which a revolution is as expected; above it, other beginnings of
the search are tried"""

_STEP = 1e-4  # mm, of the differences that make a derivative
_NEAR = 5e-4  # mm between two iterations that are as good as one
_ITERATIONS = 8
_ANGLES = 8
_RADII = (0.01, 0.025)  # mm


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Offsets:
    """Estimate of the offsets of the teeth: a normal distribution."""

    mean: Floats
    """(z,) mm"""
    covariance: Floats
    """(z, z) mm²"""
    confirmed: int = 0
    """revolutions that were as expected; half of them for each that taught something else"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """A revolution by one hypothesis."""

    log_likelihood: float
    """but for a constant"""
    misfit: float
    """square of the distance between seen and expected, in standard deviations"""
    offsets: Offsets
    """with what the revolution teaches"""


def unknown(teeth: int) -> Offsets:
    """A cutter of which nothing was learnt: an eccentricity, and a little of each tooth."""
    turned = 2.0 * pi / teeth * np.arange(teeth)
    eccentric = ECCENTRICITY**2 * np.cos(turned[:, None] - turned)
    return Offsets(mean=np.zeros(teeth), covariance=eccentric + SINGLE**2 * np.eye(teeth))


def misfits(offsets: Offsets, shares: ToothShares) -> Floats:
    """Misfit of a revolution to the offsets as they are, with all teeth and without each.

    Returns
    -------
    (z + 1,) array
        First with all teeth.
    """
    teeth = len(offsets.mean)
    guesses = np.tile(offsets.mean, (teeth + 1, 1))
    np.fill_diagonal(guesses[1:], LOST)
    return _square(shares.taken - shares.of(guesses), _scaled(shares, offsets.mean).noise)


def judged(offsets: Offsets, shares: ToothShares, *, lost: int | None = None) -> Judged:
    """Likelihood of a revolution under a hypothesis.

    Parameters
    ----------
    offsets : Offsets
    shares : ToothShares
    lost : int, optional
        Tooth that takes no chip.
    """
    teeth = len(offsets.mean)
    covariance = offsets.covariance + WANDER**2 * np.eye(teeth)
    known = replace(offsets, covariance=covariance)
    found = _fitted(known, shares, lost, start=offsets.mean)
    if found.misfit > PLAIN * teeth:
        # Teeth that are out of the work there show no way back into it.
        again = _fitted(known, shares, lost, start=_start(known, shares, lost))
        found = min(found, again, key=lambda each: each.misfit)
    near = found.offsets.mean
    found = _fitted(known, _scaled(shares, near, lost), lost, start=near)
    if found.misfit <= OUTLIER * teeth:
        return found
    return Judged(log_likelihood=found.log_likelihood, misfit=found.misfit, offsets=offsets)


def _scaled(shares: ToothShares, offsets: Floats, lost: int | None = None) -> ToothShares:
    """With the errors of chips that are all thicker or thinner: offsets count less or more."""
    pair = shares.of(_without(np.vstack((offsets, (1.0 + SCALE) * offsets)), lost))
    error = pair[1] - pair[0]
    return replace(shares, noise=shares.noise + np.outer(error, error))


def _start(known: Offsets, shares: ToothShares, lost: int | None) -> Floats:
    """Likeliest of some eccentricities beside what is known."""
    teeth = len(known.mean)
    angles = 2.0 * pi * np.arange(_ANGLES) / _ANGLES
    eccentric = np.cos(angles[:, None] - 2.0 * pi / teeth * np.arange(teeth))
    away = np.vstack([np.zeros(teeth), *(radius * eccentric for radius in _RADII)])
    error = shares.taken - shares.of(_without(known.mean + away, lost))
    cost = _square(error, shares.noise) + _square(away, known.covariance)
    start: Floats = known.mean + away[cost.argmin()]
    return start


def _fitted(known: Offsets, shares: ToothShares, lost: int | None, *, start: Floats) -> Judged:
    """Gauss-Newton, [1]_; a step that makes the fit worse is halved."""
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
    """(M,) squares of (M, z) rows in standard deviations."""
    squares: Floats = (rows @ np.linalg.inv(covariance) * rows).sum(axis=1)
    return squares


def _without(offsets: Floats, lost: int | None) -> Floats:
    """(M, z) guesses without a tooth."""
    if lost is None:
        return offsets
    without = offsets.copy()
    without[:, lost] = LOST
    return without
