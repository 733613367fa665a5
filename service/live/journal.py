"""Journals of JSON lines that one process appends while others read them.

Each line is written in one call while the file is locked, so that readers see whole lines only;
text after the last line break is still being written, or was cut off when its writer died.
Lines that were cut off are skipped. A line for which the disk has no room is removed again.

Writing to disk with the project's own errors when the disk is full or fails.

Files of a live run in the folder of its job.
"""

import errno
import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

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
    """True if a small file can be written into a folder."""
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


LONGEST = 1 << 20
"""Most bytes that are read at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JournalPart:
    """Lines read from a journal, and the offset of the next line."""

    lines: tuple[dict[str, Any], ...]
    offset: int
    """Offset of the next line, in bytes from the beginning of the file."""


def append(file: Path, entry: Mapping[str, Any]) -> None:
    """Append a line to a journal; several processes may do so.

    Raises
    ------
    StorageFull, Unavailable
        When the line cannot be written; the file is unchanged then.
    """
    line = json.dumps(entry, ensure_ascii=False, allow_nan=False).encode() + b"\n"
    with storing(file.name):
        descriptor = os.open(file, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o600)
        try:
            # The lock is released when the file is closed.
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            _add(descriptor, line)
        finally:
            os.close(descriptor)


def _add(descriptor: int, line: bytes) -> None:
    """Write a line at the end of the file, or nothing."""
    begin = os.fstat(descriptor).st_size
    is_cut = begin > 0 and os.pread(descriptor, 1, begin - 1) != b"\n"
    try:
        write_whole(descriptor, b"\n" + line if is_cut else line)
    except OSError:
        os.ftruncate(descriptor, begin)
        raise


def read_on(file: Path, offset: int) -> JournalPart:
    """Read the lines from an offset on; none when the file does not exist yet."""
    try:
        with file.open("rb") as opened:
            opened.seek(offset)
            text = opened.read(LONGEST)
    except FileNotFoundError:
        return JournalPart(lines=(), offset=offset)
    whole = text[: text.rfind(b"\n") + 1]
    lines = (_parsed(line) for line in whole.split(b"\n"))
    found = tuple(line for line in lines if line is not None)
    return JournalPart(lines=found, offset=offset + len(whole))


def _parsed(line: bytes) -> dict[str, Any] | None:
    try:
        found = json.loads(line)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


FORMER = {"is_over": "is_overloaded"}
"""Keys of a status written by earlier versions, with their current names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveFolder:
    """Folder through which a run reports and takes orders."""

    path: Path

    @property
    def series(self) -> Path:
        """File of rows, see :mod:`service.live.series`."""
        return self.path / "series.bin"

    @property
    def events(self) -> Path:
        """File of events, one per line."""
        return self.path / "events.jsonl"

    @property
    def orders(self) -> Path:
        """File of orders to the run, one per line."""
        return self.path / "orders.jsonl"

    @property
    def status(self) -> Path:
        """File with the latest status snapshot."""
        return self.path / "status.json"

    def write_status(self, status: Mapping[str, Any]) -> None:
        """Replace the status atomically; it need not survive a crash.

        Raises
        ------
        StorageFull, Unavailable
            When it cannot be written; the old status stays.
        """
        partial = self.path / ".status.json"
        with storing(self.status.name):
            partial.write_text(json.dumps(status, ensure_ascii=False), encoding="utf-8")
            os.replace(partial, self.status)

    def read_status(self) -> dict[str, Any] | None:
        """Return the latest status snapshot; None before the first one."""
        try:
            found: dict[str, Any] = json.loads(self.status.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return {FORMER.get(key, key): value for key, value in found.items()}
