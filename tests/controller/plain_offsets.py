"""The fit of tooth offsets in plain numpy: the oracle of its kernel."""

from math import inf, pi

import numpy as np

from controller.monitoring.offset_fit import ITERATIONS, NEAR, START_ANGLES, START_RADII, STEP
from controller.signals.ports import Floats
from controller.signals.tooth_shares import ToothShares
from simulator.physics.tooth_means import LOST, Periods


def means(at: Periods, offsets: Floats) -> Floats:
    teeth = offsets.shape[1]
    back = (np.arange(teeth)[:, None] - np.arange(1, teeth + 1)) % teeth
    higher = offsets[:, :, None] - offsets[:, back]
    steps = np.arange(1.0, teeth + 1.0)[:, None] * at.sine[:, None, None, :]
    over = higher[:, at.cutting] / at.feed_per_tooth[:, None, None]
    chips = (steps + over[..., None]).min(axis=3).clip(min=0.0)
    force = (at.weight * chips**at.exponent).sum(axis=(2, 3))
    found: Floats = force / (at.weight.sum(axis=1) * at.sine**at.exponent).sum(axis=1)
    return found


def shares_of(shares: ToothShares, offsets: Floats) -> Floats:
    force = shares.expected * means(shares.periods, offsets)
    found: Floats = force / np.maximum(force.mean(axis=1, keepdims=True), 1e-9)
    return found


def without(offsets: Floats, lost: int | None) -> Floats:
    found = offsets.copy()
    if lost is not None:
        found[:, lost] = LOST
    return found


def scaled_noise(
    shares: ToothShares, offsets: Floats, lost: int | None, *, scale: float
) -> Floats:
    pair = shares_of(shares, without(np.vstack((offsets, (1.0 + scale) * offsets)), lost))
    error = pair[1] - pair[0]
    noise: Floats = shares.noise + np.outer(error, error)
    return noise


def square(rows: Floats, covariance: Floats) -> Floats:
    found: Floats = (rows @ np.linalg.inv(covariance) * rows).sum(axis=1)
    return found


def misfits(shares: ToothShares, mean: Floats, *, scale: float) -> Floats:
    guesses = np.tile(mean, (len(mean) + 1, 1))
    np.fill_diagonal(guesses[1:], LOST)
    error = shares.taken - shares_of(shares, guesses)
    return square(error, scaled_noise(shares, mean, None, scale=scale))


def fitted(
    shares: ToothShares,
    mean: Floats,
    covariance: Floats,
    *,
    lost: int | None,
    scale: float,
    plain: float,
) -> tuple[Floats, Floats, float, float]:
    """Offsets, covariance, misfit and ln |determinant|."""
    known = mean, covariance
    found = _fit(shares, shares.noise, known, lost, mean)
    if found[2] > plain:
        start = _start(shares, known, lost)
        again = _fit(shares, shares.noise, known, lost, start)
        found = min(found, again, key=lambda each: each[2])
    noise = scaled_noise(shares, found[0], lost, scale=scale)
    return _fit(shares, noise, known, lost, found[0])


def _start(shares: ToothShares, known: tuple[Floats, Floats], lost: int | None) -> Floats:
    mean, covariance = known
    teeth = len(mean)
    angles = 2.0 * pi * np.arange(START_ANGLES) / START_ANGLES
    eccentric = np.cos(angles[:, None] - 2.0 * pi / teeth * np.arange(teeth))
    away = np.vstack([np.zeros(teeth), *(radius * eccentric for radius in START_RADII)])
    error = shares.taken - shares_of(shares, without(mean + away, lost))
    cost = square(error, shares.noise) + square(away, covariance)
    start: Floats = mean + away[cost.argmin()]
    return start


def _fit(
    shares: ToothShares,
    noise: Floats,
    known: tuple[Floats, Floats],
    lost: int | None,
    start: Floats,
) -> tuple[Floats, Floats, float, float]:
    mean, covariance = known
    precision, certainty = np.linalg.inv(noise), np.linalg.inv(covariance)
    at, best, least = start, start, inf
    for _ in range(ITERATIONS):
        guesses = np.vstack((at, at + STEP * np.eye(len(at))))
        shown = shares_of(shares, without(guesses, lost))
        error, away = shares.taken - shown[0], at - mean
        misfit = float(error @ precision @ error + away @ certainty @ away)
        if misfit >= least:
            at = 0.5 * (at + best)
            continue
        best, least = at, misfit
        slope = (shown[1:] - shown[0]).T / STEP
        spread = slope @ covariance @ slope.T + noise
        gain = covariance @ slope.T @ np.linalg.inv(spread)
        at = mean + gain @ (error + slope @ away)
        if np.abs(at - best).max() < NEAR:
            best = at
            break
    determinant = float(np.linalg.slogdet(spread)[1])
    return best, covariance - gain @ slope @ covariance, least, determinant
