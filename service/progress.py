"""Progress of what takes longer than a person likes to wait."""

import time
from collections.abc import Callable

INTERVAL = 2.0
"""s between two messages, and before the first"""


class Progress:
    """Counts, and tells how far it is every now and then; running state."""

    def __init__(self, tell: Callable[[str], None], *, total: int) -> None:
        self._tell = tell
        self._total = total
        self._done = 0
        self._last = time.monotonic()

    def __call__(self) -> None:
        """One more is done."""
        self._done += 1
        now = time.monotonic()
        if now - self._last >= INTERVAL:
            self._last = now
            self._tell(f"{self._done} of {self._total} workingsteps")
