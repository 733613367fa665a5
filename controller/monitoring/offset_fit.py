"""Kernel that fits the radial offsets of teeth to one revolution, by Gauss-Newton.

It is the inner loop of :mod:`controller.monitoring.offsets`, which explains the model and its
source. The offsets are those that make ``e'·R⁻¹·e + a'·P⁻¹·a`` least, with e the error of the
shares, R its covariance, a the distance from the offsets known before and P the covariance of
these. A step that makes the fit worse is halved. Compiled, because each guess takes a dozen
products of small matrices, whose calls from Python cost far more than their arithmetic. The
kernels are bound to arrays of one cutter, as a fit follows each revolution. Units mm.
"""

from functools import cache, lru_cache
from math import inf, log, pi
from threading import get_ident
from typing import NamedTuple, TypeVar

import numpy as np

from controller.signals.ports import Floats
from controller.signals.tooth_shares import ToothShares, shares_into
from simulator.kernels.kernel import BoundKernel, entry, kernel
from simulator.physics.tooth_means import LOST, POINTS, Periods

STEP = 1e-4
"""Step of numerical derivatives, mm."""

NEAR = 5e-4
"""Change between iterations at which they have converged, mm."""

ITERATIONS = 8


START_RADII = (0.01, 0.025)
"""Eccentricities tried as starting points, mm."""

START_ANGLES = 8


