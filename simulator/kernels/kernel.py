"""Decorators for kernels, and the call of their machine code.

A kernel is a Python function of numbers, arrays and tuples of them that numba can compile and
that allocates no memory. An entry is a kernel that Python can call; it writes its results into
its arrays and returns nothing. At the first call with new argument types an entry loads its
machine code from a file (:mod:`simulator.kernels.store`), or numba compiles it
(:mod:`simulator.kernels.build`). numba is imported only then, as this takes longer than most
work done by kernels. Calls release the global interpreter lock.

Machine code gets the address of all numbers of the arguments in order, eight bytes each, and
returns a status. An array is passed as two owner references (none here), its size, item size,
address, shape and strides. Checking and collecting the numbers takes longer than a small kernel
runs. A loop that calls a kernel again and again with the same arrays therefore binds them once
(:meth:`KernelEntry.bound`) and writes into them what changes.
"""

import logging
from collections.abc import Callable, Iterable
from ctypes import CFUNCTYPE, addressof, c_char, c_char_p, c_int32
from functools import update_wrapper
from struct import Struct
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from simulator.kernels import link, store
from simulator.kernels.store import digest

Parameters = ParamSpec("Parameters")
Function = TypeVar("Function", bound=Callable[..., object])

LOG = logging.getLogger(__name__)
"""Logger that explains a long wait; writes to stderr if logging is not configured."""

Number = int | float
Code = Callable[[bytes], int]
BoundKernel = Callable[[], None]
"""Kernel with arguments; raises a ``MemoryError`` if the kernel fails."""


def kernel(function: Function) -> Function:
    """Mark a kernel that only kernels call; called from Python it runs as plain Python."""
    function.is_kernel = True  # type: ignore[attr-defined]
    return function


def reordered(function: Function) -> Function:
    """Mark a kernel whose sums may be added up in any order, side by side."""
    function.is_reordered = True  # type: ignore[attr-defined]
    return kernel(function)


class KernelEntry(Generic[Parameters]):
    """Kernel that can be called from Python and runs as machine code."""

    def __init__(self, function: Callable[Parameters, None]) -> None:
        self.function = function
        """The kernel as a plain Python function."""
        self._codes: dict[object, tuple[Code, Struct]] = {}
        """Machine code, and the form of its numbers, by the types of the arguments."""
        update_wrapper(self, function)

    def __call__(self, *arguments: Parameters.args, **named: Parameters.kwargs) -> None:
        """Run the machine code, compiling it first if necessary.

        Raises
        ------
        TypeError
            If arguments are passed by name, or have types that a kernel does not accept.
        MemoryError
            If the kernel fails; kernels have no other cause of failure.
        """
        if named:
            raise TypeError(f"{self.function.__name__}: pass kernel arguments by position")
        code, form = self._code(arguments)
        if code(form.pack(*_numbers(arguments))):
            raise MemoryError(f"kernel {self.function.__name__} failed")

    def bound(self, *arguments: Parameters.args, **named: Parameters.kwargs) -> BoundKernel:
        """Return the kernel with fixed arguments; a call then takes no time to convert them.

        Each call reads the contents that the arrays have then. Their memory must stay where it
        is: never resize such an array. Numbers keep their values; one that changes belongs into
        an array.

        Raises
        ------
        TypeError
            As for a call.
        """
        if named:
            raise TypeError(f"{self.function.__name__}: pass kernel arguments by position")
        code, form = self._code(arguments)
        numbers, name = form.pack(*_numbers(arguments)), self.function.__name__

        # The default keeps the arrays, whose addresses are among the numbers.
        def run(_alive: tuple[object, ...] = arguments) -> None:
            if code(numbers):
                raise MemoryError(f"kernel {name} failed")

        return run

    def _code(self, arguments: tuple[object, ...]) -> tuple[Code, Struct]:
        """Return the machine code for arguments of these types, and the form of numbers."""
        types = _type_of(arguments)
        known = self._codes.get(types)
        if known is None:
            known = self._codes[types] = self._loaded(types, arguments), _form(arguments)
        return known

    def _loaded(self, types: object, arguments: tuple[object, ...]) -> Code:
        """Load or compile the machine code of this kernel for given argument types."""
        name, key = self.function.__name__, digest(self.function, types)
        found = store.load(name, key)
        if found is None:
            LOG.warning("compiling %s for this machine (once, up to half a minute)", name)
            from simulator.kernels.build import object_code  # noqa: PLC0415 (numba takes a second)

            found = object_code(self.function, arguments, symbol=f"{name}_{key}")
            store.save(name, key, found)
        # Bytes are passed as the address of what they hold.
        return CFUNCTYPE(c_int32, c_char_p)(link.address_of(found, f"{name}_{key}"))


def entry(function: Callable[Parameters, None]) -> KernelEntry[Parameters]:
    """Turn a kernel into an entry that Python can call."""
    return KernelEntry(function)


def _type_of(value: object) -> object:
    """Type information of a value on which machine code depends."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.ndim, value.flags.c_contiguous, value.flags.writeable
    if isinstance(value, tuple):
        return type(value).__qualname__, tuple(map(_type_of, value))
    if type(value) is int or isinstance(value, float):
        return "int" if type(value) is int else "float"
    raise TypeError(f"a kernel takes numbers, arrays and tuples of them, not {value!r}")


def _numbers(values: Iterable[object]) -> list[Number]:
    """All numbers of some values in the order in which machine code expects them."""
    numbers: list[Number] = []
    for value in values:
        if isinstance(value, np.ndarray):
            numbers += (0, 0, value.size, value.itemsize, _address(value))
            numbers += value.shape
            numbers += value.strides
        elif isinstance(value, tuple):
            numbers += _numbers(value)
        elif isinstance(value, (int, float)):
            numbers.append(value)
    return numbers


def _address(array: NDArray[Any]) -> int:
    """Address of the first item of an array."""
    flags = array.flags
    # An eighth of the time of numpy's own ``ctypes.data``, which small kernels would feel.
    if flags.writeable and flags.c_contiguous and array.size:
        return addressof(c_char.from_buffer(array.data))
    return int(array.ctypes.data)


def _form(values: tuple[object, ...]) -> Struct:
    """Layout of the numbers of some values; addresses are integers."""
    kinds = ("d" if isinstance(number, float) else "q" for number in _numbers(values))
    return Struct("=" + "".join(kinds))
