"""Transients of drives and cuts: delay, overshoot, first revolution.

A drive responds to its load late, as a first-order lag, or late and with overshoot, as a
second-order system. Both use one complex pole and the same recursion, which is exact at the
samples for a signal that is linear between them, and independent of how the signal is cut in
chunks. The pole of the second-order system is placed so that its mean delay equals that of the
first-order lag, 2ζ/ω = τ. The default values are customary, without a published source:
calibrate them. Units s, mm, rad.

References
----------
.. [1] K. Ogata, "Modern Control Engineering", 5th ed., 2010, ch. 5: overshoot of a step,
   ``M = exp(−π·ζ/√(1 − ζ²))``.
"""

from dataclasses import dataclass
from math import e, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from simulator.kernels.kernel import entry
from simulator.motion.segments import Floats
from simulator.physics.domain import require_not_negative, require_positive

USUAL_DELAY = 0.05
"""Usual delay of a main drive, s; typically 0.02 to 0.1."""

USUAL_OVERSHOOT = 0.2
"""Usual overshoot at entry and exit, as a share of the step."""

_SHORT = 1e-4  # |pole · interval| below which series replace differences


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Step response of a drive to its load.

    Raises
    ------
    ValueError
        If the delay is negative, or the overshoot does not satisfy 0 ≤ M < 1.
    """

    delay: float = USUAL_DELAY
    """Delay τ, s; 0 for an immediate response."""
    overshoot: float = USUAL_OVERSHOOT
    """Overshoot M of a step; 0 for a first-order lag."""

    def __post_init__(self) -> None:
        require_not_negative(self.delay, "delay of a drive", "s")
        if not 0.0 <= self.overshoot < 1.0:
            raise ValueError(f"overshoot {self.overshoot:g} must be at least 0 and below 1")

    @property
    def damping(self) -> float:
        """Damping ratio ζ for the overshoot, [1]_; 1 without overshoot."""
        if self.overshoot == 0.0:
            return 1.0
        decay = -log(self.overshoot)
        return decay / sqrt(pi**2 + decay**2)

    @property
    def pole(self) -> complex:
        """Pole of the response in the upper half plane, 1/s."""
        if self.overshoot == 0.0:
            return complex(-1.0 / self.delay, 0.0)
        frequency = 2.0 * self.damping / self.delay
        return frequency * complex(-self.damping, sqrt(1.0 - self.damping**2))


class Follower:
    """Filter that applies a drive's response to its load; keeps state between calls.

    Parameters
    ----------
    interval : float, s
        Time between samples.

    Raises
    ------
    ValueError
        If the interval is not positive.
    """

    def __init__(self, response: Response, interval: float) -> None:
        require_positive(interval, "interval", "s")
        self._is_direct = response.delay == 0.0
        self._last: float | None = None
        self._held = 0.0 + 0.0j
        if self._is_direct:
            return
        pole = response.pole
        # y = Re(gain · q), q' = pole · q + u: at rest y = u.
        self._gain = -pole.real if pole.imag == 0.0 else abs(pole) ** 2 / (1j * pole.imag)
        self._pole = pole
        self._weights = _weights(pole * interval, interval)

    def follow(self, load: Floats) -> Floats:
        """Apply the response to further samples; the drive starts at rest at the first sample.

        Parameters
        ----------
        load : (N,) array
            Next samples of the load.

        Returns
        -------
        (N,) array
        """
        if self._is_direct or len(load) == 0:
            return load.copy()
        if self._last is None:
            self._last = float(load[0])
            # At rest a step leaves the state unchanged.
            self._held = -self._last / self._pole
        held = np.empty(len(load) + 1, np.complex128)
        held[0] = self._held
        _follow(load, np.array(self._weights, np.complex128), self._last, held)
        self._held, self._last = complex(held[-1]), float(load[-1])
        return np.asarray((self._gain * held[1:]).real)


@entry
def _follow(
    load: Floats, weights: NDArray[np.complex128], last: float, states: NDArray[np.complex128]
) -> None:
    """Write the state after each sample, from the initial state and the previous load."""
    decay, before, now = weights[0], weights[1], weights[2]
    for row in range(len(load)):
        states[row + 1] = decay * states[row] + before * last + now * load[row]
        last = load[row]


def _weights(step: complex, interval: float) -> tuple[complex, complex, complex]:
    """Decay of the state, and weights of the previous and current load, linear between."""
    decay = e**step
    if abs(step) < _SHORT:
        whole, now = interval * (1.0 + 0.5 * step), interval * (0.5 + step / 6.0)
    else:
        whole = interval * (decay - 1.0) / step
        now = interval * (decay - 1.0 - step) / step**2
    return decay, whole - now, now


def entry_share(revolutions: Floats) -> Floats:
    """Chip thickness over its full value in turning, by revolutions since first contact.

    In the first revolution no surface has been cut before: the chip grows from 0 to the feed.
    The growth of the depth of cut follows from the stock's map.
    """
    return np.clip(revolutions, 0.0, 1.0)
