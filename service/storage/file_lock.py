"""Lock on a folder, between threads and processes."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LOCK = ".lock"
"""Name of the lock file in the folder; it is never deleted."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Acquire the lock of a folder, waiting if necessary, and hold it."""
    with (folder / LOCK).open("wb") as file:
        # Freed when the file is closed, also when the process dies.
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
