"""Amplitudes of the force at the tooth passing frequency and at the spindle frequency.

The first shows the interrupted cut, the second shows unequal teeth: runout, a worn or a broken
one. Each is one bin of the discrete Fourier transform, computed as a dot product: the
revolution is the window, so neither leaks into the other. Units: N.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: tooth passing and spindle
   frequency in milling forces.
"""

from functools import lru_cache
from math import hypot, nan, pi
from typing import NamedTuple

import numpy as np

from controller.signals.ports import Floats


class Spectrum(NamedTuple):
    """Force amplitudes of a revolution; NaN if there are too few samples."""

    tooth_passing: float
    """Amplitude at z times the spindle frequency, N."""
    once_per_revolution: float
    """Amplitude at the spindle frequency, N."""


UNKNOWN = Spectrum(tooth_passing=nan, once_per_revolution=nan)


def spectrum(samples: Floats, teeth: int) -> Spectrum:
    """Compute the amplitudes at the tooth passing frequency and at the spindle frequency.

    ``A_k = 2/N · |Σ x_j · e^(−2πi·k·j/N)|`` at k = z and k = 1, below half the sampling
    frequency only: at and above it, aliasing adds other lines.

    Parameters
    ----------
    samples : (N,) array, N
        Evenly spaced over exactly one revolution, none lost.
    teeth : int
        z, at least 1.

    Examples
    --------
    >>> turn = 2.0 * np.pi * np.arange(32) / 32
    >>> found = spectrum(100.0 + 40.0 * np.cos(4 * turn) + 7.0 * np.sin(turn), 4)
    >>> round(found.tooth_passing, 9), round(found.once_per_revolution, 9)
    (40.0, 7.0)
    """
    count = len(samples)
    if count <= 2:
        return UNKNOWN
    once_cosine, once_sine, tooth_cosine, tooth_sine = (_lines(count, teeth) @ samples).tolist()
    is_folded = 2 * teeth >= count
    return Spectrum(
        tooth_passing=nan if is_folded else hypot(tooth_cosine, tooth_sine),
        once_per_revolution=hypot(once_cosine, once_sine),
    )


@lru_cache(maxsize=64)
def _lines(count: int, teeth: int) -> Floats:
    """Cosine and sine vectors at k = 1 and at k = z, times 2/N, (4, N)."""
    turn = 2.0 * pi / count * np.arange(count)
    lines: Floats = np.array([
        np.cos(turn),
        np.sin(turn),
        np.cos(teeth * turn),
        np.sin(teeth * turn),
    ])
    lines *= 2.0 / count
    lines.setflags(write=False)
    return lines
