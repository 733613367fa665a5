"""A run as real sensors would show it: drives that lag and overshoot, noise, missing samples.

Positions, events and programmed values stay true. Same seed, same bytes, however the run is
cut.
"""

from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from simulator.machine.samples import PathMode, Samples
from simulator.machine.sensors import EQUAL, FORCE, POWER, Noise, Sensor, shown
from simulator.machine.transients import Follower, Response
from simulator.motion.segments import Bools, Floats

FORCES = ("cutting_force", "feed_force", "back_force")


class NoiseKind(StrEnum):
    """How sensors err."""

    NONE = "none"
    NORMAL = "normal"
    """3 % of a force, 20 W of a power, normally distributed"""
    UNIFORM = "uniform"
    """10 % in feed and 5 % in rapid, all errors alike: paper 003"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbance:
    """What stands between the truth and the samples."""

    noise: NoiseKind = NoiseKind.NONE
    missing: float = 0.0
    """probability that a sample of a power or force is missing"""
    response: Response | None = None
    """of the main drive to the cut; None: at once"""
    seed: int = 0

    @property
    def is_none(self) -> bool:
        """Whether samples are the truth."""
        is_silent = self.noise is NoiseKind.NONE and self.missing == 0.0
        return is_silent and self.response is None


@dataclass(kw_only=True)
class Disturbed:
    """Samples on their way through the sensors. Running state.

    Parameters
    ----------
    disturbance : Disturbance
    rate : float, 1/s
    efficiency : float
        Of the main drive, from the edge to the mains.
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
        """The next samples as the sensors show them."""
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
        """Power and forces of the cut as the drive answers them."""
        if not self._followers:
            return samples
        power = self._followers["cutting_power"].follow(samples.cutting_power)
        more = (power - samples.cutting_power) / self.efficiency
        # A lag gives nothing back to the mains; what braking gave back stays.
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
        """NaN for each sample that is lost, else 0: a meter loses all its powers together."""
        noise = Noise(missing=self.disturbance.missing)
        sensor = Sensor(column="sample", noise=noise, seed=self.disturbance.seed)
        return shown(sensor, np.zeros(len(is_rapid)), first=self._first, is_rapid=is_rapid)

    def _column(self, name: str, truth: Floats, is_rapid: Bools) -> Floats:
        noise = self._noise(name)
        if noise == Noise():
            return truth + self._gone
        sensor = Sensor(column=name, noise=noise, seed=self.disturbance.seed)
        return self._gone + shown(sensor, truth, first=self._first, is_rapid=is_rapid)

    def _noise(self, name: str) -> Noise:
        """Noise of one column; what draws constant power is not measured by itself."""
        kind = self.disturbance.noise
        if kind is NoiseKind.UNIFORM:
            return EQUAL
        if kind is NoiseKind.NORMAL and name in FORCES:
            return FORCE
        if kind is NoiseKind.NORMAL and name == "spindle_power":
            return POWER
        return Noise()
