"""Writing files: whole or not at all."""

import os
import tempfile
from pathlib import Path

from stepnc_model.errors import StepNcError, WriteError


def read_bytes(path: Path) -> bytes:
    """All bytes of a file; an error of the project's own when it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file beside its place, then move it there: readers see the old or the new.

    Parameters
    ----------
    path : Path
    data : bytes

    Raises
    ------
    WriteError
        When the folder or the disk refuses; what was there stays as it was.
    """
    name = ""
    try:
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, _mode(path))
        os.replace(name, path)
        name = ""
    except OSError as error:
        raise WriteError(_reason(error), path=str(path)) from error
    finally:
        if name:
            Path(name).unlink(missing_ok=True)


def _mode(path: Path) -> int:
    """Permissions of the file that is replaced, or what a new file gets."""
    if path.exists():
        return path.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def _reason(error: OSError) -> str:
    """What the operating system says, without its number."""
    return error.strerror or str(error)
