"""The sockets of the loop: whatever fits them is a machine, the virtual one or a real one.

Units mm, s, N, W, rev/s.
"""

from typing import Protocol

from simulator.reading import Floats, Reading

__all__ = ["Floats", "Override", "Reading", "Sensor"]


class Sensor(Protocol):
    """Source of readings."""

    def read(self) -> Reading | None:
        """The next reading, waiting for it; None: the program has ended.

        Raises
        ------
        MachineLost
            When no reading will come any more.
        """
        ...


class Override(Protocol):
    """The feed override of the machine."""

    def set(self, override: float, /) -> None:
        """Feed over programmed feed from now on; 0 holds the feed."""
        ...
