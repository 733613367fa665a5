"""Lines of JSON that one process appends and others read while it goes on.

A line is written at once, by one process after another, so that a reader meets whole lines
only; what stands behind the last line break is still being written, or was cut off when its
writer died. A line that was cut off is none: it is passed over, and the next begins anew. One
for which the disk has no room is taken back.
"""

import fcntl
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.live.storage import storing, write_whole

LONGEST = 1 << 20
"""bytes that are read at once"""


@dataclass(frozen=True, slots=True, kw_only=True)
class JournalPart:
    """Lines, and where the next begins."""

    lines: tuple[dict[str, Any], ...]
    offset: int
    """Offset, bytes from the beginning of the file"""


def append(file: Path, entry: Mapping[str, Any]) -> None:
    """Add a line; several processes may.

    Raises
    ------
    StorageFull, Unavailable
        When it cannot be written; the file is as it was then.
    """
    line = json.dumps(entry, ensure_ascii=False, allow_nan=False).encode() + b"\n"
    with storing(file.name):
        descriptor = os.open(file, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o600)
        try:
            # Free again when it is closed.
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            _add(descriptor, line)
        finally:
            os.close(descriptor)


def _add(descriptor: int, line: bytes) -> None:
    """A line at the end, or nothing."""
    begin = os.fstat(descriptor).st_size
    is_cut = begin > 0 and os.pread(descriptor, 1, begin - 1) != b"\n"
    try:
        write_whole(descriptor, b"\n" + line if is_cut else line)
    except OSError:
        os.ftruncate(descriptor, begin)
        raise


def read_on(file: Path, offset: int) -> JournalPart:
    """Lines from an offset on; none when the file does not exist yet."""
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
