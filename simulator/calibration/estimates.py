"""What is known of a machine's parameters before and after a fit."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simulator.calibration.features import UNITS, Parameter
from simulator.calibration.measured_run import Component
from simulator.motion.segments import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Prior:
    """What is known of a parameter before."""

    value: float
    scale: float
    """by how much it may well be off"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """What is known of a parameter after."""

    parameter: Parameter
    value: float
    low: float
    high: float
    """95 % interval; of one that is not identified, what the data allow"""
    reason: str = ""
    """why it could not be identified and keeps its prior value; empty: it was"""

    @property
    def is_identified(self) -> bool:
        """Whether the data say more than was known before."""
        return not self.reason

    @property
    def unit(self) -> str:
        """Of value and interval."""
        return UNITS[self.parameter]


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Fitted parameters."""

    estimates: tuple[Estimate, ...]
    """one of each parameter"""
    noise: Mapping[Component, float]
    """W, standard deviation of what the fit leaves, by component"""
    blocks: int
    """of consecutive samples, each one observation"""

    @property
    def values(self) -> Floats:
        """(P,) values in the order of the parameters."""
        return np.array([estimate.value for estimate in self.estimates])
