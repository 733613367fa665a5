"""Where the force comes from: a dynamometer, or the power of the main drive, which is cheap.

Running state: the zero of the instrument. Units mm, N, W.
"""

from dataclasses import replace
from typing import Protocol

from controller.conditioning import (
    IdlePower,
    Tare,
    force_from_power,
    idled,
    tared,
    without_offset,
)
from simulator.reading import Reading


class Source(Protocol):
    """What makes a force of a reading."""

    def conditioned(self, reading: Reading, diameter: float) -> Reading:
        """The reading with the force that is to be acted upon.

        Parameters
        ----------
        reading : Reading
            As the sensors show it.
        diameter : float, mm
            Of the tool that is in the spindle; 0: not known.
        """
        ...


class Dynamometer:
    """Force as measured, less the drift of its zero. Running state."""

    def __init__(self) -> None:
        self._tare = Tare()

    def conditioned(self, reading: Reading, _diameter: float) -> Reading:
        """See :class:`Source`."""
        self._tare = tared(self._tare, reading)
        return without_offset(reading, self._tare) if reading.can_override else reading


class DrivePower:
    """Force by the power of the main drive over its idle power. Running state.

    Parameters
    ----------
    efficiency : float
        Of the main drive.
    """

    def __init__(self, efficiency: float) -> None:
        self._efficiency = efficiency
        self._idle = IdlePower()

    def conditioned(self, reading: Reading, diameter: float) -> Reading:
        """See :class:`Source`; without a known diameter there is no force."""
        self._idle = idled(self._idle, reading)
        if not reading.can_override or not diameter > 0.0:
            return replace(reading, force=reading.force[:0])
        return force_from_power(
            reading, self._idle, tool_diameter=diameter, efficiency=self._efficiency
        )
