"""Checks of programs: few at a time, and none twice.

The check of a large program takes some seconds and some hundred MB, and its answer does not
change: answers are kept, within a bound of bytes, those asked for last.
"""

from collections import OrderedDict
from collections.abc import Callable
from typing import TypeVar

from anyio import CapacityLimiter, to_thread

T = TypeVar("T")

MOST_AT_ONCE = 2

MOST_BYTES = 32 << 20
"""of answers that are kept"""

READERS = CapacityLimiter(MOST_AT_ONCE)
"""of programs, all of it in memory"""


async def in_turn(read: Callable[[], T]) -> T:
    """Read a program in a thread, when not too many do."""
    return await to_thread.run_sync(read, limiter=READERS)


class CheckCache:
    """Answers that were given lately. Running state."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, bytes] = OrderedDict()
        self._size = 0

    async def get(self, name: str, make: Callable[[], bytes]) -> bytes:
        """The answer of a name: the one that is kept, else one that is made in turn."""

        def made() -> bytes:
            # Who waited for the same finds it now.
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
