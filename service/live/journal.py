"""Journals of JSON lines that one process appends while others read them.

Each line is written in one call while the file is locked, so that readers see whole lines only;
text after the last line break is still being written, or was cut off when its writer died.
Lines that were cut off are skipped. A line for which the disk has no room is removed again.
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
