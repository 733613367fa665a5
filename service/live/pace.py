"""Wall time for a run: so many seconds of the machine in one of ours."""

import time
from collections.abc import Callable

from stepnc_model.errors import StepNcError

LEAST, MOST = 0.01, 1000.0
"""times as fast as the machine; 0: as fast as can be"""

TICK = 0.05
"""s of ours between two looks at a run"""


class Pace:
    """Waits until it is time. Running state.

    Parameters
    ----------
    factor : float
        S of the machine in one of ours; 0: nobody waits.
    now : callable
        S of ours.
    wait : callable
        For so many s.

    Raises
    ------
    StepNcError
        When the factor is beyond its bounds.
    """

    def __init__(
        self,
        factor: float,
        *,
        now: Callable[[], float] = time.monotonic,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        if factor != 0.0 and not LEAST <= factor <= MOST:
            bound = f"{LEAST:g} to {MOST:g}, or 0 without waiting"
            raise StepNcError(f"pace {factor:g}: it must be {bound}")
        self._factor, self._now, self._wait = factor, now, wait
        self._begin = now()

    @property
    def factor(self) -> float:
        """S of the machine in one of ours; 0: nobody waits."""
        return self._factor

    def wait_for(self, machine_time: float) -> None:
        """Return when the machine may have come so far."""
        if self._factor:
            rest = self._begin + machine_time / self._factor - self._now()
            if rest > 0.0:
                self._wait(rest)