class Fit(NamedTuple):
    """Offsets that fit a revolution best; a tuple, as kernels require."""

    mean: Floats
    """Offsets, (z,), mm."""
    covariance: Floats
    """Their covariance, (z, z), mm²."""
    figures: Floats
    """Misfit, ln of the determinant of the spread of the shares, (2,)."""

    @property
    def misfit(self) -> float:
        """Squared distance of shares and offsets from what was known, in deviations."""
        return float(self.figures[0])

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the covariance of the expected shares."""
        return float(self.figures[1])


class _Scratch(NamedTuple):
    """Memory of the kernels, which allocate none."""

    shown: Floats
    rows: Floats
    squares: Floats
    figures: Floats


def misfits(shares: ToothShares, mean: Floats, *, scale: float) -> Floats:
    """Misfits of a revolution to known offsets, with all teeth and without each tooth.

    Parameters
    ----------
    mean : (z,) array, mm
    scale : float
        Relative standard deviation of a common change of the chip thickness.

    Returns
    -------
    (z + 1,) array
        The first entry is with all teeth.
    """
    space = _space_for(shares)
    space.take(shares, mean)
    space.misfits(scale)()
    return _checked(space.square_misfits.copy(), space.square_misfits)


def fitted(
    shares: ToothShares,
    mean: Floats,
    covariance: Floats,
    *,
    lost: int | None,
    scale: float,
    plain: float,
) -> Fit:
    """Fit the offsets of the teeth to their shares in a revolution.

    Parameters
    ----------
    mean : (z,) array, mm
        Offsets known before.
    covariance : (z, z) array, mm²
    lost : int, optional
        Number of the tooth that takes no chip; None: all teeth cut.
    scale : float
        Relative standard deviation of a common change of the chip thickness.
    plain : float
        Misfit above which the search is repeated from some eccentricities: from offsets that
        keep teeth out of the work, the gradient cannot return.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a covariance is singular.
    """
    space = _space_for(shares)
    space.take(shares, mean)
    space.covariance[...] = covariance
    space.search((scale, plain, -1 if lost is None else lost))()
    return _checked(Fit(*(each.copy() for each in space.fit)), space.fit.figures)


Fitted = TypeVar("Fitted", Floats, Fit)


def _checked(result: Fitted, figures: Floats) -> Fitted:
    if not figures[0] < inf:
        raise np.linalg.LinAlgError("the covariance of offsets or shares is singular")
    return result


def _space_for(shares: ToothShares) -> "_Space":
    # Threads must not write into each other's arrays.
    return _space(get_ident(), *shares.periods.cutting.shape, shares.periods.exponent)


@lru_cache(maxsize=16)
def _space(_thread: int, teeth: int, back: int, exponent: float) -> "_Space":
    return _Space(teeth, back, exponent)


class _Space:
    """Arrays that stay in place, and the kernels bound to them (mutable state).

    Parameters
    ----------
    teeth : int
    back : int
        Number K of teeth that may cut in a tooth period.
    exponent : float
        Exponent of the force law.
    """

    def __init__(self, teeth: int, back: int, exponent: float) -> None:
        self.periods = Periods(
            np.empty(teeth),
            exponent,
            np.empty((teeth, POINTS)),
            np.empty((teeth, back, POINTS)),
            np.empty((teeth, back), dtype=np.int64),
            np.empty(teeth),
        )
        self.measured = np.empty(teeth), np.empty(teeth), np.empty((teeth, teeth))
        self.mean, self.covariance = np.empty(teeth), np.empty((teeth, teeth))
        self.square_misfits = np.empty(teeth + 1)
        self.fit = Fit(np.empty(teeth), np.empty((teeth, teeth)), np.empty(2))
        self._scratch = _scratch(teeth)
        self._shares: ToothShares | None = None
        # Few settings are in use: at most one for each tooth that may be lost.
        self.misfits, self.search = cache(self._misfits), cache(self._search)

    def take(self, shares: ToothShares, mean: Floats) -> None:
        """Copy a revolution and the known offsets into the arrays."""
        self.mean[...] = mean
        if self._shares is shares:
            return
        self._shares, at, to = shares, shares.periods, self.periods
        to.feed_per_tooth[...], to.equal[...] = at.feed_per_tooth, at.equal
        to.sine[...], to.weight[...], to.cutting[...] = at.sine, at.weight, at.cutting
        taken, expected, noise = self.measured
        taken[...], expected[...], noise[...] = shares.taken, shares.expected, shares.noise

    def _misfits(self, scale: float) -> BoundKernel:
        offsets = self.mean, self.square_misfits
        return _misfits.bound(self.periods, self.measured, offsets, scale, self._scratch)

    def _search(self, settings: tuple[float, float, int]) -> BoundKernel:
        known = self.mean, self.covariance, _starts(len(self.mean))
        at, measured = self.periods, self.measured
        return _search.bound(at, measured, known, settings, self.fit, self._scratch)


@cache
def _starts(teeth: int) -> Floats:
    """Eccentricities at which to start, (S, z), mm; the first is none."""
    angles = 2.0 * pi * np.arange(START_ANGLES) / START_ANGLES
    eccentric = np.cos(angles[:, None] - 2.0 * pi / teeth * np.arange(teeth))
    return np.vstack([np.zeros(teeth), *(radius * eccentric for radius in START_RADII)])


def _scratch(teeth: int) -> _Scratch:
    return _Scratch(
        np.empty((teeth + 1, teeth)),
        np.empty((7, teeth)),
        np.empty((9, teeth, teeth)),
        np.empty(2),
    )


@entry
def _misfits(
    at: Periods,
    measured: tuple[Floats, Floats, Floats],
    offsets: tuple[Floats, Floats],
    scale: float,
    scratch: _Scratch,
) -> None:
    """Kernel of :func:`misfits`."""
    taken, expected = measured[0], measured[1]
    mean, misfits = offsets
    guess, error, precision = scratch.rows[4], scratch.rows[1], scratch.squares[0]
    for each in range(mean.shape[0]):
        scratch.rows[5, each] = mean[each]
    _scale(at, measured, (scale, -1), scratch)
    _invert(scratch.squares[7], precision)
    for lost in range(-1, mean.shape[0]):
        _guess(mean, lost, guess)
        shares_into(at, expected, guess, error)
        for each in range(mean.shape[0]):
            error[each] = taken[each] - error[each]
        misfits[lost + 1] = _square(error, precision)


@entry
def _search(
    at: Periods,
    measured: tuple[Floats, Floats, Floats],
    known: tuple[Floats, Floats, Floats],
    settings: tuple[float, float, int],
    fit: Fit,
    scratch: _Scratch,
) -> None:
    """Kernel of :func:`fitted`; an infinite misfit tells of a singular covariance."""
    scale, plain, lost = settings
    start = scratch.rows[5]
    again = Fit(scratch.rows[6], scratch.squares[8], scratch.figures)
    _copy(measured[2], scratch.squares[7])
    for each in range(start.shape[0]):
        start[each] = known[0][each]
    _fit(at, measured, known, lost, fit, scratch)
    if fit.figures[0] > plain:
        _best_start(at, measured, known, lost, scratch)
        _fit(at, measured, known, lost, again, scratch)
        if again.figures[0] < fit.figures[0]:
            for each in range(start.shape[0]):
                fit.mean[each] = again.mean[each]
    for each in range(start.shape[0]):
        start[each] = fit.mean[each]
    _scale(at, measured, (scale, lost), scratch)
    _fit(at, measured, known, lost, fit, scratch)


@kernel
def _guess(offsets: Floats, lost: int, guess: Floats) -> None:
    """Write offsets, one tooth of which may be lost."""
    for each in range(offsets.shape[0]):
        guess[each] = LOST if each == lost else offsets[each]


@kernel
def _scale(
    at: Periods,
    measured: tuple[Floats, Floats, Floats],
    settings: tuple[float, int],
    scratch: _Scratch,
) -> None:
    """Write the noise, and the error of a common change of the chip, into ``squares[7]``."""
    expected, noise, noisier = measured[1], measured[2], scratch.squares[7]
    offsets, (scale, lost) = scratch.rows[5], settings
    guess, plain, other = scratch.rows[4], scratch.rows[0], scratch.rows[1]
    _guess(offsets, lost, guess)
    shares_into(at, expected, guess, plain)
    for each in range(offsets.shape[0]):
        guess[each] = LOST if each == lost else (1.0 + scale) * offsets[each]
    shares_into(at, expected, guess, other)
    for each in range(offsets.shape[0]):
        other[each] -= plain[each]
    for row in range(offsets.shape[0]):
        for column in range(offsets.shape[0]):
            noisier[row, column] = noise[row, column] + other[row] * other[column]


@kernel
def _best_start(
    at: Periods,
    measured: tuple[Floats, Floats, Floats],
    known: tuple[Floats, Floats, Floats],
    lost: int,
    scratch: _Scratch,
) -> None:
    """Write the most likely of some eccentricities into ``rows[5]``."""
    taken, expected, noise = measured
    mean, covariance, starts = known
    guess, error, start = scratch.rows[4], scratch.rows[1], scratch.rows[5]
    precision, certainty, copy = scratch.squares[0], scratch.squares[1], scratch.squares[6]
    _copy(noise, copy)
    _invert(copy, precision)
    _copy(covariance, copy)
    _invert(copy, certainty)
    least, best = inf, 0
    for row in range(starts.shape[0]):
        for each in range(mean.shape[0]):
            guess[each] = LOST if each == lost else mean[each] + starts[row, each]
        shares_into(at, expected, guess, error)
        for each in range(mean.shape[0]):
            error[each] = taken[each] - error[each]
        cost = _square(error, precision) + _square(starts[row], certainty)
        if cost < least:
            least, best = cost, row
    for each in range(mean.shape[0]):
        start[each] = mean[each] + starts[best, each]


@kernel
def _fit(
    at: Periods,
    measured: tuple[Floats, Floats, Floats],
    known: tuple[Floats, Floats, Floats],
    lost: int,
    fit: Fit,
    scratch: _Scratch,
) -> None:
    """One search from ``rows[5]``; the covariance of the shares is in ``squares[7]``."""
    taken, mean, covariance = measured[0], known[0], known[1]
    best, shown, spread = fit.mean, scratch.shown, scratch.squares[6]
    now, error, away = scratch.rows[0], scratch.rows[1], scratch.rows[2]
    precision, certainty = scratch.squares[0], scratch.squares[1]
    teeth, least = mean.shape[0], inf
    _copy(scratch.squares[7], spread)
    _invert(spread, precision)
    _copy(covariance, spread)
    _invert(spread, certainty)
    for each in range(teeth):
        now[each] = best[each] = scratch.rows[5, each]
    for _ in range(ITERATIONS):
        _show(at, measured[1], lost, scratch)
        for each in range(teeth):
            error[each] = taken[each] - shown[0, each]
            away[each] = now[each] - mean[each]
        misfit = _square(error, precision) + _square(away, certainty)
        if misfit >= least:
            for each in range(teeth):
                now[each] = 0.5 * (now[each] + best[each])
            continue
        least = misfit
        for each in range(teeth):
            best[each] = now[each]
        fit.figures[1] = _linearise(covariance, scratch)
        if _step(mean, best, scratch) < NEAR:
            for each in range(teeth):
                best[each] = now[each]
            break
    fit.figures[0] = least
    _learn(covariance, fit, scratch)


@kernel
def _show(at: Periods, expected: Floats, lost: int, scratch: _Scratch) -> None:
    """Write the shares at ``rows[0]``, and with each offset a step larger, into ``shown``."""
    now, guess = scratch.rows[0], scratch.rows[4]
    for row in range(now.shape[0] + 1):
        _guess(now, lost, guess)
        if row > 0 and row - 1 != lost:
            guess[row - 1] += STEP
        shares_into(at, expected, guess, scratch.shown[row])


@kernel
def _linearise(covariance: Floats, scratch: _Scratch) -> float:
    """Write slope H and gain of a step; return ln |determinant| of the spread."""
    shown, slope, towards = scratch.shown, scratch.squares[2], scratch.squares[3]
    inverse, gain = scratch.squares[4], scratch.squares[5]
    spread, noise = scratch.squares[6], scratch.squares[7]
    teeth = shown.shape[1]
    for each in range(teeth):
        for other in range(teeth):
            slope[each, other] = (shown[1 + other, each] - shown[0, each]) / STEP
    _times_transposed(covariance, slope, towards)
    _times(slope, towards, spread)
    for each in range(teeth):
        for other in range(teeth):
            spread[each, other] += noise[each, other]
    logarithm = _invert(spread, inverse)
    _times(towards, inverse, gain)
    return logarithm


@kernel
def _step(mean: Floats, best: Floats, scratch: _Scratch) -> float:
    """Write the offsets after a step into ``rows[0]``; return the greatest change, mm."""
    now, error, away, moved = scratch.rows[0], scratch.rows[1], scratch.rows[2], scratch.rows[3]
    slope, gain, farthest = scratch.squares[2], scratch.squares[5], 0.0
    for each in range(mean.shape[0]):
        moved[each] = error[each]
        for other in range(mean.shape[0]):
            moved[each] += slope[each, other] * away[other]
    for each in range(mean.shape[0]):
        now[each] = mean[each]
        for other in range(mean.shape[0]):
            now[each] += gain[each, other] * moved[other]
        farthest = max(farthest, abs(now[each] - best[each]))
    return farthest


@kernel
def _learn(covariance: Floats, fit: Fit, scratch: _Scratch) -> None:
    """Write the covariance after the revolution."""
    slope, product, gain = scratch.squares[2], scratch.squares[3], scratch.squares[5]
    # H·P anew, and not the transpose of P·H': rounding leaves P not quite symmetric, and an
    # asymmetry would grow from revolution to revolution.
    _times(slope, covariance, product)
    _times(gain, product, fit.covariance)
    for each in range(slope.shape[0]):
        for other in range(slope.shape[0]):
            fit.covariance[each, other] = covariance[each, other] - fit.covariance[each, other]


@kernel
def _copy(source: Floats, into: Floats) -> None:
    for row in range(source.shape[0]):
        for column in range(source.shape[1]):
            into[row, column] = source[row, column]


@kernel
def _square(row: Floats, matrix: Floats) -> float:
    """Quadratic form ``x'·M·x``."""
    total = 0.0
    for each in range(row.shape[0]):
        for other in range(row.shape[0]):
            total += row[each] * matrix[each, other] * row[other]
    return total


