"""Force integrals over the unequal teeth of a rotating milling cutter.

Units mm, rad.
"""

from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from simulator.physics.domain import require_teeth
from simulator.physics.even_teeth import Bands

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Runout:
    """Runout of a milling cutter: unequal radii of its teeth."""

    offsets: Floats
    """Offset ρ of each tooth: its radius minus the nominal radius, (z,), mm."""
    feed_per_tooth: Floats
    """Feed per tooth f_z, (M,), mm."""


def eccentric_runout(eccentricity: float, teeth: int) -> Floats:
    """Offset of each tooth when the cutter axis is eccentric to the spindle axis.

    ``ρ_j = ρ·cos(2π·j/z)``, with tooth 0 the highest.

    Parameters
    ----------
    eccentricity : float, mm
        Eccentricity ρ; usually 0.005 to 0.01 mm.
    teeth : int

    Returns
    -------
    (z,) array, mm

    Raises
    ------
    ValueError
        If the eccentricity is negative or there is no tooth.
    """
    if not eccentricity >= 0.0:
        raise ValueError(f"eccentricity {eccentricity:g} mm must not be negative")
    require_teeth(teeth)
    return eccentricity * np.cos(2.0 * pi / teeth * np.arange(teeth, dtype=np.float64))


def sums(
    rotation: Floats,
    arc: tuple[Floats, Floats],
    bands: Bands,
    runout: Runout,
    *,
    exponent: float,
) -> Floats:
    """Sum tangential force, force against the feed and force towards φ = 0 over unequal teeth.

    Arguments and result are those of :func:`simulator.physics.even_teeth.sums`, with runout.
    """
    teeth = len(runout.offsets)
    turns = ceil((pi + float(bands.high.max(initial=0.0))) / (2.0 * pi))
    tooth = np.repeat(np.arange(teeth), turns)
    tip = np.mod(rotation[..., None] - tooth * (2.0 * pi / teeth), 2.0 * pi)
    tip += 2.0 * pi * np.tile(np.arange(turns), teeth)
    entry, exit_ = (angle[:, None, None] for angle in arc)
    totals = np.zeros((3, rotation.size))
    for low, high, weight, radially in zip(*(column.T for column in bands), strict=True):
        bottom = np.maximum(tip - high[:, None, None], entry)
        length = np.minimum(tip - low[:, None, None], exit_) - bottom
        at = np.nonzero(length > 0.0)
        row, within = at[0], length[at]
        angle = bottom[at][:, None] + within[:, None] * _NODES
        sine, cosine = np.sin(angle), np.cos(angle)
        chip = _uneven(sine, runout, row=row, tooth=tooth[at[2]])
        share = (weight / (high - low))[row] * within
        shear = share[:, None] * chip**exponent
        radial = radially[row][:, None]
        # Several teeth may be in the cut at one rotation.
        target = np.ravel_multi_index(at[:2], rotation.shape)
        parts = (
            shear,
            shear * (cosine + radial * sine),
            shear * (sine - radial * cosine),
        )
        for index, part in enumerate(parts):
            totals[index] += np.bincount(target, part @ _WEIGHTS, minlength=rotation.size)
    return totals.reshape(3, *rotation.shape)


def _uneven(sine: Floats, runout: Runout, *, row: Ints, tooth: Ints) -> Floats:
    """Chip thickness over f_z of N edge segments, given the surface left by previous teeth.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``: a low tooth cuts less or
    nothing, and the next tooth cuts the remainder, so that the chips of a revolution always add
    up to ``z·f_z·sin φ``.
    """
    offsets = runout.offsets
    chip = np.full(sine.shape, np.inf)
    for before in range(1, len(offsets) + 1):
        higher = (offsets - np.roll(offsets, before))[tooth] / runout.feed_per_tooth[row]
        np.minimum(chip, before * sine + higher[:, None], out=chip)
    return chip.clip(min=0.0)
