"""Reading of files, and atomic writing: an output file appears whole or not at all.

Names of files in messages: stored files are named as their owners named them.
"""

import os
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path

from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.regular_file import open_regular, why_irregular

MOST_BYTES = 1 << 31
"""Largest file that is read as a whole, bytes."""


def read_head(path: Path, size: int) -> bytes:
    """Read the beginning of a file.

    Raises
    ------
    StepNcError
        When it cannot be read.
    """
    try:
        with open_regular(path) as file:
            return file.read(size)
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is not a valid file name: {error}") from error


def read_bytes(path: Path, *, most: int = MOST_BYTES) -> bytes:
    """Read all bytes of a file.

    Raises
    ------
    StepNcError
        When it cannot be read, or is larger than ``most``, which is known before it is read.
    """
    try:
        with open_regular(path) as file:
            size = os.fstat(file.fileno()).st_size
            if size > most:
                raise StepNcError(f"{path}: {size} bytes; at most {most} are read")
            return file.read()
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is not a valid file name: {error}") from error


def require_regular(path: Path) -> None:
    """Refuse what is no regular file before it is opened: opening a pipe waits for a writer.

    Raises
    ------
    StepNcError
    """
    try:
        reason = why_irregular(path)
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is not a valid file name: {error}") from error
    if reason:
        raise StepNcError(f"{path}: {reason}")


LONGEST_LINE = 100_000
"""Largest number of characters in a line; longer lines are not taken for text."""


def open_lines(path: Path) -> Iterator[str]:
    """Yield the lines of a text file lazily; errors of opening are raised at once."""
    try:
        file = TextIOWrapper(open_regular(path), encoding="utf-8", errors="replace")
    except OSError as error:
        raise StepNcError(f"{path}: {_reason(error)}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is not a valid file name: {error}") from error

    def lines() -> Iterator[str]:
        with file:
            try:
                while line := file.readline(LONGEST_LINE):
                    if len(line) == LONGEST_LINE:
                        raise StepNcError(f"{path}: line longer than {LONGEST_LINE} characters")
                    yield line
            except OSError as error:
                raise StepNcError(f"{path}: {_reason(error)}") from error

    return lines()


def is_same(one: Path, other: Path) -> bool:
    """Return whether two paths lead to the same file.

    Raises
    ------
    StepNcError
        When a path is not valid, or must not be read.
    """
    try:
        if one.resolve() == other.resolve():
            return True
        if one.exists() and other.exists():
            return one.samefile(other)
        # Two new files whose names differ in case only are one file on many disks.
        is_new = not one.exists() and not other.exists()
        return is_new and str(one.resolve()).casefold() == str(other.resolve()).casefold()
    except OSError as error:
        raise StepNcError(f"{error.filename}: {_reason(error)}") from error
    except RuntimeError as error:
        raise StepNcError(f"{one} or {other}: symbolic links form a loop") from error
    except ValueError as error:
        raise StepNcError(f"{str(one)!r} or {str(other)!r} is not a valid file name") from error


def sibling(path: Path, suffix: str) -> Path:
    """Return the path of the file with the same name and another extension.

    Raises
    ------
    StepNcError
        When the path has no file name.
    """
    if not path.name:
        raise StepNcError(f"{path}: is not a file")
    return path.with_suffix(suffix)


def require_place(path: Path, *, apart_from: Path) -> None:
    """Refuse an output path that is another file of the run, or whose folder does not exist."""
    require_places([path], apart_from=[apart_from])


def require_places(
    outputs: Iterable[Path | None], *, apart_from: Iterable[Path | None] = ()
) -> None:
    """Refuse outputs as :func:`require_distinct` does, and those whose folder does not exist.

    Raises
    ------
    WriteError
    """
    places = list(outputs)
    require_distinct(places, apart_from=apart_from)
    for place in places:
        if place is not None and not place.parent.is_dir():
            raise WriteError("the folder does not exist", path=str(place))


def require_distinct(
    outputs: Iterable[Path | None], *, apart_from: Iterable[Path | None] = ()
) -> None:
    """Refuse outputs of one command that are the same file, or a file that it reads.

    Symbolic and hard links, ``..`` and, for new files, letter case are seen through. What one
    output overwrites would be lost without a word.

    Parameters
    ----------
    outputs : iterable of Path or None
        Places to be written; None where an output was not asked for.
    apart_from : iterable of Path or None
        Files that are read.

    Raises
    ------
    WriteError
        With the first such place.
    """
    others = [each for each in apart_from if each is not None]
    for place in outputs:
        if place is None:
            continue
        for other in others:
            if is_same(place, other):
                message = f"is the same file as {other}; name another file"
                raise WriteError(message, path=str(place))
        others.append(place)


def write_atomically(path: Path, data: bytes) -> None:
    """Write a temporary file, then move it into place: readers see the old file or the new one.

    Parameters
    ----------
    data : bytes

    Raises
    ------
    WriteError
        When the folder or the disk refuses; an existing file stays unchanged.
    """
    _write_chunks(path, (data,))


def write_lines(path: Path, lines: Iterable[str]) -> int:
    """Write lines of text as they are generated, whole or not at all; return the line count.

    Raises
    ------
    WriteError
        As :func:`write_atomically`; errors raised while generating the lines pass through.
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
    """Write chunks to a temporary file in the same folder, then move it into place."""
    name = ""
    try:
        path = path.resolve() if path.is_symlink() else path
        if path.exists() and not path.is_file():
            raise WriteError("is not a regular file", path=str(path))
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
    """Permissions of the file to be replaced, or the default ones of a new file."""
    if path.exists():
        return path.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def _reason(error: OSError) -> str:
    """Return the message of an operating system error, without its number."""
    return error.strerror or str(error)


PROGRAMS = frozenset({
    ".stpnc",
    ".stp",
    ".step",
    ".p21",
    ".238",
    ".stpncz",
    ".stpz",
    ".238z",
    ".p21z",
})
"""Suffixes of STEP-NC programs; other files are NC code."""

LOGS = frozenset({".parquet", ".csv", ".xml", ".shdr", ".log"})
"""Suffixes of recorded runs."""

Names = Mapping[Path, str]
"""Names that owners gave to files."""


def with_names(text: str, names: Names) -> str:
    """Return a text with the owners' names of files in place of their paths."""
    named = {word: name for path, name in names.items() for word in (path.name, str(path))}
    # A name may hold the end of its path, and is not to be named again.
    named |= {name: name for name in names.values() if name}
    words = sorted(named, key=len, reverse=True)
    if not words:
        return text
    return re.sub("|".join(map(re.escape, words)), lambda found: named[found[0]], text)


@contextmanager
def naming(names: Names) -> Iterator[None]:
    """Let errors within it name files as their owners named them.

    Raises
    ------
    StepNcError
        In place of one that names a path; others pass unchanged.
    """
    try:
        yield
    except StepNcError as error:
        text = with_names(str(error), names)
        if text == str(error):
            raise
        raise StepNcError(text) from error


def plain_name(text: str) -> str:
    """Return a text as it can name a file everywhere."""
    return re.sub(r"[^A-Za-z0-9._-]", "_", text)[:150]
