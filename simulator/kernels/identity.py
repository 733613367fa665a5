"""Identity of a kernel's machine code: a digest of everything that it depends on.

That is: the bytecode of the kernel and of all kernels that it calls, with their constants; the
types of the arguments; the versions of Python and of the compilers; and the processor. File
names and line numbers are not included.
"""

import sys
from collections.abc import Callable, Iterator
from hashlib import sha256
from importlib.metadata import version
from types import FunctionType, ModuleType
from typing import Any

from simulator.kernels import link

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
