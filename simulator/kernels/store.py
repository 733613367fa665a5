"""Files of machine code, stored beside the sources or in the user's cache folder.

A file is identified by the digest of everything that its code depends on, so it never becomes
outdated. It begins with a digest of its content, so that a damaged file is ignored. Files are
written atomically, and processes that write the same file at once do not disturb each other. If
no file can be written, machine code is compiled again in each process.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile

PACKAGE_CACHE = Path(__file__).parent / "__pycache__"

KEPT = 8
"""Number of files kept per kernel: for other arguments, processors and versions."""

_DIGEST = 32  # bytes of SHA-256


def load(name: str, key: str) -> bytes | None:
    """Load the machine code of a kernel; None if there is no intact file."""
    for folder in _folders():
        with suppress(OSError):
            content = (folder / f"{name}-{key}.o").read_bytes()
            if sha256(content[_DIGEST:]).digest() == content[:_DIGEST]:
                return content[_DIGEST:]
    return None


def save(name: str, key: str, code: bytes) -> None:
    """Store machine code in the first folder that is writable."""
    for folder in _folders():
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            _write(folder / f"{name}-{key}.o", sha256(code).digest() + code)
            _forget(folder, name)
            return


def _folders() -> Iterator[Path]:
    yield PACKAGE_CACHE
    with suppress(RuntimeError):
        cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        yield Path(cache) / "stepnc-optimiser"


def _write(path: Path, content: bytes) -> None:
    """Write a file atomically."""
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
    """Delete all but the latest files of a kernel."""
    files = sorted(folder.glob(f"{name}-*.o"), key=lambda path: path.stat().st_mtime)
    for path in files[:-KEPT]:
        path.unlink(missing_ok=True)
