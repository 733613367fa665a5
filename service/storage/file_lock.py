"""Lock on a folder, between threads and processes."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LOCK = ".lock"
"""name of the file in the folder that is locked; it stays"""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder; wait for it first."""
    with (folder / LOCK).open("wb") as file:
        # Freed when the file is closed, also when the process dies.
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
