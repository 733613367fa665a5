"""Files of machine code: beside the sources, or in the user's cache where that is not allowed.

A file is found by the digest of everything that its code depends on, so it is never stale; it
begins with a digest of its content, so that a damaged one counts as none. Files appear at once
or not at all, and processes that make the same one at the same time do not disturb each other.
Where no file can be written, machine code is made anew in each process.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile

BESIDE = Path(__file__).parent / "__pycache__"

KEPT = 8
"""files of one kernel: for other arguments, processors and versions"""

_DIGEST = 32  # bytes of SHA-256


def load(name: str, key: str) -> bytes | None:
    """Machine code of a kernel; None where there is none."""
    for folder in _folders():
        with suppress(OSError):
            content = (folder / f"{name}-{key}.o").read_bytes()
            if sha256(content[_DIGEST:]).digest() == content[:_DIGEST]:
                return content[_DIGEST:]
    return None


def save(name: str, key: str, code: bytes) -> None:
    """Keep machine code in the first folder that takes it."""
    for folder in _folders():
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            _write(folder / f"{name}-{key}.o", sha256(code).digest() + code)
            _forget(folder, name)
            return


def _folders() -> Iterator[Path]:
    yield BESIDE
    with suppress(RuntimeError):
        cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        yield Path(cache) / "stepnc-optimiser"


def _write(path: Path, content: bytes) -> None:
    """Put a file in place as a whole."""
    with NamedTemporaryFile(dir=path.parent, delete=False) as file:
        try:
            file.write(content)
            file.close()
            os.chmod(file.name, 0o644)
            os.replace(file.name, path)
        except OSError:
            os.unlink(file.name)
            raise


def _forget(folder: Path, name: str) -> None:
    """Remove all but the latest files of a kernel."""
    files = sorted(folder.glob(f"{name}-*.o"), key=lambda path: path.stat().st_mtime)
    for path in files[:-KEPT]:
        path.unlink(missing_ok=True)
