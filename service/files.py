"""Writing files: whole or not at all."""

import os
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from stepnc_model.errors import StepNcError, WriteError


def read_bytes(path: Path) -> bytes:
    """All bytes of a file; an error of the project's own when it cannot be read."""
    try:
        if path.is_char_device():
            raise StepNcError(f"{path}: is a device, no file")
        return path.read_bytes()
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is no file name: {error}") from error


LONGEST_LINE = 100_000
"""letters; longer lines are no text for people or controls"""


def open_lines(path: Path) -> Iterator[str]:
    """Lines of a text file, read as they are asked for; its first fault at once."""
    try:
        file = path.open(encoding="utf-8", errors="replace")
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is no file name: {error}") from error

    def lines() -> Iterator[str]:
        with file:
            try:
                while line := file.readline(LONGEST_LINE):
                    if len(line) == LONGEST_LINE:
                        raise StepNcError(f"{path}: a line of more than {LONGEST_LINE} letters")
                    yield line
            except OSError as error:
                raise StepNcError(f"{path}: {_reason(error)}") from error

    return lines()


def is_same(one: Path, other: Path) -> bool:
    """Whether two paths lead to one file.

    Raises
    ------
    StepNcError
        When a path is no path, or lies where one may not look.
    """
    try:
        if one.resolve() == other.resolve():
            return True
        return one.exists() and other.exists() and one.samefile(other)
    except OSError as error:
        raise StepNcError(f"{error.filename}: {_reason(error)}") from error
    except RuntimeError as error:
        raise StepNcError(f"{one} or {other}: links that lead in a circle") from error
    except ValueError as error:
        raise StepNcError(f"{str(one)!r} or {str(other)!r} is no file name") from error


def beside(path: Path, suffix: str) -> Path:
    """The file of the same name with another ending.

    Raises
    ------
    StepNcError
        When the path has no name.
    """
    if not path.name:
        raise StepNcError(f"{path}: is no file")
    return path.with_suffix(suffix)


def require_place(path: Path, *, apart_from: Path) -> None:
    """Refuse an output that is another file of the same run, or has no folder."""
    if is_same(path, apart_from):
        raise WriteError(f"is also {apart_from}; name another file", path=str(path))
    if not path.parent.is_dir():
        raise WriteError("the folder does not exist", path=str(path))


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
    _write_chunks(path, (data,))


def write_lines(path: Path, lines: Iterable[str]) -> int:
    """Write lines of text as they are made, whole or not at all; how many there were.

    Raises
    ------
    WriteError
        As :func:`write_atomically`; errors of what makes the lines pass through.
    """
    count = 0

    def chunks() -> Iterator[bytes]:
        nonlocal count
        for line in lines:
            count += 1
            yield line.encode() + b"\n"

    _write_chunks(path, chunks())
    return count


def _write_chunks(path: Path, chunks: Iterable[bytes]) -> None:
    """Write beside the place, then move it there."""
    name = ""
    try:
        path = path.resolve() if path.is_symlink() else path
        if path.exists() and not path.is_file():
            raise WriteError("is no regular file", path=str(path))
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(descriptor, "wb") as file:
            file.writelines(chunks)
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
    """Message of the operating system, without its number."""
    return error.strerror or str(error)
