"""Writing to disk with the project's own errors when the disk is full or fails."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile

from service.errors import StorageFull, Unavailable

FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
"""Error numbers of the operating system that mean that the disk or the quota is full."""

SMALL = 4096
"""Bytes of a file that shows whether the disk has room."""


@contextmanager
def storing(what: str) -> Iterator[None]:
    """Convert errors of the operating system to those of the project.

    Parameters
    ----------
    what : str
        File name for messages, without its folder.

    Raises
    ------
    StorageFull
        When the disk is full.
    Unavailable
        When the file cannot be written for another reason, such as a missing folder.
    """
    try:
        yield
    except OSError as error:
        if error.errno in FULL:
            raise StorageFull(f"{what}: {error.strerror}") from error
        raise Unavailable(f"{what}: {error.strerror or error}") from error


def has_room(folder: Path) -> bool:
    """Whether a small file can be written into a folder."""
    try:
        with TemporaryFile(dir=folder) as file:
            file.write(bytes(SMALL))
    except OSError:
        return False
    return True


def write_whole(descriptor: int, content: bytes) -> None:
    """Write all bytes, repeating the call if it writes only some of them.

    Raises
    ------
    OSError
        When the disk refuses; some bytes may be written.
    """
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(descriptor, rest) :]
