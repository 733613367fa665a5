"""Age of a machine's data: by their arrival here, because clocks of machines may be wrong."""

from collections import deque
from enum import StrEnum
from statistics import median

LEAST_STALE = 2.0
"""Shortest time without an observation after which data are old, in s."""

INTERVALS = 3.0
"""Usual intervals without an observation after which data are old."""

LEARNED = 5
"""Intervals from which the usual one is known."""

REMEMBERED = 50
"""Latest intervals whose median is the usual one."""


class Freshness(StrEnum):
    """True if the shown values of a machine can be trusted."""

    NONE = "none"
    """No observation has come yet."""
    FRESH = "fresh"
    """Observations come as usual."""
    QUIET = "quiet"
    """The agent answers, but reports no change, and the machine is at rest."""
    STALE = "stale"
    """Observations are missing, or the connection is lost."""


class ArrivalTimes:
    """Times at which observations arrived. Running state."""

    def __init__(self) -> None:
        self._gaps: deque[float] = deque(maxlen=REMEMBERED)
        self._last: float | None = None
        self._is_interrupted = False

    def add(self, now: float) -> None:
        """Note that observations have arrived at a time, in s."""
        if self._last is not None and not self._is_interrupted:
            self._gaps.append(now - self._last)
        self._last, self._is_interrupted = now, False

    def interrupt(self) -> None:
        """Ignore the time until the next arrival: it is not the machine's interval."""
        self._is_interrupted = True

    def age(self, now: float) -> float | None:
        """Return the time since the last arrival, in s; None before the first one."""
        return None if self._last is None else max(now - self._last, 0.0)

    @property
    def stale_after(self) -> float:
        """Age from which data are old, in s."""
        if len(self._gaps) < LEARNED:
            return LEAST_STALE
        return max(LEAST_STALE, INTERVALS * median(self._gaps))

    def freshness(self, now: float, *, is_connected: bool, is_at_rest: bool) -> Freshness:
        """Return whether the values of the last arrival can be trusted."""
        age = self.age(now)
        if age is None:
            return Freshness.NONE
        if not is_connected:
            return Freshness.STALE
        if age <= self.stale_after:
            return Freshness.FRESH
        # A machine at rest has nothing to report: its last values still hold.
        return Freshness.QUIET if is_at_rest else Freshness.STALE
