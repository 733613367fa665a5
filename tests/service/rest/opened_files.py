"""Watch on a folder of files: which of them any process has opened (inotify of Linux)."""

import ctypes
import os
import struct
from contextlib import suppress
from pathlib import Path
from types import TracebackType

IN_OPEN, IN_CREATE, IN_DELETE, IN_Q_OVERFLOW = 0x20, 0x100, 0x200, 0x4000

EVENT = struct.Struct("iIII")


class OpenedFiles:
    """Files of a folder that were opened, made or deleted since. Running state."""

    def __init__(self, folder: Path) -> None:
        libc = ctypes.CDLL(None, use_errno=True)
        self._queue = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        what = IN_OPEN | IN_CREATE | IN_DELETE
        if self._queue < 0 or libc.inotify_add_watch(self._queue, bytes(folder), what) < 0:
            raise OSError(ctypes.get_errno(), "inotify")

    def __enter__(self) -> "OpenedFiles":
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        os.close(self._queue)

    def taken(self) -> set[str]:
        """Names since the last call; an empty one is that of the folder."""
        found: set[str] = set()
        with suppress(BlockingIOError):
            while data := os.read(self._queue, 1 << 16):
                while data:
                    _, mask, _, size = EVENT.unpack_from(data)
                    assert not mask & IN_Q_OVERFLOW
                    name = data[EVENT.size : EVENT.size + size].rstrip(b"\0")
                    found.add(os.fsdecode(name))
                    data = data[EVENT.size + size :]
        return found
