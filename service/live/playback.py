"""Playback of a run in wall time, at so many simulated seconds per second."""

import time
from collections.abc import Callable

LEAST, MOST = 0.01, 1000.0
"""times as fast as the machine; 0: as fast as can be"""

TICK = 0.05
"""wall-clock seconds between two updates of a run"""


def checked_pace(factor: float) -> float:
    """A pace within its bounds.

    Raises
    ------
    ValueError
        When it is not.
    """
    if factor != 0.0 and not LEAST <= factor <= MOST:
        raise ValueError(
            f"pace {factor:g}: it must be {LEAST:g} to {MOST:g}, or 0 without waiting"
        )
    return factor


class PlaybackClock:
    """Waits until it is time. Running state.

    Parameters
    ----------
    factor : float
        Simulated seconds per wall-clock second; 0: no waiting.
    now : callable
        Wall-clock time, in seconds.
    wait : callable
        For so many s.

    Raises
    ------
    ValueError
        When the factor is beyond its bounds.
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
        """Return when the machine may have come so far."""
        if self._factor:
            rest = self._begin + machine_time / self._factor - self._now()
            if rest > 0.0:
                self._wait(rest)
