"""Machine code of a kernel, made by numba.

numba makes LLVM's intermediate code of a kernel and of all that it calls. There everything but
the entry becomes private to it, is optimised again as a whole, so that numba's exceptions go,
which kernels never raise, and becomes an object file for this processor.
"""

from collections.abc import Callable
from ctypes import CDLL
from types import FunctionType
from typing import Any

import llvmlite.binding as llvm
import numba

from simulator.kernels import link
from simulator.kernels.identity import is_kernel, names_of


def object_code(
    function: Callable[..., object], arguments: tuple[object, ...], *, symbol: str
) -> bytes:
    """Object file of a kernel for arguments of the types of these.

    Parameters
    ----------
    function : callable
    arguments : tuple
    symbol : str
        What the kernel is called there.

    Raises
    ------
    TypeError
        When the kernel needs numba at run time, as one does that allocates.
    """
    compiled = _compiled(function, {})
    types = tuple(map(numba.typeof, arguments))
    compiled.compile(types)
    name = compiled.overloads[types].fndesc.llvm_func_name
    module = llvm.parse_assembly(compiled.inspect_llvm(types))
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "external" if each.name == name else "internal"
    for each in module.global_variables:
        if not each.is_declaration:
            each.linkage = "internal"
    module.get_function(name).name = symbol
    machine = link.target_machine()
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(3))
    passes.getModulePassManager().run(module, passes)
    require_self_contained(module, symbol)
    code: bytes = machine.emit_object(module)
    return code


def _compiled(function: Any, known: dict[object, Any]) -> Any:
    """Numba's compiler of a kernel whose names of kernels mean their compilers."""
    if function not in known:
        names = {
            name: _compiled(value, known) if is_kernel(value) else value
            for name, value in names_of(function)
        }
        same = FunctionType(function.__code__, names, function.__name__, function.__defaults__)
        known[function] = numba.njit(
            error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False
        )(same)
    return known[function]


def require_self_contained(module: Any, symbol: str) -> None:
    """Refuse what calls other functions than those of C's mathematics."""
    library = CDLL(None)
    for each in module.functions:
        if not each.is_declaration or each.name.startswith("llvm."):
            continue
        if each.name.startswith(("NRT_", "numba_", "Py")) or not hasattr(library, each.name):
            raise TypeError(f"kernel {symbol} needs {each.name}")
