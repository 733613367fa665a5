"""Playback of a run in wall-clock time, at a number of simulated seconds per second."""

import time
from collections.abc import Callable

LEAST, MOST = 0.01, 1000.0
"""Bounds of the pace relative to the machine; 0 runs as fast as possible."""

TICK = 0.05
"""Wall-clock time between two updates of a run, in s."""


def checked_pace(factor: float) -> float:
    """Return a pace if it is within its bounds.

    Raises
    ------
    ValueError
        When the pace is out of bounds.
    """
    if factor != 0.0 and not LEAST <= factor <= MOST:
        raise ValueError(
            f"pace {factor:g}: it must be {LEAST:g} to {MOST:g}, or 0 for no waiting"
        )
    return factor


class PlaybackClock:
    """Delays a run to its pace in wall-clock time. Running state.

    Parameters
    ----------
    factor : float
        Simulated seconds per wall-clock second; 0: no waiting.
    now : callable
        Wall-clock time, in seconds.
    wait : callable
        Function that waits for a number of seconds.

    Raises
    ------
    ValueError
        When the factor is out of bounds.
    """

    def __init__(
        self,
        factor: float,
        *,
        now: Callable[[], float] = time.monotonic,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self._factor, self._now, self._wait = checked_pace(factor), now, wait
        self._begin = now()

    @property
    def factor(self) -> float:
        """Simulated seconds per wall-clock second; 0: no waiting."""
        return self._factor

    def wait_for(self, machine_time: float) -> None:
        """Wait until the run may have reached a machine time, in s."""
        if self._factor:
            rest = self._begin + machine_time / self._factor - self._now()
            if rest > 0.0:
                self._wait(rest)
