"""Sensor model: lag and overshoot of drives, noise and missing samples.

Positions, events and programmed values stay exact. The same seed gives the same bytes, however
the run is cut in chunks: each random number depends only on a seed, a column and the number of
the sample, counted from the start of the run, because it comes from a counter-based generator.

References
----------
.. [1] J. K. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011: Philox.
.. [2] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model for
   advanced analytics", 2018: equal distribution, ±10 % in feed and ±5 % in rapid.
"""

from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from simulator.machine.noise_kind import NoiseKind
from simulator.machine.samples import PathMode, Samples
from simulator.machine.transients import Follower, Response
from simulator.motion.segments import Bools, Floats
from simulator.physics.domain import require_not_negative

BLOCK = 1024
"""Number of samples drawn together; whole blocks keep results bit-identical at their ends."""

_WORDS = 2  # words of 64 bits per sample
_PER_COUNT = 4  # words that Philox generates per count


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """Noise of one sensor.

    Raises
    ------
    ValueError
        If a value is negative, or the probability is above 1.
    """

    relative: float = 0.0
    """Standard deviation over the true value."""
    absolute: float = 0.0
    """Standard deviation in the unit of the sensor, independent of the relative noise."""
    feed_spread: float = 0.0
    """Greatest relative error in feed, uniformly distributed; 0.1 in [2]_."""
    rapid_spread: float = 0.0
    """Greatest relative error in rapid, uniformly distributed; 0.05 in [2]_."""
    step: float = 0.0
    """Resolution of the sensor, in its unit; 0: unlimited."""
    missing: float = 0.0
    """Probability that a sample is missing and reads NaN."""

    def __post_init__(self) -> None:
        for name in ("relative", "absolute", "feed_spread", "rapid_spread", "step"):
            require_not_negative(getattr(self, name), name.replace("_", " "), "")
        if not 0.0 <= self.missing <= 1.0:
            raise ValueError(f"probability {self.missing:g} must lie between 0 and 1")


FORCE = Noise(relative=0.03)
"""Noise of a force sensor: 3 % of the value, as the unexplained rest of measured turning
forces is 3.3 %."""

POWER = Noise(absolute=20.0)
"""Noise of a power meter, W: constant noise of the spindle power of a small mill at 10 Hz."""

