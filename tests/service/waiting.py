"""Waiting for what other processes do: bounded, and hardly longer than it takes."""

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from subprocess import Popen
from typing import Any, TypeVar

T = TypeVar("T")

LOOK = 0.02
"""s between the first two looks"""

LONG = 120.0
"""s that nothing takes, even on a busy machine"""

SELDOM = 0.25
"""s between two looks at most"""

LATE = 0.1
"""share of the time waited that may pass until the next look: a look costs both sides"""


def until(look: Callable[[], T | None], *, within: float = LONG) -> T:
    """What a look finds, as soon as it finds something."""
    start = time.monotonic()
    while not (found := look()):
        waited = time.monotonic() - start
        assert waited < within, f"not within {within:g} s"
        threading.Event().wait(min(max(LOOK, LATE * waited), SELDOM))
    return found


def ended(process: Popen[Any]) -> int:
    """Exit code of a process that ends by itself, or was told to."""
    return process.wait(LONG)


def is_alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and was not asked for its code does not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False
    return stat.rpartition(")")[2].split()[0] not in {"Z", "X"}


def children(pid: int) -> set[int]:
    """Processes below a process, near and far."""
    found: dict[int, list[int]] = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                stat = (folder / "stat").read_text(encoding="ascii", errors="replace")
            except OSError:
                continue
            parent = int(stat.rpartition(")")[2].split()[1])
            found.setdefault(parent, []).append(int(folder.name))
    below, left = set[int](), [pid]
    while left:
        more = found.get(left.pop(), [])
        below.update(more)
        left += more
    return below


def rss_mib(pid: int) -> float:
    """Memory of a process."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / (1 << 20)


ROOT = Path(__file__).parents[2]


def environment(home: Path) -> dict[str, str]:
    """For a process of the service: a home of its own, and nothing of ours."""
    found = {name: text for name, text in os.environ.items() if not name.startswith("STEPNC_")}
    return {**found, "XDG_DATA_HOME": str(home), "HOME": str(home)}
