"""Files that are none: folders, devices, pipes and sockets.

Opening a pipe waits for somebody who writes into it, and a device such as ``/dev/zero`` never
ends. Whatever opens a file whose name comes from a user asks here first.
"""

from pathlib import Path
from stat import S_IFBLK, S_IFCHR, S_IFDIR, S_IFIFO, S_IFMT, S_IFSOCK

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

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        If no file can have such a name.
    """
    try:
        kind = S_IFMT(path.stat().st_mode)
    except OSError:
        return ""
    return f"is a {KINDS[kind]}, not a regular file" if kind in KINDS else ""
