"""Progress messages of long-running work."""

import re
import time
from collections.abc import Callable

Tell = Callable[[str], None]
"""Callback that receives messages."""


def silent(_message: str) -> None:
    """Discard a message."""


INTERVAL = 2.0
"""Time before the first message and between two messages, in s."""

WIDTH = 20
"""Width of a progress bar, in characters."""


def bar(share: float) -> str:
    """Return a progress bar for a share of 0 to 1, with the percentage."""
    full = int(share * WIDTH)
    return f"[{'#' * full}{'-' * (WIDTH - full)}] {share:4.0%}"


def share_in(message: str) -> float | None:
    """Parse the share done from a progress message; None if the message has none."""
    if found := re.search(r"\[[#-]+\] +(\d+)%", message):
        return int(found[1]) / 100.0
    if found := re.match(r"(\d+) of (\d+) ", message):
        return int(found[1]) / max(int(found[2]), 1)
    return None


class Ticker:
    """Reports progress at regular intervals. Running state."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._last = time.monotonic()

    def __call__(self, words: Callable[[], str]) -> None:
        """Report the progress if the interval has passed."""
        now = time.monotonic()
        if now - self._last >= INTERVAL:
            self._last = now
            self._tell(words())


class Progress:
    """Counts finished workingsteps and reports progress at regular intervals. Running state."""

    def __init__(self, tell: Callable[[str], None], *, total: int) -> None:
        self._ticker = Ticker(tell)
        self._total = total
        self._done = 0

    def __call__(self) -> None:
        """Count one more finished workingstep."""
        self._done += 1
        self._ticker(lambda: f"{self._done} of {self._total} workingsteps")
