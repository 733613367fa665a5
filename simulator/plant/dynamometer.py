"""Models of a real dynamometer and power meter: lag, noise, drift, resolution and gaps.

Errors are applied in the order in which they arise in the instrument: its own lag, drift,
noise, then the resolution of the converter; samples are lost last. The instruments keep state
between calls. Units s, N, W.
"""

from dataclasses import dataclass
from math import exp, nan

import numpy as np

from simulator.kernels.kernel import BoundKernel, entry
from simulator.motion.segments import Floats
from simulator.physics.domain import require_not_negative


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrument:
    """Errors of an instrument; typical values, not those of a specific product.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    noise: float = 0.0
    """Standard deviation as a share of the reading."""
    floor: float = 0.0
    """Standard deviation at zero, N or W."""
    drift: float = 0.0
    """Drift of the zero, N/s or W/s."""
    step: float = 0.0
    """Resolution of the converter, N or W; 0: unlimited."""
    lag: float = 0.0
    """Time constant of the lag, s."""
    missing: float = 0.0
    """Probability that a sample is lost."""

    def __post_init__(self) -> None:
        for name in ("noise", "floor", "step", "lag"):
            require_not_negative(getattr(self, name), name, "")
        if not 0.0 <= self.missing < 1.0:
            raise ValueError(
                f"share of missing samples {self.missing:g} must be at least 0 and below 1"
            )


DYNAMOMETER = Instrument(noise=0.03, floor=1.0, drift=0.02, step=0.25, lag=0.0005)
"""Typical dynamometer: 3 % noise and a drift of 1 N in 50 s."""

POWER_METER = Instrument(noise=0.0, floor=20.0, drift=0.0, step=1.0, lag=0.05)
"""Typical power meter: 20 W of noise, as slow as a main drive."""


DRAWN = 4096
"""Number of random numbers of each kind drawn at once."""


class Acquisition:
    """Measuring channel with the errors of one instrument; keeps state between calls.

    Parameters
    ----------
    random : Generator
        Separate generator per instrument, so that instruments do not affect each other.
    """

    def __init__(self, instrument: Instrument, random: np.random.Generator) -> None:
        self.instrument = instrument
        self._random = random
        self._held = 0.0
        self._step = _LagStep(0.0, 0, 0.0)
        self._drawn = np.empty((3, 0))
        self._used = 0
        # The arrays stay in place for the kernel.
        self._late = self._kept = self._values = np.empty(0)
        self._asked = np.zeros(4)
        self._show: BoundKernel | None = None

    def shown_one(self, truth: float, *, time: float, interval: float, is_lost: bool) -> float:
        """Apply the errors to one true value: :meth:`shown` of one sample, but faster."""
        by, step, value = self.instrument, self._step, truth
        if by.lag > 0.0:
            if step.interval != interval or len(step.kept) != 1:
                step = self._step = _LagStep(interval, 1, by.lag)
            value = self._held = step.weight * truth + step.share * self._held
        begin = self._drawn_at(1)
        gain, floor, luck = self._drawn[:, begin].tolist()
        value = value * gain + (floor + by.drift * time)
        if by.step > 0.0:
            # With digits, as numpy rounds: a zero keeps its sign.
            value = round(value / by.step, 0) * by.step
        return nan if is_lost or luck < by.missing else value

    def shown(self, truth: Floats, *, time: float, interval: float, is_lost: bool) -> Floats:
        """Apply the errors of the instrument to true values.

        Parameters
        ----------
        truth : (K,) array, N or W
        time : float, s
            Time of the last sample.
        interval : float, s
            Time between samples.
        is_lost : bool
            Whether all of these samples are lost.

        Returns
        -------
        (K,) array, NaN where a sample was lost
        """
        by, count = self.instrument, len(truth)
        if len(self._late) != count:
            self._late, self._kept, self._values = (np.zeros(count) for _ in range(3))
            self._show = None
        if by.lag > 0.0:
            step = self._step
            if step.interval != interval or len(step.kept) != count:
                step = self._step = _LagStep(interval, count, by.lag)
                self._kept[...] = step.kept
            np.matmul(step.weights, truth, out=self._late)
        else:
            self._late[...] = truth
        # Drawn even if lost, so that later samples do not depend on what arrived.
        begin = self._drawn_at(count)
        if self._show is None:
            lagged, errors = (self._late, self._kept), (float(by.step), float(by.missing))
            self._show = _show.bound(self._asked, lagged, self._drawn, errors, self._values)
        self._asked[:] = begin, self._held, by.drift * time, is_lost
        self._show()
        self._held = float(self._asked[1])
        return self._values.copy()

    def _drawn_at(self, count: int) -> int:
        """First of the columns with a random gain, zero and luck for each of some samples.

        Two are normal and one is uniform; they are drawn in bulk.
        """
        if self._drawn.shape[1] - self._used < count:
            more, by = max(DRAWN, count), self.instrument
            fresh = np.empty((3, more))
            fresh[:2] = self._random.standard_normal((2, more))
            fresh[2] = self._random.random(more)
            fresh[0] = 1.0 + by.noise * fresh[0]
            fresh[1] = by.floor * fresh[1]
            self._drawn = np.concatenate((self._drawn[:, self._used :], fresh), axis=1)
            self._used, self._show = 0, None
        begin, self._used = self._used, self._used + count
        return begin


@entry
def _show(
    state: Floats,
    lagged: tuple[Floats, Floats],
    drawn: Floats,
    errors: tuple[float, float],
    values: Floats,
) -> None:
    """Kernel of :meth:`Acquisition.shown`: a dozen calls of numpy for a few samples."""
    (late, kept), (step, missing) = lagged, errors
    held, shift, begin = state[1], state[2], int(state[0])
    for each in range(values.shape[0]):
        late[each] += kept[each] * held
        state[1] = late[each]
        value = late[each] * drawn[0, begin + each] + (drawn[1, begin + each] + shift)
        if step > 0.0:
            value = np.rint(value / step) * step
        is_lost = state[3] > 0.0 or drawn[2, begin + each] < missing
        values[each] = nan if is_lost else value


class _LagStep:
    """Coefficients of a first-order lag for K samples at one interval."""

    def __init__(self, interval: float, count: int, lag: float) -> None:
        self.interval = interval
        decay = exp(-interval / lag) if lag > 0.0 else 0.0
        rows = np.arange(count)
        age = rows[:, None] - rows
        self.weights = np.where(age >= 0, (1.0 - decay) * decay ** np.maximum(age, 0), 0.0)
        """Weight of each true sample, (K, K)."""
        self.kept = decay ** (rows + 1.0)
        """Weight of the previously held value, (K,)."""
        self.weight = float(self.weights[0, 0]) if count else 0.0
        self.share = float(self.kept[0]) if count else 0.0
