"""Force sources: a dynamometer, or the power of the main drive, which costs less.

Mutable state: the zero of the instrument. Units: mm, N, W.
"""

from math import isnan, nan
from typing import Protocol

import numpy as np

from controller.signals.conditioning import (
    IdlePower,
    Tare,
    force_from_power,
    idled,
    tared,
    without_offset,
)
from controller.signals.preview import average
from simulator.reading import Reading


class Source(Protocol):
    """Converter from raw readings to readings with the cutting force."""

    def conditioned(
        self, reading: Reading, diameter: float, *, is_air: bool = False
    ) -> Reading:
        """Return the reading with the force that the loop acts on.

        Parameters
        ----------
        reading : Reading
            Raw sensor reading.
        diameter : float, mm
            Diameter of the tool in the spindle; 0: not known.
        is_air : bool
            Whether the program expects no chips here, nor near.
        """
        ...


class Dynamometer:
    """Dynamometer: the measured force less the drift of its zero (mutable state).

    Parameters
    ----------
    chips : float, N
        Mean force above which there are chips, whatever the program expects.
    """

    def __init__(self, chips: float) -> None:
        self._chips = chips
        self._tare, self._normal = Tare(), Tare()

    def conditioned(
        self, reading: Reading, _diameter: float, *, is_air: bool = False
    ) -> Reading:
        """Return the reading less the dynamometer's zero; see :class:`Source`."""
        less = without_offset(reading, self._tare)
        is_still = is_air and not (self._tare.is_known and _mean(less) > self._chips)
        has_chips = False if is_still else None
        self._tare = tared(self._tare, reading, has_chips=has_chips)
        if isnan(reading.normal):
            return less if reading.can_override else reading
        normal = reading._replace(force=np.array([reading.normal]))
        less = less._replace(normal=reading.normal - self._normal.offset)
        self._normal = tared(self._normal, normal, has_chips=has_chips)
        return less if reading.can_override else reading


class DrivePower:
    """Force from the power of the main drive above its idle power (mutable state).

    Parameters
    ----------
    efficiency : float
        Efficiency of the main drive.
    chips : float, N
        As for the :class:`Dynamometer`.
    """

    def __init__(self, efficiency: float, chips: float) -> None:
        self._efficiency, self._chips = efficiency, chips
        self._idle = IdlePower()

    def conditioned(
        self, reading: Reading, diameter: float, *, is_air: bool = False
    ) -> Reading:
        """Return the reading with the force from power; none if the diameter is not known."""
        reading = reading._replace(normal=nan)
        told = reading._replace(force=reading.force[:0])
        if diameter > 0.0:
            told = force_from_power(
                reading, self._idle, tool_diameter=diameter, efficiency=self._efficiency
            )
        is_still = is_air and not _mean(told) > self._chips
        self._idle = idled(self._idle, reading, has_chips=False if is_still else None)
        return told if reading.can_override else told._replace(force=told.force[:0])


def _mean(reading: Reading) -> float:
    """Mean of the samples, N; NaN if a sample is lost or none was taken."""
    return average(reading.force) if len(reading.force) else nan
