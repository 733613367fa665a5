"""Checks of programs: few at a time, with cached answers.

The check of a large program takes some seconds and some hundred MB, and its answer does not
change: recent answers are cached, up to a total size.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import BoundedSemaphore
from typing import TypeVar

from anyio import CapacityLimiter, to_thread

from service.errors import Unavailable

T = TypeVar("T")

MOST_AT_ONCE = 2

MOST_BYTES = 32 << 20
"""Total size of cached answers, in bytes."""

READERS = CapacityLimiter(MOST_AT_ONCE)
"""Limit of threads that read programs, each of which is held in memory."""

READING = BoundedSemaphore(2)
"""Limits how many programs are read at once to check requests; each is held in memory."""

READING_WAIT = 30.0
"""Longest time to wait for one of them, in s: readers that hang must not hold all threads."""


async def in_turn(read: Callable[[], T]) -> T:
    """Read a program in a thread, while few other threads do."""
    return await to_thread.run_sync(read, limiter=READERS)


@contextmanager
def reading_in_turn() -> Iterator[None]:
    """Block in which a program is read, while few others are.

    Raises
    ------
    Unavailable
        When no other reading ends in time.
    """
    if not READING.acquire(timeout=READING_WAIT):
        raise Unavailable(
            f"other programs are still being read after {READING_WAIT:g} s; try again"
        )
    try:
        yield
    finally:
        READING.release()


class CheckCache:
    """Cache of recent check answers. Running state."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._size = 0

    async def get(self, name: str, make: Callable[[], bytes]) -> bytes:
        """Return the cached answer of a name, or compute it."""

        def made() -> bytes:
            # Another request may have computed the same answer while this one waited.
            found = self._kept.get(name)
            return make() if found is None else found

        found = self._kept.get(name)
        if found is None:
            found = await in_turn(made)
        self._keep(name, found)
        return found

    def _keep(self, name: str, answer: bytes) -> None:
        self._size += len(answer) - len(self._kept.pop(name, b""))
        self._kept[name] = answer
        while self._size > MOST_BYTES:
            _, oldest = self._kept.popitem(last=False)
            self._size -= len(oldest)
