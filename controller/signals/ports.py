"""Interfaces of the loop to a machine, virtual or real.

Units: mm, s, N, W, rev/s.

Units mm, s, N, W, rev/s.
"""

from typing import Protocol

from simulator.reading import Floats, Reading

__all__ = ["Floats", "Override", "Reading", "Sensor"]


class Sensor(Protocol):
    """Source of sensor readings."""

    def read(self) -> Reading | None:
        """Wait for the next reading and return it; None when the program has ended.

        Raises
        ------
        MachineLost
            When no more readings will come.
        """
        ...


class Override(Protocol):
    """Feed override of the machine."""

    def set(self, override: float, /) -> None:
        """Set the ratio of feed to programmed feed from now on; 0 holds the feed."""
        ...
