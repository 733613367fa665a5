"""Files of machine code, stored beside the sources or in the user's cache folder.

A file is identified by the digest of everything that its code depends on, so it never becomes
outdated. It begins with a digest of its content, so that a damaged file is ignored. Files are
written atomically, and processes that write the same file at once do not disturb each other. If
no file can be written, machine code is compiled again in each process.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from tempfile import NamedTemporaryFile
from types import FunctionType, ModuleType
from typing import Any

from simulator.kernels import link

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


COMPILERS = ("numba", "llvmlite", "numpy")

FORM = "2"
"""Version of how machine code is built and called; changing it rebuilds all kernels."""


def digest(function: Callable[..., object], types: object) -> str:
    """Digest of a kernel for given argument types, as 32 hexadecimal digits."""
    parts = [FORM, sys.implementation.cache_tag, sys.version, *map(version, COMPILERS)]
    parts += [*link.processor(), repr(types), *_parts(function, set())]
    return sha256("\0".join(map(str, parts)).encode()).hexdigest()[:32]


def is_kernel(value: object) -> bool:
    """True if a value is a kernel, which other kernels may call."""
    return hasattr(value, "is_kernel")


def is_reordered(function: object) -> bool:
    """True if the sums of a kernel may be added up in any order."""
    return hasattr(function, "is_reordered")


def names_of(function: Any) -> Iterator[tuple[str, object]]:
    """Global names that a kernel uses, with their values, in the order of its bytecode.

    An attribute with the same name as a global name is included, too.
    """
    for name in function.__code__.co_names:
        if name in function.__globals__:
            yield name, function.__globals__[name]


def _parts(function: Any, seen: set[object]) -> Iterator[str]:
    """Parts of the identity of a kernel and of all kernels that it calls, each once."""
    if function in seen:
        return
    seen.add(function)
    code = function.__code__
    yield function.__qualname__
    yield from map(repr, (code.co_code, code.co_consts, code.co_names, code.co_varnames))
    yield repr((code.co_exceptiontable, function.__defaults__))
    if is_reordered(function):
        yield "reordered"
    for name, value in names_of(function):
        yield name
        if is_kernel(value):
            yield from _parts(value, seen)
        elif isinstance(value, type) and hasattr(value, "_fields"):
            yield repr((value.__qualname__, value._fields))
        elif not isinstance(value, (FunctionType, ModuleType)):
            yield repr(value)
