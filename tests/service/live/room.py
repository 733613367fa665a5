"""A process whose files may have so many bytes: a full disk for those who may not mount one."""

import sys
from pathlib import Path
from subprocess import run

LIMITED = """
import resource, sys
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
del sys.argv[1]
"""


def within_room(code: str, *words: Path | str, room: int) -> str:
    """What a piece of code says that has some words, and so many bytes for each file."""
    words = (sys.executable, "-c", LIMITED + code, str(room), *map(str, words))
    found = run(words, capture_output=True, text=True, timeout=120.0, check=False)
    assert found.returncode == 0, found.stderr
    return found.stdout
