"""Progress of what takes longer than a person likes to wait."""

import re
import time
from collections.abc import Callable

INTERVAL = 2.0
"""s between two messages, and before the first"""

WIDTH = 20
"""characters of a bar"""


def bar(share: float) -> str:
    """A bar for a share of 0 to 1, and the share in per cent."""
    full = int(share * WIDTH)
    return f"[{'#' * full}{'-' * (WIDTH - full)}] {share:4.0%}"


def share_in(message: str) -> float | None:
    """The share that a message with a :func:`bar` or a count tells; None: it tells none."""
    if found := re.search(r"\[[#-]+\] +(\d+)%", message):
        return int(found[1]) / 100.0
    if found := re.match(r"(\d+) of (\d+) ", message):
        return int(found[1]) / max(int(found[2]), 1)
    return None


class Ticker:
    """Says now and then how far something is; running state."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._last = time.monotonic()

    def __call__(self, words: Callable[[], str]) -> None:
        """Say it, when it is time again."""
        now = time.monotonic()
        if now - self._last >= INTERVAL:
            self._last = now
            self._tell(words())


class Progress:
    """Counts, and tells how far it is every now and then; running state."""

    def __init__(self, tell: Callable[[str], None], *, total: int) -> None:
        self._ticker = Ticker(tell)
        self._total = total
        self._done = 0

    def __call__(self) -> None:
        """One more is done."""
        self._done += 1
        self._ticker(lambda: f"{self._done} of {self._total} workingsteps")
