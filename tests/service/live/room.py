"""A process whose files may have so many bytes: a full disk for those who may not mount one."""

import sys
from pathlib import Path
from subprocess import run

LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
"""


def within_room(code: str, file: Path, *, room: int) -> str:
    """What a piece of code says that works on a file, ``sys.argv[1]``, within some bytes."""
    words = [sys.executable, "-c", LIMITED + code, str(file), str(room)]
    found = run(words, capture_output=True, text=True, timeout=120.0, check=False)
    assert found.returncode == 0, found.stderr
    return found.stdout