@kernel
def _times(left: Floats, right: Floats, into: Floats) -> None:
    """Product of square matrices."""
    for row in range(left.shape[0]):
        for column in range(left.shape[0]):
            total = 0.0
            for each in range(left.shape[0]):
                total += left[row, each] * right[each, column]
            into[row, column] = total


@kernel
def _times_transposed(left: Floats, right: Floats, into: Floats) -> None:
    """Product of a square matrix with the transpose of another."""
    for row in range(left.shape[0]):
        for column in range(left.shape[0]):
            total = 0.0
            for each in range(left.shape[0]):
                total += left[row, each] * right[column, each]
            into[row, column] = total


@kernel
def _invert(matrix: Floats, into: Floats) -> float:
    """Invert by Gauss-Jordan with row pivots; ``matrix`` is lost. Return ln |determinant|."""
    size, logarithm = matrix.shape[0], 0.0
    for row in range(size):
        for column in range(size):
            into[row, column] = 1.0 if row == column else 0.0
    for step in range(size):
        pivot = step
        for row in range(step + 1, size):
            if abs(matrix[row, step]) > abs(matrix[pivot, step]):
                pivot = row
        for column in range(size):
            held = matrix[step, column]
            matrix[step, column], matrix[pivot, column] = matrix[pivot, column], held
            held = into[step, column]
            into[step, column], into[pivot, column] = into[pivot, column], held
        scale = matrix[step, step]
        logarithm += log(abs(scale)) if scale != 0.0 else -inf
        for column in range(size):
            matrix[step, column] /= scale
            into[step, column] /= scale
        for row in range(size):
            factor = matrix[row, step]
            if row != step and factor != 0.0:
                for column in range(size):
                    matrix[row, column] -= factor * matrix[step, column]
                    into[row, column] -= factor * into[step, column]
    return logarithm
