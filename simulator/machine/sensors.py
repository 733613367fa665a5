"""What sensors make of the truth: noise, steps, missing samples. Same seed, same bytes.

Each draw belongs to a seed, a column and the number of a sample, counted from the start of the
run: it comes from a counter, not from what was drawn before, and is the same however a run is
cut in chunks.

References
----------
.. [1] J. K. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011: Philox.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018: equal distribution, ±10 % in feed and ±5 % in rapid.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Bools, Floats
from simulator.physics.domain import require_not_negative

BLOCK = 1024
"""samples drawn together; whole blocks keep the arithmetic the same at their ends"""

_WORDS = 2  # of 64 bits a sample
_PER_COUNT = 4  # words that Philox makes of one count


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """How one sensor errs.

    Raises
    ------
    ValueError
        When a figure is negative, or the probability above 1.
    """

    relative: float = 0.0
    """standard deviation over the true value"""
    absolute: float = 0.0
    """standard deviation in the sensor's unit, independent of the relative one"""
    feed_spread: float = 0.0
    """greatest error over the true value in feed, all errors equally likely, [2]_: 0.1"""
    rapid_spread: float = 0.0
    """the same in rapid, [2]_: 0.05"""
    step: float = 0.0
    """the sensor shows multiples of it; 0: any value"""
    missing: float = 0.0
    """probability that a sample is missing, shown as NaN"""

    def __post_init__(self) -> None:
        for name in ("relative", "absolute", "feed_spread", "rapid_spread", "step"):
            require_not_negative(getattr(self, name), name.replace("_", " "), "")
        if not 0.0 <= self.missing <= 1.0:
            raise ValueError(f"probability {self.missing:g} must lie between 0 and 1")


FORCE = Noise(relative=0.03)
"""what stays unexplained of measured turning forces: 3.3 %"""

POWER = Noise(absolute=20.0)
"""W; standing noise of a spindle's power on a small mill at 10 Hz"""

EQUAL = Noise(feed_spread=0.10, rapid_spread=0.05)
"""[2]_"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A sensor of one column in a seeded run."""

    column: str
    noise: Noise
    seed: int = 0
    """not negative"""

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise ValueError(f"seed {self.seed} must be at least 0")


def shown(sensor: Sensor, truth: Floats, *, first: int, is_rapid: Bools) -> Floats:
    """What a sensor shows of samples.

    Parameters
    ----------
    sensor : Sensor
    truth : (M,) array
    first : int
        Number of the first sample in the run, from 0.
    is_rapid : (M,) array of bool

    Returns
    -------
    (M,) array
        NaN where a sample is missing.

    Raises
    ------
    ValueError
        When the number of the first sample is negative.
    """
    if first < 0:
        raise ValueError(f"number of a sample {first} must be at least 0")
    noise, count = sensor.noise, len(truth)
    value = truth.copy()
    if noise.relative > 0.0 or noise.absolute > 0.0:
        deviation = np.hypot(noise.relative * truth, noise.absolute)
        value += deviation * normal(_key(sensor, "noise"), first, count)
    if noise.feed_spread > 0.0 or noise.rapid_spread > 0.0:
        spread = np.where(is_rapid, noise.rapid_spread, noise.feed_spread)
        value += truth * spread * (2.0 * uniform(_key(sensor, "spread"), first, count) - 1.0)
    if noise.step > 0.0:
        value = noise.step * np.round(value / noise.step)
    if noise.missing > 0.0:
        value[uniform(_key(sensor, "missing"), first, count) < noise.missing] = np.nan
    return value


Key = NDArray[np.uint64]
"""(2,) of a stream of draws"""


def _key(sensor: Sensor, purpose: str) -> Key:
    """Key of the draws of a sensor for one purpose."""
    name = f"{sensor.column} {purpose}".encode()
    words = np.random.SeedSequence([sensor.seed, *name]).generate_state(2, np.uint64)
    return np.asarray(words, dtype=np.uint64)


def uniform(key: Key, first: int, count: int) -> Floats:
    """(M,) draws between 0 and 1, of the samples from the first on."""
    return _draws(key, first, count)[:, 0]


def normal(key: Key, first: int, count: int) -> Floats:
    """(M,) draws of mean 0 and deviation 1, by Box and Muller's transformation."""
    skipped = first % BLOCK
    whole = -(-(skipped + count) // BLOCK) * BLOCK
    draws = _draws(key, first - skipped, whole)
    # 1 − u is never 0.
    size = np.sqrt(-2.0 * np.log(1.0 - draws[:, 0]))
    every: Floats = size * np.cos(2.0 * pi * draws[:, 1])
    return every[skipped : skipped + count]


def _draws(key: Key, first: int, count: int) -> Floats:
    """(M, 2) draws from 0 to below 1, of the samples from the first on."""
    skipped = first * _WORDS % _PER_COUNT
    source = np.random.Philox(key=key, counter=first * _WORDS // _PER_COUNT)
    words = source.random_raw(skipped + count * _WORDS)[skipped:]
    # The upper 53 bits, as many as a float holds.
    return np.ldexp((words >> np.uint64(11)).astype(np.float64), -53).reshape(-1, _WORDS)
