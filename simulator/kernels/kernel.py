"""Decorators of kernels, and the call of their machine code.

A kernel is a Python function of numbers, arrays and tuples of them that numba can compile and
that allocates nothing. An entry is a kernel that Python calls; it writes into its arrays and
returns nothing. At its first call with arguments of new types an entry takes its machine code
from a file (:mod:`simulator.kernels.store`), or has numba make it
(:mod:`simulator.kernels.build`). Only then numba is imported, which takes longer than most work
that kernels do. Calls release the global interpreter lock.

Machine code is called by numba's own convention: status returned, two pointers for the result
and an error, then all numbers in order; an array is two references of its owners (none here),
its size, the size of an item, its address, its shape and its strides.
"""

import logging
from collections.abc import Callable, Iterator
from ctypes import CFUNCTYPE, c_double, c_int32, c_int64, c_void_p, create_string_buffer
from functools import update_wrapper
from typing import Generic, ParamSpec, TypeVar

import numpy as np

from simulator.kernels import link, store
from simulator.kernels.identity import digest

Parameters = ParamSpec("Parameters")
Function = TypeVar("Function", bound=Callable[..., object])

LOG = logging.getLogger(__name__)
"""says why nothing happens, on stderr where nobody configures it"""

NOTHING = create_string_buffer(64)
"""where a kernel would write a result or an error"""

Number = int | float
Code = Callable[..., int]


def kernel(function: Function) -> Function:
    """Mark a kernel that only kernels call; called from Python it runs as Python."""
    function.is_kernel = True  # type: ignore[attr-defined]
    return function


class KernelEntry(Generic[Parameters]):
    """A kernel that Python calls."""

    def __init__(self, function: Callable[Parameters, None]) -> None:
        self.function = function
        """the same as plain Python"""
        self._codes: dict[object, Code] = {}
        """machine code by the types of the arguments"""
        update_wrapper(self, function)

    def __call__(self, *arguments: Parameters.args, **named: Parameters.kwargs) -> None:
        """Run the machine code.

        Raises
        ------
        TypeError
            When arguments are named, or none that a kernel takes.
        MemoryError
            When the kernel fails, which kernels have no other reason for.
        """
        if named:
            raise TypeError(f"{self.function.__name__}: arguments of a kernel have no names")
        types = _type_of(arguments)
        if types not in self._codes:
            self._codes[types] = self._code(types, arguments)
        if self._codes[types](NOTHING, NOTHING, *_numbers(arguments)):
            raise MemoryError(f"kernel {self.function.__name__} failed")

    def _code(self, types: object, arguments: tuple[object, ...]) -> Code:
        """Machine code of this kernel for arguments of some types."""
        name, key = self.function.__name__, digest(self.function, types)
        found = store.load(name, key)
        if found is None:
            LOG.warning("compiling %s for this machine, once: up to half a minute", name)
            from simulator.kernels.build import object_code  # noqa: PLC0415 (numba takes a second)

            found = object_code(self.function, arguments, symbol=f"{name}_{key}")
            store.save(name, key, found)
        prototype = CFUNCTYPE(c_int32, c_void_p, c_void_p, *_ctypes(arguments))
        return prototype(link.address_of(found, f"{name}_{key}"))


def entry(function: Callable[Parameters, None]) -> KernelEntry[Parameters]:
    """Make a kernel one that Python calls."""
    return KernelEntry(function)


def _type_of(value: object) -> object:
    """Part of a value that machine code depends on."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.ndim, value.flags.c_contiguous, value.flags.writeable
    if isinstance(value, tuple):
        return type(value).__qualname__, tuple(map(_type_of, value))
    if type(value) is int or isinstance(value, float):
        return "int" if type(value) is int else "float"
    raise TypeError(f"a kernel takes numbers, arrays and tuples of them, not {value!r}")


def _numbers(values: tuple[object, ...]) -> Iterator[Number]:
    """All numbers of some values in the order in which machine code takes them."""
    for value in values:
        if isinstance(value, np.ndarray):
            yield from (0, 0, value.size, value.itemsize, value.ctypes.data)
            yield from value.shape
            yield from value.strides
        elif isinstance(value, tuple):
            yield from _numbers(value)
        elif isinstance(value, (int, float)):
            yield value


def _ctypes(values: tuple[object, ...]) -> Iterator[type[c_int64 | c_double]]:
    """Types of those numbers; addresses are integers."""
    for number in _numbers(values):
        yield c_double if isinstance(number, float) else c_int64
