"""Identity of a kernel's machine code: everything that it depends on, as one digest.

That is the bytecode of the kernel and of all kernels that it calls, with their constants; the
types of the arguments; the versions of Python and of what compiles; and the processor. Files
and line numbers do not count.
"""

import sys
from collections.abc import Callable, Iterator
from hashlib import sha256
from importlib.metadata import version
from types import FunctionType, ModuleType
from typing import Any

from simulator.kernels import link

COMPILERS = ("numba", "llvmlite", "numpy")

FORM = "1"
"""of how machine code is made and called here; a change makes all of it anew"""


def digest(function: Callable[..., object], types: object) -> str:
    """Digest of a kernel for arguments of some types, 32 hexadecimal digits."""
    parts = [FORM, sys.implementation.cache_tag, sys.version, *map(version, COMPILERS)]
    parts += [*link.processor(), repr(types), *_parts(function, set())]
    return sha256("\0".join(map(str, parts)).encode()).hexdigest()[:32]


def is_kernel(value: object) -> bool:
    """Whether a kernel may call it."""
    return hasattr(value, "is_kernel")


def names_of(function: Any) -> Iterator[tuple[str, object]]:
    """Names of its module that a kernel uses, with their values, in the kernel's order.

    An attribute of the same name as something in the module counts as well.
    """
    for name in function.__code__.co_names:
        if name in function.__globals__:
            yield name, function.__globals__[name]


def _parts(function: Any, seen: set[object]) -> Iterator[str]:
    """A kernel and what it calls, each once."""
    if function in seen:
        return
    seen.add(function)
    code = function.__code__
    yield function.__qualname__
    yield from map(repr, (code.co_code, code.co_consts, code.co_names, code.co_varnames))
    yield repr((code.co_exceptiontable, function.__defaults__))
    for name, value in names_of(function):
        yield name
        if is_kernel(value):
            yield from _parts(value, seen)
        elif isinstance(value, type) and hasattr(value, "_fields"):
            yield repr((value.__qualname__, value._fields))
        elif not isinstance(value, (FunctionType, ModuleType)):
            yield repr(value)
