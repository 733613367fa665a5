"""Writing where a disk may be full: all of it or an error of the project's own."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager

from service.errors import StorageFull, Unavailable

FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
"""reasons for which a file grows no more"""


@contextmanager
def storing(what: str) -> Iterator[None]:
    """Tell the operating system's refusals as the project's.

    Parameters
    ----------
    what : str
        The file as people know it, without its folder.

    Raises
    ------
    StorageFull
        When there is no room.
    Unavailable
        When it cannot be written for another reason: its folder is gone.
    """
    try:
        yield
    except OSError as error:
        if error.errno in FULL:
            raise StorageFull(f"{what}: {error.strerror}") from error
        raise Unavailable(f"{what}: {error.strerror or error}") from error


def write_whole(descriptor: int, content: bytes) -> None:
    """Write all bytes: one call may take but some of them, so that the next says why.

    Raises
    ------
    OSError
        When the disk refuses; some bytes may be written.
    """
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(descriptor, rest) :]
