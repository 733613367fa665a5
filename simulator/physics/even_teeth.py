"""Sums over the equal teeth of a milling cutter while it turns, in closed form.

A stretch of edge between two angles takes the differences there of three integrals over sin φ,
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
"""of a table from 0 to π; cubic between them"""

SHEAR, COSINE, SINE = 0, 1, 2
"""∫sin^q φ dφ, and the same with cos φ and sin φ"""


class Bands(NamedTuple):
    """Stretches of an edge by their height, as seen at M places; kernels take tuples."""

    low: Floats
    """Low, (M, B) rad, lag of the lower end behind the tip"""
    high: Floats
    """High, (M, B) rad, of the upper one"""
    weight: Floats
    """Weight, (M, B) mm, ∫sin^(q−1) κ dy"""
    radial: Floats
    """Radial, (M, B) radial force in the plane over the tangential one"""


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def sums(
    rotation: Floats,
    arc: tuple[Floats, Floats],
    bands: Bands,
    *,
    teeth: int,
    exponent: float,
) -> Floats:
    """Tangential force, force against the feed, and force towards φ = 0.

    Parameters
    ----------
    rotation : (M, K) array, rad
        Angle φ of the tip of tooth 0 at M places.
    arc : two (M,) arrays, rad
        Entry and exit angles.
    bands : Bands
    teeth : int
    exponent : float
        q of force over chip.

    Returns
    -------
    (3, M, K) array, mm
        Over ``K·k_c1.1·f_z^q``.
    """
    totals = np.zeros((3, *rotation.shape))
    columns = bands.low, bands.high, bands.weight, bands.radial
    _add(np.ascontiguousarray(rotation), arc, columns, teeth, _table(exponent), totals)
    return totals


@cache
def _table(exponent: float) -> Floats:
    """(CELLS + 1, 2, 3) integrals from 0 on, and their slopes times the width of a cell."""
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
    """The same, added to the last argument."""
    begin, end = arc
    low, high, weight, radial = bands
    pitch = 2.0 * pi / teeth
    for row in range(rotation.shape[0]):
        for column in range(rotation.shape[1]):
            for tooth in range(teeth):
                tip = (rotation[row, column] - tooth * pitch) % (2.0 * pi)
                # The upper end of the edge may be turns behind its tip.
                while tip - high[row, -1] < end[row]:
                    for band in range(low.shape[1]):
                        bottom = max(tip - high[row, band], begin[row])
                        top = min(tip - low[row, band], end[row])
                        if top > bottom:
                            share = weight[row, band] / (high[row, band] - low[row, band])
                            shear = share * _between(table, SHEAR, bottom, top)
                            cosine = share * _between(table, COSINE, bottom, top)
                            sine = share * _between(table, SINE, bottom, top)
                            totals[0, row, column] += shear
                            totals[1, row, column] += cosine + radial[row, band] * sine
                            totals[2, row, column] += sine - radial[row, band] * cosine
                    tip += 2.0 * pi


@kernel
def _between(table: Floats, which: int, bottom: float, top: float) -> float:
    return _until(table, which, top) - _until(table, which, bottom)


@kernel
def _until(table: Floats, which: int, angle: float) -> float:
    """Integral from 0 to an angle; there is no chip below 0 or beyond π."""
    place = min(max(angle, 0.0), pi) * (CELLS / pi)
    cell = min(int(place), CELLS - 1)
    on = place - cell
    off = 1.0 - on
    value: float = off * off * (1.0 + 2.0 * on) * table[cell, 0, which]
    value += on * on * (3.0 - 2.0 * on) * table[cell + 1, 0, which]
    value += on * off * off * table[cell, 1, which]
    value -= on * on * off * table[cell + 1, 1, which]
    return value
