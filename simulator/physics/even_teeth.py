"""Force integrals over the equal teeth of a rotating milling cutter, in closed form.

A part of an edge between two angles contributes the differences of three integrals over sin φ,
which are tabulated once for each exponent. Units mm, rad.
"""

from functools import cache
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.kernels.kernel import entry, kernel

Floats = NDArray[np.float64]

CELLS = 4096
"""Number of cells of a table from 0 to π; interpolation between them is cubic."""

SHEAR, COSINE, SINE = 0, 1, 2
"""Indices of the integrals ∫sin^q φ dφ, and the same integrand times cos φ and sin φ."""


class Bands(NamedTuple):
    """Bands of an edge by height at M engagements; a tuple, as kernels require."""

    low: Floats
    """Lag angle of the lower end of each band behind the tip, (M, B), rad."""
    high: Floats
    """Lag angle of the upper end of each band behind the tip, (M, B), rad."""
    weight: Floats
    """Weight of each band, (M, B), mm: ∫sin^(q−1) κ dy."""
    radial: Floats
    """Radial force in the plane over the tangential force, (M, B)."""


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def sums(
    rotation: Floats,
    arc: tuple[Floats, Floats],
    bands: Bands,
    *,
    teeth: int,
    exponent: float,
) -> Floats:
    """Sum tangential force, force against the feed and force towards φ = 0 over equal teeth.

    Parameters
    ----------
    rotation : (M, K) array, rad
        Angle φ of the tip of tooth 0 at M engagements.
    arc : two (M,) arrays, rad
        Entry and exit angles.
    teeth : int
    exponent : float
        Exponent q of the force law.

    Returns
    -------
    (3, M, K) array, mm
        Forces over ``K·k_c1.1·f_z^q``.
    """
    totals = np.zeros((3, *rotation.shape))
    columns = bands.low, bands.high, bands.weight, bands.radial
    _add(np.ascontiguousarray(rotation), arc, columns, teeth, _table(exponent), totals)
    return totals


@cache
def _table(exponent: float) -> Floats:
    """Integrals from 0 on, and their slopes times the cell width, (CELLS + 1, 2, 3)."""
    step = pi / CELLS
    ends: Floats = step * np.arange(CELLS + 1, dtype=np.float64)
    nodes: Floats = ends[:-1, None] + 0.5 * step * (1.0 + _NODES)
    inside = _integrands(nodes, exponent) @ _WEIGHTS
    table = np.zeros((CELLS + 1, 2, 3))
    table[1:, 0] = np.cumsum(0.5 * step * inside, axis=1).T
    table[:, 1] = step * _integrands(ends, exponent).T
    return table


def _integrands(angle: Floats, exponent: float) -> Floats:
    sine = np.sin(angle).clip(min=0.0)
    chip = sine**exponent
    return np.stack((chip, chip * np.cos(angle), chip * sine))


@entry
def _add(
    rotation: Floats,
    arc: tuple[Floats, Floats],
    bands: tuple[Floats, Floats, Floats, Floats],
    teeth: int,
    table: Floats,
    totals: Floats,
) -> None:
    """Kernel of :func:`sums`; the forces are added to ``totals``."""
    begin, end = arc
    low, high, weight, radial = bands
    pitch = 2.0 * pi / teeth
    # Mostly a band ends where the one before began: what was looked up there serves again.
    known, lower = -1.0, _until(table, -1.0)
    for row in range(rotation.shape[0]):
        for column in range(rotation.shape[1]):
            for tooth in range(teeth):
                tip = (rotation[row, column] - tooth * pitch) % (2.0 * pi)
                # The upper end of the edge may lag several turns behind its tip.
                while tip - high[row, -1] < end[row]:
                    for band in range(low.shape[1]):
                        bottom = max(tip - high[row, band], begin[row])
                        top = min(tip - low[row, band], end[row])
                        if top > bottom:
                            share = weight[row, band] / (high[row, band] - low[row, band])
                            upper = lower if top == known else _until(table, top)
                            known, lower = bottom, _until(table, bottom)
                            shear = share * (upper[SHEAR] - lower[SHEAR])
                            cosine = share * (upper[COSINE] - lower[COSINE])
                            sine = share * (upper[SINE] - lower[SINE])
                            totals[0, row, column] += shear
                            totals[1, row, column] += cosine + radial[row, band] * sine
                            totals[2, row, column] += sine - radial[row, band] * cosine
                    tip += 2.0 * pi


@kernel
def _until(table: Floats, angle: float) -> tuple[float, float, float]:
    """Integrals from 0 to an angle; the chip is zero below 0 and beyond π."""
    place = min(max(angle, 0.0), pi) * (CELLS / pi)
    cell = min(int(place), CELLS - 1)
    on = place - cell
    off = 1.0 - on
    before, after = off * off * (1.0 + 2.0 * on), on * on * (3.0 - 2.0 * on)
    rise, fall = on * off * off, on * on * off
    one, other = table[cell], table[cell + 1]
    return (
        before * one[0, SHEAR] + after * other[0, SHEAR]
        + rise * one[1, SHEAR] - fall * other[1, SHEAR],
        before * one[0, COSINE] + after * other[0, COSINE]
        + rise * one[1, COSINE] - fall * other[1, COSINE],
        before * one[0, SINE] + after * other[0, SINE]
        + rise * one[1, SINE] - fall * other[1, SINE],
    )  # fmt: skip
