"""First-order semi-discretisation of a milling cut: a judge of the lobes that shares no code.

T. Insperger and G. Stépán, "Semi-discretization for time-delay systems", Springer, 2011: the
delayed term is taken linear over a step, the periodic coefficients constant, and the tooth
period is one linear map. The cut is stable while all its eigenvalues lie in the unit circle.
Unlike the zero-order solution nothing is averaged over the period. SI units, as printed.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Matrix = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Case:
    """Straight teeth, evenly spaced; one mode in each direction that gives."""

    mass: tuple[float, ...]
    """kg, x first"""
    frequency: tuple[float, ...]
    """Hz"""
    damping: tuple[float, ...]
    tangential: float
    """N/m²"""
    radial: float
    """N/m²"""
    teeth: int
    entry: float
    """rad"""
    exit: float
    """rad"""


def coefficients(case: Case, steps: int, *, fine: int = 200) -> Matrix:
    """Force for a displacement per m of depth, N/m², mean over each step of a tooth period."""
    pitch = 2.0 * pi / case.teeth
    angles = (np.arange(steps * fine) + 0.5) * pitch / (steps * fine)
    total = np.zeros((steps * fine, 2, 2))
    for tooth in range(case.teeth):
        phi = (angles + tooth * pitch) % (2.0 * pi)
        cuts = (phi > case.entry) & (phi < case.exit)
        s, c = np.sin(phi), np.cos(phi)
        force = np.stack([
            -case.tangential * c - case.radial * s,
            case.tangential * s - case.radial * c,
        ])
        chip = np.stack([s, c])
        total += np.einsum("it,jt->tij", force * cuts, chip)
    mean: Matrix = total.reshape(steps, fine, 2, 2).mean(axis=1)
    return mean


def multiplier(case: Case, *, rpm: float, depth: float, steps: int = 40) -> float:
    """Greatest magnitude of the multipliers of a tooth period, at a depth in m."""
    count = len(case.mass)
    step = 60.0 / (rpm * case.teeth) / steps
    mass = np.array(case.mass)
    natural = 2.0 * pi * np.array(case.frequency)
    rigid = np.zeros((2 * count, 2 * count))
    rigid[:count, count:] = np.eye(count)
    rigid[count:, :count] = -np.diag(natural**2)
    rigid[count:, count:] = -np.diag(2.0 * np.array(case.damping) * natural)
    size = 2 * count + steps * count
    period = np.eye(size)
    for directional in coefficients(case, steps):
        gain = depth * directional[:count, :count] / mass[:, None]
        now = rigid.copy()
        now[count:, :count] += gain
        delayed = np.zeros((2 * count, count))
        delayed[count:] = -gain
        block = np.zeros((4 * count, 4 * count))
        block[: 2 * count, : 2 * count] = now * step
        block[: 2 * count, 2 * count : 3 * count] = delayed * step
        block[2 * count : 3 * count, 3 * count :] = np.eye(count)
        found = expm(block)[: 2 * count]
        free, first, slope = np.split(found, [2 * count, 3 * count], axis=1)
        move = np.zeros((size, size))
        move[: 2 * count, : 2 * count] = free
        move[: 2 * count, size - count :] = first - slope
        move[: 2 * count, size - 2 * count : size - count] += slope
        move[2 * count : 3 * count, :count] = np.eye(count)
        move[3 * count :, 2 * count : size - count] = np.eye(size - 3 * count)
        period = move @ period
    return float(np.abs(np.linalg.eigvals(period)).max())


def is_border(case: Case, *, rpm: float, depth: float, within: float, steps: int = 40) -> bool:
    """Whether the cut turns unstable within this share of a depth, m."""
    below = multiplier(case, rpm=rpm, depth=depth / (1.0 + within), steps=steps)
    above = multiplier(case, rpm=rpm, depth=depth * (1.0 + within), steps=steps)
    return below < 1.0 < above


def with_engagement(case: Case, *, entry: float, exit: float) -> Case:
    """The same cutter in another cut."""
    return replace(case, entry=entry, exit=exit)
