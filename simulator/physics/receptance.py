"""Receptance of a structure over frequency, from the modes of a tap test.

Units mm, N, rad/s; natural frequencies in Hz, as measured.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012, ch. 3: modes of a machine tool.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from simulator.spec import VibrationMode

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 240
"""Number of sampled chatter frequencies on either side of a mode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalStructure:
    """Measured modes in the plane of the cut; a direction without modes is rigid."""

    x: tuple[VibrationMode, ...]
    y: tuple[VibrationMode, ...]

    def __post_init__(self) -> None:
        if not self.x and not self.y:
            raise ValueError("a structure needs at least one mode")


def receptance(modes: Sequence[VibrationMode], frequency: Floats) -> Complex:
    """Receptance over frequency: deflection per force, summed over the modes.

    ``Φ = Σ (ω_n²/k) / (ω_n² − ω² + 2iζ·ω_n·ω)``, [1]_.

    Parameters
    ----------
    modes : sequence of VibrationMode
    frequency : (N,) array, rad/s

    Returns
    -------
    (N,) complex array, mm/N
    """
    total = np.zeros(frequency.shape, dtype=np.complex128)
    for mode in modes:
        natural = 2.0 * pi * mode.natural_frequency
        damping = 2j * mode.damping_ratio * natural * frequency
        total += natural**2 / mode.stiffness / (natural**2 - frequency**2 + damping)
    return total


def chatter_frequencies(modes: Sequence[VibrationMode]) -> Floats:
    """Frequencies at which chatter is searched: dense around each mode, sparse elsewhere.

    Parameters
    ----------
    modes : sequence of VibrationMode

    Returns
    -------
    (N,) array, rad/s
        Ascending.
    """
    reach = np.sinh(np.linspace(-8.0, 8.0, 2 * SAMPLES + 1))
    natural = np.array([2.0 * pi * mode.natural_frequency for mode in modes])
    damping = np.array([mode.damping_ratio for mode in modes])
    near = (natural[:, None] * (1.0 + damping[:, None] * reach[None, :])).ravel()
    low, high = 0.05 * natural.min(), 10.0 * natural.max()
    found = np.concatenate([near, np.geomspace(low, high, 2 * SAMPLES)])
    return np.unique(found[(found >= low) & (found <= high)])