EQUAL = Noise(feed_spread=0.10, rapid_spread=0.05)
"""Uniform noise of ±10 % in feed and ±5 % in rapid, [2]_."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeededSensor:
    """Sensor of one sample column with its noise and random seed."""

    column: str
    noise: Noise
    seed: int = 0
    """Random seed, at least 0."""

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise ValueError(f"seed {self.seed} must be at least 0")


def shown(sensor: SeededSensor, truth: Floats, *, first: int, is_rapid: Bools) -> Floats:
    """Apply noise, resolution and gaps of a sensor to true values.

    Parameters
    ----------
    truth : (M,) array
    first : int
        Number of the first sample in the run, counted from 0.
    is_rapid : (M,) array of bool

    Returns
    -------
    (M,) array
        NaN where a sample is missing.

    Raises
    ------
    ValueError
        If the number of the first sample is negative.
    """
    if first < 0:
        raise ValueError(f"sample number {first} must be at least 0")
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
"""Key of a stream of random numbers, (2,)."""


def _key(sensor: SeededSensor, purpose: str) -> Key:
    """Key of the random numbers of a sensor for one purpose."""
    name = f"{sensor.column} {purpose}".encode()
    words = np.random.SeedSequence([sensor.seed, *name]).generate_state(2, np.uint64)
    return np.asarray(words, dtype=np.uint64)


def uniform(key: Key, first: int, count: int) -> Floats:
    """Random numbers between 0 and 1 for consecutive samples, (M,)."""
    return _draws(key, first, count)[:, 0]


def normal(key: Key, first: int, count: int) -> Floats:
    """Normal random numbers of mean 0 and deviation 1, (M,), by the Box-Muller method."""
    skipped = first % BLOCK
    whole = -(-(skipped + count) // BLOCK) * BLOCK
    draws = _draws(key, first - skipped, whole)
    # 1 − u is never 0.
    size = np.sqrt(-2.0 * np.log(1.0 - draws[:, 0]))
    every: Floats = size * np.cos(2.0 * pi * draws[:, 1])
    return every[skipped : skipped + count]


def _draws(key: Key, first: int, count: int) -> Floats:
    """Random numbers from 0 to below 1 for consecutive samples, (M, 2)."""
    skipped = first * _WORDS % _PER_COUNT
    source = np.random.Philox(key=key, counter=first * _WORDS // _PER_COUNT)
    words = source.random_raw(skipped + count * _WORDS)[skipped:]
    # The upper 53 bits, as many as a float can hold.
    return np.ldexp((words >> np.uint64(11)).astype(np.float64), -53).reshape(-1, _WORDS)


FORCES = ("cutting_force", "feed_force", "back_force")


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbance:
    """Settings of the sensor model: lag, noise and gaps of the samples."""

    noise: NoiseKind = NoiseKind.NONE
    missing: float = 0.0
    """Probability that a power or force sample is missing."""
    response: Response | None = None
    """Response of the main drive to the cut; None for no delay."""
    seed: int = 0

    @property
    def is_none(self) -> bool:
        """True if the samples remain undisturbed."""
        is_silent = self.noise is NoiseKind.NONE and self.missing == 0.0
        return is_silent and self.response is None


@dataclass(kw_only=True)
class Disturbed:
    """Sensor model of a run, applied to successive samples; a mutable object.

    Parameters
    ----------
    rate : float, 1/s
    efficiency : float
        Efficiency of the main drive, from the mains to the edge.
    """

    disturbance: Disturbance
    rate: float
    efficiency: float
    _first: int = 0
    _gone: Floats = field(default_factory=lambda: np.zeros(0))
    _followers: dict[str, Follower] = field(default_factory=dict)

    def __post_init__(self) -> None:
        response = self.disturbance.response
        if response is not None:
            columns = ("cutting_power", *FORCES)
            self._followers = {name: Follower(response, 1.0 / self.rate) for name in columns}

    def shown(self, samples: Samples) -> Samples:
        """Apply the sensor model to the next samples."""
        if self.disturbance.is_none:
            return samples
        samples = self._followed(samples)
        rapid = samples.path_mode == PathMode.RAPID
        self._gone = self._missing(rapid)
        axes = [
            self._column(f"axis_power {row}", samples.axis_power[:, row], rapid)
            for row in range(3)
        ]
        seen = replace(
            samples,
            axis_power=np.stack(axes, axis=1),
            spindle_power=self._column("spindle_power", samples.spindle_power, rapid),
            coolant_power=self._column("coolant_power", samples.coolant_power, rapid),
            base_power=self._column("base_power", samples.base_power, rapid),
            cutting_force=self._column("cutting_force", samples.cutting_force, rapid),
            feed_force=self._column("feed_force", samples.feed_force, rapid),
            back_force=self._column("back_force", samples.back_force, rapid),
        )
        self._first += len(samples)
        return seen

    def _followed(self, samples: Samples) -> Samples:
        """Apply the response of the drive to power and forces of the cut."""
        if not self._followers:
            return samples
        power = self._followers["cutting_power"].follow(samples.cutting_power)
        more = (power - samples.cutting_power) / self.efficiency
        # A lag feeds no power back to the mains; braking energy that was fed back stays.
        least = np.minimum(samples.spindle_power, 0.0)
        return replace(
            samples,
            cutting_power=power,
            spindle_power=np.maximum(samples.spindle_power + more, least),
            cutting_force=self._followers["cutting_force"].follow(samples.cutting_force),
            feed_force=self._followers["feed_force"].follow(samples.feed_force),
            back_force=self._followers["back_force"].follow(samples.back_force),
        )

    def _missing(self, is_rapid: Bools) -> Floats:
        """NaN for each lost sample, else 0: a meter loses all its powers together."""
        noise = Noise(missing=self.disturbance.missing)
        sensor = SeededSensor(column="sample", noise=noise, seed=self.disturbance.seed)
        return shown(sensor, np.zeros(len(is_rapid)), first=self._first, is_rapid=is_rapid)

    def _column(self, name: str, truth: Floats, is_rapid: Bools) -> Floats:
        noise = self._noise(name)
        if noise == Noise():
            return truth + self._gone
        sensor = SeededSensor(column=name, noise=noise, seed=self.disturbance.seed)
        return self._gone + shown(sensor, truth, first=self._first, is_rapid=is_rapid)

    def _noise(self, name: str) -> Noise:
        """Noise of one column; constant powers are not measured separately."""
        kind = self.disturbance.noise
        if kind is NoiseKind.UNIFORM:
            return EQUAL
        if kind is NoiseKind.NORMAL and name in FORCES:
            return FORCE
        if kind is NoiseKind.NORMAL and name == "spindle_power":
            return POWER
        return Noise()
