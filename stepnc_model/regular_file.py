"""Files that are none: folders, devices, pipes and sockets.

Opening a pipe waits for somebody who writes into it, and a device such as ``/dev/zero`` never
ends. Whatever opens a file whose name comes from a user opens it here, or asks here first.
"""

import errno
import os
from pathlib import Path
from stat import S_IFBLK, S_IFCHR, S_IFDIR, S_IFIFO, S_IFMT, S_IFSOCK
from typing import BinaryIO

KINDS = {
    S_IFCHR: "device",
    S_IFBLK: "device",
    S_IFIFO: "pipe",
    S_IFSOCK: "socket",
    S_IFDIR: "folder",
}
"""Kinds of files that may never end, block for ever, or have no content."""


def why_irregular(path: Path) -> str:
    """Reason why a path is not that of a regular file; empty if it is, or is not known.

    A path that leads nowhere, or must not be read, is not known: opening it tells more.

    Raises
    ------
    ValueError
        If no file can have such a name.
    """
    try:
        mode = path.stat().st_mode
    except OSError:
        return ""
    return _reason(mode)


def open_regular(path: Path) -> BinaryIO:
    """Open a regular file for reading, without ever waiting for a writer.

    The open file is asked for its kind again: what the path leads to may have changed since.

    Raises
    ------
    OSError
        If it cannot be opened, or is not a regular file.
    ValueError
        If no file can have such a name.
    """
    _require(why_irregular(path), path)
    file = open(path, "rb", opener=_opened)  # noqa: SIM115 (the caller closes it)
    try:
        _require(_reason(os.fstat(file.fileno()).st_mode), path)
    except BaseException:
        file.close()
        raise
    return file


def _opened(path: str, flags: int) -> int:
    # Without the flag, opening a pipe would wait for a writer; regular files ignore it.
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))


def _require(reason: str, path: Path) -> None:
    if reason:
        raise OSError(errno.EINVAL, reason, str(path))


def _reason(mode: int) -> str:
    kind = S_IFMT(mode)
    return f"is a {KINDS[kind]}, not a regular file" if kind in KINDS else ""
