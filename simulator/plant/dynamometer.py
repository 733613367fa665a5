"""A dynamometer and a power meter as they are: late, noisy, drifting, in steps, with gaps.

Running state. The order of what is done to the truth is that of the instrument: its own lag,
drift, noise, then the steps of the converter; samples get lost on the way at the end. Units
s, N, W.
"""

from dataclasses import dataclass
from math import exp, nan

import numpy as np

from simulator.motion.segments import Floats
from simulator.physics.domain import require_not_negative


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrument:
    """Errors of an instrument; typical figures, not those of one product.

    Raises
    ------
    ValueError
        When a number is beyond its bounds.
    """

    noise: float = 0.0
    """standard deviation as a share of the reading"""
    floor: float = 0.0
    """Floor, N or W, standard deviation at zero"""
    drift: float = 0.0
    """N/s or W/s of the zero"""
    step: float = 0.0
    """Step, N or W, of the converter; 0: none"""
    lag: float = 0.0
    """Lag, s, time constant"""
    missing: float = 0.0
    """probability that a sample is lost"""

    def __post_init__(self) -> None:
        for name in ("noise", "floor", "step", "lag"):
            require_not_negative(getattr(self, name), name, "")
        if not 0.0 <= self.missing < 1.0:
            raise ValueError(f"missing {self.missing:g} must be at least 0 and below 1")


DYNAMOMETER = Instrument(noise=0.03, floor=1.0, drift=0.02, step=0.25, lag=0.0005)
"""3 % of noise and a drift of 1 N in 50 s"""

POWER_METER = Instrument(noise=0.0, floor=20.0, drift=0.0, step=1.0, lag=0.05)
"""20 W of noise, as slow as a main drive"""


DRAWN = 4096
"""random numbers of a kind that are drawn at once"""


class Acquisition:
    """One instrument at work. Running state.

    Parameters
    ----------
    instrument : Instrument
    random : Generator
        Its own: what one instrument draws does not change another's.
    """

    def __init__(self, instrument: Instrument, random: np.random.Generator) -> None:
        self.instrument = instrument
        self._random = random
        self._held = 0.0
        self._step = _LagStep(0.0, 0, 0.0)
        self._drawn = np.empty((3, 0))

    def shown(self, truth: Floats, *, time: float, interval: float, is_lost: bool) -> Floats:
        """Samples as they arrive.

        Parameters
        ----------
        truth : (K,) array, N or W
        time : float, s
            Of the last sample.
        interval : float, s
            Between samples.
        is_lost : bool
            Whether none of them arrives.

        Returns
        -------
        (K,) array, NaN where a sample was lost
        """
        by, count = self.instrument, len(truth)
        values: Floats = self._late(truth, interval) if by.lag > 0.0 else truth
        # Drawn even when lost: later samples do not depend on what arrived.
        relative, absolute, luck = self._draws(count)
        values = values * (1.0 + by.noise * relative) + (by.floor * absolute + by.drift * time)
        if by.step > 0.0:
            values = np.rint(values / by.step) * by.step
        if is_lost:
            return np.full(count, nan)
        if by.missing > 0.0:
            values[luck < by.missing] = nan
        return values

    def _draws(self, count: int) -> Floats:
        """(3, K) random numbers: two normal, one uniform; drawn many at once, for speed."""
        if self._drawn.shape[1] < count:
            more = max(DRAWN, count)
            normal = self._random.standard_normal((2, more))
            fresh = np.concatenate((normal, self._random.random((1, more))))
            self._drawn = np.concatenate((self._drawn, fresh), axis=1)
        now, self._drawn = self._drawn[:, :count], self._drawn[:, count:]
        return now

    def _late(self, truth: Floats, interval: float) -> Floats:
        """First-order lag; the truth holds between samples."""
        step = self._step
        if step.interval != interval or len(step.kept) != len(truth):
            step = self._step = _LagStep(interval, len(truth), self.instrument.lag)
        late: Floats = step.weights @ truth + step.kept * self._held
        self._held = float(late[-1])
        return late


class _LagStep:
    """Coefficients of K samples of a first-order lag over one interval."""

    def __init__(self, interval: float, count: int, lag: float) -> None:
        self.interval = interval
        decay = exp(-interval / lag) if lag > 0.0 else 0.0
        rows = np.arange(count)
        age = rows[:, None] - rows
        self.weights = np.where(age >= 0, (1.0 - decay) * decay ** np.maximum(age, 0), 0.0)
        """(K, K) of each sample of the truth"""
        self.kept = decay ** (rows + 1.0)
        """(K,) of what was held before"""
