"""Compilers of the kernels, typed: what a decorated function takes and gives stays known."""

from collections.abc import Callable
from typing import TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def entry(function: Function) -> Function:
    """Compile a kernel that Python calls."""
    compiled: Function = njit(cache=True, error_model="numpy")(function)
    return compiled


def kernel(function: Function) -> Function:
    """Compile a kernel that only kernels call: without wrappers that takes half the time."""
    compiled: Function = njit(
        cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True
    )(function)
    return compiled


def inlined(function: Function) -> Function:
    """Compile a kernel into the one that calls it, which spares another round of linking."""
    compiled: Function = njit(inline="always")(function)
    return compiled
