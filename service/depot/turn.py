"""Changing a folder in turn: one thread of one process after the other."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LOCK = ".lock"
"""name of the file in the folder that is locked; it stays"""


@contextmanager
def turn(folder: Path) -> Iterator[None]:
    """Wait until nobody else changes a folder, and keep them waiting."""
    with (folder / LOCK).open("wb") as file:
        # Freed when the file is closed, also when the process dies.
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
